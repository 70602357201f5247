//! Start values of typed equations from records: where the filters that begin with them end.

use std::path::Path;

use kalmanscope_core::equation::EquationSettings;
use kalmanscope_core::suggest::{Suggestion, scenario_for, suggest};
use kalmanscope_core::{Force, PlantKind, Record, Run, Scenario};

/// A scenario of the gallery, and the record that it simulates.
fn simulated(name: &str) -> (Scenario, Record) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../assets/equations/{name}.toml"));
    let scenario = Scenario::from_toml(&std::fs::read_to_string(path).unwrap()).unwrap();
    let mut run = Run::new(&Scenario { filters: Vec::new(), ..scenario.clone() }).unwrap();
    run.finish();
    (scenario, run.record().clone())
}

/// Start values for a record under an equation of which nothing but the text is known: every guess is 1.
fn started(equation: &str, record: &Record) -> Suggestion {
    let mut scenario = scenario_for(record);
    scenario.set_plant(PlantKind::of_equation(&EquationSettings::new(equation)).unwrap());
    suggest(&scenario, record)
}

#[test]
fn filters_find_the_parameters_of_an_equation_from_its_text_alone() {
    let mut bad = Vec::new();
    // Not the pendulum, which turns over, nor the pier and the seismometer, in whose records several parameters look alike.
    for name in [
        "absorber",
        "cart",
        "dry-friction",
        "helmholtz",
        "mathieu",
        "quadratic-damping",
        "rlc-circuit",
        "rotor",
        "van-der-pol",
    ] {
        let (truth, record) = simulated(name);
        let suggestion = started(truth.plant.kind.equation(), &record);
        let told = suggestion.reasons.iter().filter(|reason| reason.starts_with("guess of the equation's parameters"));
        assert_eq!(told.count(), 1, "{name}: {:?}", suggestion.reasons);
        let mut run = Run::on_record(&suggestion.scenario, record.into()).unwrap();
        run.finish();
        assert_eq!(run.estimates().len(), 2);
        for estimates in run.estimates() {
            for channel in truth.plant.kind.parameters() {
                let expected = truth.plant.parameter(channel).unwrap().at(0.0);
                let found = estimates.canonical_mean(estimates.len() - 1, estimates.place(channel).unwrap());
                if estimates.stop().is_some() || (found / expected - 1.0).abs() > 0.1 {
                    bad.push(format!("{name}, {}: {} {found}, truth {expected}", estimates.name(), channel.symbol()));
                }
            }
        }
    }
    assert!(bad.is_empty(), "{}", bad.join("\n"));
}

#[test]
fn without_an_input_the_guesses_stay_and_that_is_said() {
    let (mut scenario, _) = simulated("quadratic-damping");
    scenario.force = Force::None;
    scenario.plant.initial.displacement = 0.5;
    scenario.filters.clear();
    let mut run = Run::new(&scenario).unwrap();
    run.finish();
    let suggestion = started(scenario.plant.kind.equation(), run.record());
    let said = "d, k begin with the guesses of the equation: without an input";
    assert!(suggestion.reasons.iter().any(|reason| reason.starts_with(said)), "{:?}", suggestion.reasons);
    let mean = &suggestion.scenario.filters[0].initial_mean;
    for channel in scenario.plant.kind.parameters() {
        assert_eq!(mean[channel], 1.0, "{channel:?}");
    }
}

/// The linear oscillator has nothing that the spectra do not tell, typed or built in.
#[test]
fn a_typed_oscillator_begins_as_the_built_in_one() {
    let mut scenario = Scenario { duration: 30.0, ..Scenario::default() };
    scenario.filters.clear();
    let mut run = Run::new(&scenario).unwrap();
    run.finish();
    let built_in = suggest(&scenario_for(run.record()), run.record());
    let typed = started("x'' + 2 ζ ωₙ x' + ωₙ² x = f", run.record());
    assert_eq!(typed.reasons, built_in.reasons);
    for (a, b) in typed.scenario.filters.iter().zip(&built_in.scenario.filters) {
        assert_eq!((&a.initial_mean, &a.initial_std), (&b.initial_mean, &b.initial_std));
    }
}
