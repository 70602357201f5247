//! Each filter agrees with a plain implementation of its paper.

use kalmanscope_core::simulate;
use kalmanscope_core::{Adaptation, FilterKind, FilterSettings, PlantKind, Propagation, Quantity, Run, Scenario};

use super::cases::{deviation, scenario};
use super::plants::written;
use super::textbook::filter;
use crate::run::finished;

pub(crate) const DETERMINISTIC: [FilterKind; 6] =
    [FilterKind::KF, FilterKind::EKF, FilterKind::IEKF, FilterKind::UKF, FilterKind::SR_UKF, FilterKind::CKF];

/// Most agree to 1e-11; in the transient of an EKF from a wrong belief, rounding grows to 1e-9.
const TOLERANCE: f64 = 1e-8;

#[track_caller]
fn assert_agrees_with_paper(what: &str, scenario: &Scenario) {
    let run = finished(scenario);
    let expected = filter(scenario, 0, run.record());
    let deviation = deviation(&run.estimates()[0], &expected);
    println!("{what:60} {deviation:.1e}");
    assert!(deviation < TOLERANCE, "{what}: {deviation}");
}

#[test]
fn every_filter_on_every_plant() {
    for plant in written() {
        for kind in DETERMINISTIC {
            let mut scenario = scenario(plant, kind);
            scenario.duration = 0.6;
            assert_agrees_with_paper(&format!("{} of a {}", kind.name(), plant.name()), &scenario);
        }
    }
}

fn with(plant: PlantKind, settings: &FilterSettings) -> Scenario {
    let mut scenario = scenario(plant, settings.kind);
    scenario.duration = 1.2;
    let FilterSettings { name, fading, sensor_std, .. } = scenario.filters[0].clone();
    scenario.filters = vec![FilterSettings { name, fading, sensor_std, ..settings.clone() }];
    scenario
}

#[test]
fn every_propagation() {
    for plant in [PlantKind::SDOF, PlantKind::DUFFING] {
        for propagation in Propagation::ALL {
            for eta in [0.0, 0.02] {
                let ekf =
                    with(plant, &FilterSettings { propagation: Some(propagation), eta, ..FilterSettings::default() });
                assert_agrees_with_paper(&format!("{propagation:?} of a {}, η = {eta}", plant.name()), &ekf);
            }
        }
    }
}

#[test]
fn decay_and_logarithms() {
    for plant in [PlantKind::SDOF, PlantKind::DUFFING, PlantKind::SHEAR_2] {
        for kind in DETERMINISTIC {
            for (eta, log_parameters) in [(0.02, false), (0.0, true), (0.02, true)] {
                let settings = FilterSettings { kind, eta, log_parameters, ..FilterSettings::default() };
                let what = format!("{} of a {}, η = {eta}, logarithms {log_parameters}", kind.name(), plant.name());
                assert_agrees_with_paper(&what, &with(plant, &settings));
            }
        }
    }
}

#[test]
fn an_iterated_update_of_any_length() {
    for plant in [PlantKind::SDOF, PlantKind::DUFFING] {
        for iterations in [1, 2, 3, 20] {
            let settings = FilterSettings { kind: FilterKind::IEKF, iterations, ..FilterSettings::default() };
            assert_agrees_with_paper(
                &format!("{iterations} iterations of a {}", plant.name()),
                &with(plant, &settings),
            );
        }
    }
}

#[test]
fn noise_that_is_learnt() {
    for plant in [PlantKind::SDOF, PlantKind::DUFFING] {
        for kind in DETERMINISTIC {
            for (sensor_noise, process_noise) in [(true, false), (false, true), (true, true)] {
                let adaptation = Adaptation { sensor_noise, process_noise, forgetting: 0.99, training: 0.0 };
                let settings = FilterSettings { kind, adaptation, ..FilterSettings::default() };
                let mut scenario = with(plant, &settings);
                // The residual assumes sensors linear in the state, so that R is compared for these only.
                if sensor_noise {
                    scenario.remove_sensor(Quantity::ACCELERATION);
                    scenario.filters[0].sensor_std = vec![0.02];
                }
                let what = format!("{} of a {}, R {sensor_noise}, Q {process_noise}", kind.name(), plant.name());
                assert_agrees_with_paper(&what, &scenario);
            }
        }
    }
}

#[test]
fn records_with_gaps() {
    for plant in [PlantKind::SDOF, PlantKind::DUFFING] {
        for kind in DETERMINISTIC {
            let scenario = scenario(plant, kind);
            // Missing is the first sensor, the second, or both in turn.
            let record = simulate(&scenario).with_gaps(|sensor, k| (k / 7 + sensor).is_multiple_of(3) || k % 50 < 9);
            let mut run = Run::on_record(&scenario, record.clone().into()).unwrap();
            run.finish();
            let deviation = deviation(&run.estimates()[0], &filter(&scenario, 0, &record));
            assert!(deviation < TOLERANCE, "{} of a {}: {deviation}", kind.name(), plant.name());
        }
    }
}
