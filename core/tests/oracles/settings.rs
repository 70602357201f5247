//! Filters with default settings identify the parameters of every plant, and extreme settings are possible.

use kalmanscope_core::{Channel, FilterKind, FilterSettings, PlantKind, Run, Scenario, Signal};

use super::from_papers::scenario;
use crate::health::check_scenario;
use crate::numbers::largest;
use crate::run::{finished, last, plants};

const NONLINEAR: [FilterKind; 4] = [FilterKind::EKF, FilterKind::UKF, FilterKind::CKF, FilterKind::ENKF];

fn switched(plant: PlantKind, seed: u64, kinds: &[FilterKind]) -> Scenario {
    let mut scenario = Scenario { seed, duration: 40.0, ..Scenario::default() };
    scenario.set_plant(plant);
    scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Constant(6.0));
    let usual = scenario.filters[0].clone();
    let filter = |&kind: &FilterKind| FilterSettings { name: kind.name().to_owned(), kind, ..usual.clone() };
    scenario.filters = kinds.iter().map(filter).collect();
    scenario
}

#[track_caller]
fn assert_found(run: &Run, plant: &PlantKind, widest: f64) {
    for estimates in run.estimates() {
        assert_eq!(estimates.stop(), None, "{} of a {}", estimates.name(), plant.name());
        for channel in plant.parameters() {
            let truth = run.record().truth(channel).unwrap()[estimates.len() - 1];
            let (mean, std) = last(estimates, channel);
            let error = mean - truth;
            let what = format!("{} of a {}, {}", estimates.name(), plant.name(), channel.name());
            assert!(error.abs() <= 4.0 * std.max(0.005 * truth), "{what}: {error} ± {std}");
            assert!(std <= widest * truth, "{what}: {error} ± {std}");
        }
    }
}

#[test]
fn parameters_are_identified() {
    let particles = [FilterKind::PF];
    for (plant, kinds, widest) in [
        (PlantKind::SDOF, &NONLINEAR[..], 0.05),
        (PlantKind::DUFFING, &NONLINEAR, 0.1),
        (PlantKind::BOUC_WEN, &NONLINEAR, 0.6),
        (PlantKind::SHEAR_2, &NONLINEAR[..2], 0.1),
        (PlantKind::SHEAR_3, &NONLINEAR[..2], 0.1),
        (PlantKind::SHEAR_4, &NONLINEAR[..2], 0.1),
        (PlantKind::SDOF, &particles, 0.1),
        (PlantKind::DUFFING, &particles, 0.1),
    ] {
        for seed in 1..=2 {
            assert_found(&finished(&switched(plant.clone(), seed, kinds)), &plant, widest);
        }
    }
}

#[test]
fn defaults_are_off_the_truth() {
    for plant in plants() {
        let scenario = switched(plant.clone(), 1, &[FilterKind::EKF]);
        let settings = &scenario.filters[0];
        for channel in plant.parameters().filter(|&c| c != Channel::POST_YIELD_RATIO) {
            let off = settings.initial_mean[channel] / scenario.plant.parameter(channel).unwrap().at(0.0) - 1.0;
            assert!(off.abs() > 0.05, "{} is given away", channel.name());
            assert!(settings.initial_std[channel] > 0.0);
        }
    }
}

/// Every filter on every plant, with few members.
fn small() -> impl Iterator<Item = (PlantKind, FilterKind, Scenario)> {
    plants().flat_map(|plant| {
        FilterKind::ALL.map(|kind| {
            let mut scenario = scenario(plant.clone(), kind);
            scenario.filters[0].ensemble_size = 60;
            (plant.clone(), kind, scenario)
        })
    })
}

fn last_belief(run: &Run) -> Vec<f64> {
    let estimates = &run.estimates()[0];
    let last = estimates.len() - 1;
    estimates.mean(last).iter().chain(estimates.cov(last)).copied().collect()
}

