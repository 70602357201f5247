//! Plants and filters from outside of the crate.

#[path = "../examples/own_filter.rs"]
#[expect(dead_code, reason = "an example has a main function")]
mod own_filter;
#[path = "../examples/own_plant.rs"]
#[expect(dead_code, reason = "an example has a main function")]
mod own_plant;
#[path = "../examples/printer.rs"]
#[expect(dead_code, reason = "an example has a main function")]
mod printer;

use kalmanscope_core::filter::{Algorithm, FilterInfo, Particles};
use kalmanscope_core::plant::{Plant, PlantInfo};
use kalmanscope_core::{Diagnostics, FilterKind, FilterSettings, PlantKind, Scenario};

use crate::run::{finished, one_filter};

#[test]
fn a_plant_of_ones_own_is_identified() {
    for (estimate, std) in own_plant::identify().expect("the scenario is possible") {
        assert!((estimate - 5.0).abs() < 3.0 * std && std < 0.1, "{estimate} ± {std}");
    }
}

#[test]
fn a_filter_of_ones_own_can_be_stepped_by_hand_and_used_in_a_scenario() {
    let after_an_outlier = own_filter::step_by_hand().expect("the filter goes on");
    assert!(after_an_outlier.abs() < 0.05, "{after_an_outlier}");
    let (estimate, std) = own_filter::identify().expect("the scenario is possible");
    assert!((estimate - 4.8).abs() < 4.0 * std && std < 0.3, "{estimate} ± {std}");
}

#[test]
fn a_particle_filter_of_ones_own_has_its_own_likelihood() {
    static OWN: FilterInfo = FilterInfo {
        key: "own_pf",
        name: "own PF",
        has_own_likelihood: true,
        algorithm: Algorithm::Belief(|initial, settings, normal| {
            Ok(Box::new(Particles::new(initial, settings.ensemble_size, normal)?))
        }),
        ..*FilterKind::PF.info()
    };
    let results = [FilterKind::PF, FilterKind::new(&OWN)].map(|kind| {
        let scenario = Scenario { duration: 0.5, ..one_filter(kind) };
        let run = finished(&scenario);
        let estimates = &run.estimates()[0];
        assert!(estimates.effective_samples()[20] > 1.0, "{kind:?}");
        (estimates.log_likelihood(20), Diagnostics::new(estimates, run.record()).log_likelihood())
    });
    let close = |a: f64, b: f64| (a - b).abs() < 1e-6 * b.abs();
    assert!(close(results[0].0, results[1].0) && close(results[0].1, results[1].1), "{results:?}");
}

/// A plant that hides behind the built-in one: it has all of its data, but another equation.
struct Impostor;

impl Plant for Impostor {
    fn info(&self) -> PlantInfo<'_> {
        static SDOF: PlantKind = PlantKind::SDOF;
        SDOF.info()
    }

    fn motion_rate(&self, state: &[f64], force: f64, rate: &mut [f64]) {
        PlantKind::SDOF.motion_rate(state, 2.0 * force, rate);
    }

    fn motion_jacobian(&self, state: &[f64], jacobian: &mut [f64]) {
        PlantKind::SDOF.motion_jacobian(state, jacobian);
    }
}

#[test]
fn a_plant_or_a_filter_of_ones_own_with_a_key_of_the_registry_is_refused() {
    static EKF: FilterInfo = FilterInfo { key: "ekf", name: "my EKF", ..*FilterKind::UKF.info() };
    let (plant, kind) = (PlantKind::new(&Impostor), FilterKind::new(&EKF));
    assert!(plant != PlantKind::SDOF && plant == PlantKind::new(&Impostor) && kind != FilterKind::EKF);
    let refused = |change: &dyn Fn(&mut Scenario), message: &str| {
        let mut scenario = Scenario::default();
        change(&mut scenario);
        let error = scenario.validate().expect_err("it has a key of the registry").to_string();
        assert!(error.starts_with(message) && error.ends_with("a key that no built-in kind has"), "{error}");
    };
    refused(&|scenario| scenario.plant.kind = plant.clone(), "`plant.kind` is \"sdof\" of your own");
    refused(&|scenario| scenario.filters[1].plant = Some(plant.clone()), "`filters[1].plant` is \"sdof\" of your own");
    refused(&|scenario| scenario.filters[0].kind = kind, "`filters[0].kind` is \"ekf\" of your own");
}

/// No choice depends on these seeds.
#[test]
fn frequency_and_damping_of_a_printer_are_inside_their_bands() {
    use printer::Kind::{One, Stops, Sweep, Two};
    for (kind, count) in [(One, 60), (Two, 60), (Stops, 60), (Sweep, 6)] {
        let (found, [f, zeta]) = printer::study(kind, 20_001..20_001 + count);
        assert!(found as f64 >= 0.95 * count as f64, "{kind:?}: {found} of {count}");
        assert!(f[0].abs() < 1.0 && zeta[0].abs() < 3.0, "{kind:?}: {f:?}, {zeta:?}");
        // The bands of a sweep are too narrow: docs/printers.md gives how often they hold.
        assert!(kind == Sweep || f[2] >= 83.0 && zeta[2] >= 83.0, "{kind:?}: {f:?}, {zeta:?}");
    }
}

#[test]
fn the_kind_of_a_filter_says_its_time() {
    static SLOW: FilterInfo = FilterInfo {
        key: "slow",
        name: "slow",
        is_sampled: true,
        evaluations: |_, _| 1,
        time: |settings, n| 1e6 * (n * settings.iterations) as f64,
        has_propagation: false,
        ..*FilterKind::EKF.info()
    };
    let of = |kind| FilterSettings { kind, guesses: 2, ..FilterSettings::default() }.time_of_step(&Scenario::default());
    assert_eq!(of(FilterKind::new(&SLOW)), 2.0 * 1e6 * 4.0 * 5.0);
    assert!(of(FilterKind::UKF) > of(FilterKind::EKF) && of(FilterKind::PF) > of(FilterKind::UKF));
}
