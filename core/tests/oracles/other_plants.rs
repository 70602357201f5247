//! Filters with another plant than the truth's, or with logarithms of its parameters.

use kalmanscope_core::{
    Aspect, Channel, Estimates, FilterKind, FilterSettings, PlantKind, Quantity, Scenario, Sensor, Signal,
};

use super::cases::{deviation, scenario};
use super::from_papers::DETERMINISTIC;
use super::textbook;
use crate::run::finished;

fn numbers(estimates: &Estimates) -> Vec<f64> {
    (0..estimates.len()).flat_map(|k| [estimates.mean(k), estimates.cov(k)]).flatten().copied().collect()
}

#[test]
fn a_linear_filter_may_follow_any_truth() {
    for truth in PlantKind::ALL {
        for kind in FilterKind::ALL {
            let mut scenario = Scenario { duration: 3.0, ..scenario(truth, kind) };
            scenario.filters[0].plant = Some(PlantKind::SDOF);
            let run = finished(&scenario);
            let estimates = &run.estimates()[0];
            assert_eq!((estimates.stop(), estimates.len()), (None, run.len()), "{} on {}", kind.name(), truth.name());
            assert_eq!(estimates.channels(), PlantKind::SDOF.channels());
            if DETERMINISTIC.contains(&kind) {
                let deviation = deviation(estimates, &textbook::filter(&scenario, 0, run.record()));
                assert!(deviation < 1e-8, "{} on {}: {deviation}", kind.name(), truth.name());
            }
        }
    }
}

#[test]
fn sensors_that_the_filters_plant_does_not_have_are_ignored() {
    for kind in FilterKind::ALL {
        let mut scenario = Scenario { duration: 3.0, ..scenario(PlantKind::SHEAR_2, kind) };
        scenario.filters[0].plant = Some(PlantKind::SDOF);
        let without = finished(&scenario);
        for measures in [Quantity::new(Aspect::DISPLACEMENT, 1), Quantity::new(Aspect::ACCELERATION, 1)] {
            scenario.add_sensor(Sensor::new(measures, 0.01));
        }
        let with = finished(&scenario);
        let (a, b) = (&without.estimates()[0], &with.estimates()[0]);
        assert_eq!(numbers(a), numbers(b), "{}", kind.name());
        assert!((0..b.len()).all(|k| b.innovation(k)[2..].iter().all(|e| e.is_nan())));
    }
}

#[test]
fn a_linear_spring_in_place_of_a_hard_one_comes_out_stiffer() {
    let mut scenario = Scenario { duration: 30.0, ..scenario(PlantKind::DUFFING, FilterKind::EKF) };
    scenario.filters[0].plant = Some(PlantKind::SDOF);
    let run = finished(&scenario);
    let (estimates, last) = (&run.estimates()[0], run.len() - 1);
    assert!((6.2..12.0).contains(&estimates.mean(last)[2]), "{}", estimates.mean(last)[2]);
}

fn in_logarithms(mut scenario: Scenario) -> Scenario {
    let plain = scenario.filters[0].clone();
    scenario.filters.push(FilterSettings { log_parameters: true, ..plain });
    scenario
}

#[test]
fn logarithms_change_little_where_the_belief_is_narrow() {
    for plant in [PlantKind::SDOF, PlantKind::DUFFING, PlantKind::SHEAR_3] {
        for kind in DETERMINISTIC {
            let mut scenario = Scenario { duration: 3.0, ..scenario(plant, kind) };
            let settings = &mut scenario.filters[0];
            for channel in plant.parameters() {
                settings.initial_mean[channel] = scenario.plant.parameter(channel).unwrap().at(0.0);
                settings.initial_std[channel] = 1e-4 * settings.initial_mean[channel];
                settings.process_std[channel] = 0.0;
            }
            let run = finished(&in_logarithms(scenario));
            let [plain, log] = run.estimates() else { unreachable!("two filters") };
            for k in 0..run.len() {
                for i in 0..plain.channels().len() {
                    let (mean, std) = (plain.mean(k)[i], plain.std(k, i));
                    assert!((log.mean(k)[i] - mean).abs() <= 2e-3 * std + 1e-12 * mean.abs(), "{} at {k}", kind.name());
                    assert!((log.std(k, i) - std).abs() <= 2e-3 * std, "{} at {k}", kind.name());
                }
            }
        }
    }
}

#[test]
fn logarithms_keep_a_wild_guess_positive() {
    let mut went_negative = 0;
    for kind in
        [FilterKind::EKF, FilterKind::UKF, FilterKind::SR_UKF, FilterKind::CKF, FilterKind::ENKF, FilterKind::PF]
    {
        for seed in 1..=3 {
            let mut scenario = Scenario { seed, duration: 10.0, ..scenario(PlantKind::SDOF, kind) };
            scenario.plant.set(Channel::DAMPING_RATIO, Signal::Constant(0.005));
            let settings = &mut scenario.filters[0];
            settings.initial_mean[Channel::DAMPING_RATIO] = 0.05;
            settings.initial_std[Channel::DAMPING_RATIO] = 0.2;
            let run = finished(&in_logarithms(scenario));
            let [plain, log] = run.estimates() else { unreachable!("two filters") };
            let lowest = |e: &Estimates| (0..e.len()).map(|k| e.mean(k)[3].min(e.mean(k)[2])).fold(f64::MAX, f64::min);
            went_negative += usize::from(lowest(plain) < 0.0);
            assert!(lowest(log) > 0.0, "{} {seed}", kind.name());
        }
    }
    assert!(went_negative > 6, "{went_negative}");
}