#[test]
fn a_tiny_decay_is_close_to_none() {
    for ((plant, kind, small), log_parameters) in small().flat_map(|one| [(one.clone(), false), (one, true)]) {
        // Of few particles, one that is drawn or not changes much.
        let mut scenario = Scenario { duration: 0.25, filters: scenario(plant.clone(), kind).filters, ..small };
        scenario.filters[0].log_parameters = log_parameters;
        let without = last_belief(&finished(&scenario));
        scenario.filters[0].eta = 1e-12;
        for (a, b) in without.iter().zip(last_belief(&finished(&scenario))) {
            let what = format!("{} of a {}, logarithms {log_parameters}", kind.name(), plant.name());
            assert!((a - b).abs() <= 1e-6 * a.abs().max(1e-3), "{what}: {a} and {b}");
        }
    }
}

#[test]
fn zero_damping_is_allowed() {
    for (plant, kind, scenario) in small() {
        let mut scenario = Scenario { duration: 3.0, ..scenario };
        for channel in [Channel::DAMPING_RATIO, Channel::STOREY_DAMPING] {
            *scenario.plant.parameter_mut(channel).unwrap() = Signal::Constant(0.0);
            scenario.filters[0].initial_mean[channel] = 0.0;
        }
        let run = finished(&scenario);
        assert_eq!(run.estimates()[0].stop(), None, "{} of a {}", kind.name(), plant.name());
    }
}

#[test]
fn components_of_variance_zero_stay_constant() {
    for (plant, kind, scenario) in small() {
        let parameters: Vec<Channel> = plant.parameters().collect();
        let mut choices: Vec<Vec<Channel>> = parameters.iter().map(|&c| vec![c]).collect();
        choices.push(parameters);
        for log_parameters in [false, true] {
            for certain in &choices {
                let mut scenario = Scenario { duration: 0.25, ..scenario.clone() };
                let settings = &mut scenario.filters[0];
                settings.log_parameters = log_parameters;
                for &channel in certain {
                    settings.initial_std[channel] = 0.0;
                    settings.process_std[channel] = 0.0;
                }
                let estimates = &finished(&scenario).estimates()[0].clone();
                for &channel in certain {
                    let place = estimates.place(channel).unwrap();
                    let told = scenario.filters[0].initial_mean[channel];
                    // The exponential of a logarithm may round, but always to the same number.
                    let start = estimates.mean(0)[place];
                    let log = log_parameters && channel.is_positive();
                    assert!(if log { (start / told - 1.0).abs() < 1e-14 } else { start == told });
                    for k in 0..estimates.len() {
                        let what = format!("{} of a {}: {certain:?} at {k}", kind.name(), plant.name());
                        assert_eq!(estimates.mean(k)[place].to_bits(), start.to_bits(), "{what}");
                        assert_eq!(estimates.std(k, place), 0.0, "{what}");
                    }
                }
            }
        }
    }
}

#[test]
fn long_steps_give_finite_numbers_or_a_reason() {
    for (plant, kind, scenario) in small() {
        for dt in [0.1, 0.5, 2.0, 20.0] {
            let checked = check_scenario(&Scenario { dt, duration: 100.0 * dt, ..scenario.clone() }, 0);
            checked.unwrap_or_else(|what| panic!("{} of a {} with {dt}: {what}", kind.name(), plant.name()));
        }
    }
}

#[test]
fn a_belief_without_any_variance_moves_as_the_plant_does() {
    for (plant, kind, scenario) in small() {
        // Local linearisation is of second order for a nonlinear plant.
        let tolerance = if plant.info().is_linear { 1e-6 } else { 1e-3 };
        let mut scenario = Scenario { duration: 1.0, dt: 0.002, ..scenario };
        let settings = &mut scenario.filters[0];
        for &channel in plant.channels() {
            settings.initial_std[channel] = 0.0;
            settings.process_std[channel] = 0.0;
            if let Some(signal) = scenario.plant.parameter(channel) {
                settings.initial_mean[channel] = signal.at(0.0);
            }
        }
        let run = finished(&scenario);
        let estimates = &run.estimates()[0];
        assert_eq!((estimates.stop(), estimates.len()), (None, run.len()));
        for (place, &channel) in plant.channels().iter().enumerate() {
            let truth = run.record().truth(channel).unwrap();
            let size = largest(truth);
            for (k, truth) in truth.iter().enumerate() {
                let error = (estimates.mean(k)[place] - truth).abs();
                let what = format!("{} of a {}, {channel:?}", kind.name(), plant.name());
                assert!(error <= tolerance * size, "{what} at {k}: {error}");
                assert_eq!(estimates.std(k, place), 0.0);
            }
        }
    }
}
