//! Filters with default settings identify the parameters of every plant.

use kalmanscope_core::{Channel, FilterKind, FilterSettings, PlantKind, Run, Scenario, Signal};

use crate::run::finished;

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

/// Each parameter ends within 4 standard deviations of the truth, and these are small.
#[track_caller]
fn assert_found(run: &Run, plant: PlantKind, widest: f64) {
    for estimates in run.estimates() {
        assert_eq!(estimates.stop(), None, "{} of a {}", estimates.name(), plant.name());
        let last = estimates.len() - 1;
        for channel in plant.parameters() {
            let place = estimates.place(channel).unwrap();
            let truth = run.record().truth(channel).unwrap()[last];
            let (error, std) = (estimates.mean(last)[place] - truth, estimates.std(last, place));
            let what = format!("{} of a {}, {}", estimates.name(), plant.name(), channel.name());
            assert!(error.abs() <= 4.0 * std.max(0.005 * truth), "{what}: {error} ± {std}");
            assert!(std <= widest * truth, "{what}: {error} ± {std}");
        }
    }
}

#[test]
fn oscillators_are_identified() {
    for (plant, widest) in [(PlantKind::SDOF, 0.05), (PlantKind::DUFFING, 0.1), (PlantKind::BOUC_WEN, 0.6)] {
        for seed in 1..=2 {
            assert_found(&finished(&switched(plant, seed, &NONLINEAR)), plant, widest);
        }
    }
}

#[test]
fn every_storeys_stiffness_is_found_from_the_first_floor() {
    for plant in [PlantKind::SHEAR_2, PlantKind::SHEAR_3, PlantKind::SHEAR_4] {
        for seed in 1..=2 {
            assert_found(&finished(&switched(plant, seed, &NONLINEAR[..2])), plant, 0.1);
        }
    }
}

#[test]
fn particles_do_not_collapse_onto_one_value() {
    for plant in [PlantKind::SDOF, PlantKind::DUFFING] {
        for seed in 1..=2 {
            assert_found(&finished(&switched(plant, seed, &[FilterKind::PF])), plant, 0.1);
        }
    }
}

#[test]
fn defaults_are_off_the_truth() {
    for plant in PlantKind::ALL {
        let scenario = switched(plant, 1, &[FilterKind::EKF]);
        let settings = &scenario.filters[0];
        for channel in plant.parameters().filter(|&c| c != Channel::POST_YIELD_RATIO) {
            let off = settings.initial_mean[channel] / scenario.plant.parameter(channel).unwrap().at(0.0) - 1.0;
            assert!(off.abs() > 0.05, "{} is given away", channel.name());
            assert!(settings.initial_std[channel] > 0.0);
        }
    }
}
