//! Equations of the gallery: twelve are identified from simulated records, and start values are found from the text alone.

use kalmanscope_core::equation::EquationSettings;
use kalmanscope_core::suggest::{Suggestion, scenario_for, suggest};
use kalmanscope_core::{Force, PlantKind, Record, Scenario, simulate};

use crate::diagnosis;
use crate::run::{asset, assets, finished, finished_on, last};

fn faults(scenario: &Scenario) -> Vec<String> {
    let run = finished(scenario);
    let estimates = &run.estimates()[0];
    if let Some(stop) = estimates.stop() {
        return vec![format!("stopped: {stop:?}")];
    }
    let verdict = diagnosis(estimates, run.record()).verdict.unwrap();
    let last = estimates.len() - 1;
    let mut faults = Vec::new();
    for (place, &channel) in estimates.channels().iter().enumerate().filter(|(_, channel)| channel.is_parameter()) {
        let truth = run.record().truth(channel).unwrap()[last];
        let (mean, std) = (estimates.canonical_mean(last, place), estimates.std(last, place));
        let told = format!("{} {mean:.4} ± {std:.4}, truth {truth}", channel.symbol());
        if (mean - truth).abs() > 4.0 * std {
            faults.push(told.clone());
        }
        if std > 0.8 * estimates.initial_std(place) {
            faults.push(format!("nothing is learnt: {told}"));
        }
    }
    if !verdict.kind.is_good() {
        faults.push(format!("{:?}: {}", verdict.kind, verdict.reason));
    }
    faults
}

#[test]
fn each_equation_is_identified_and_the_verdict_is_right() {
    let gallery = assets("equations");
    assert_eq!(gallery.len(), 12);
    let mut all = Vec::new();
    for (name, text) in gallery {
        let scenario = Scenario::from_toml(&text).unwrap_or_else(|error| panic!("{name}: {error}"));
        for seed in [1, 2, 3] {
            let faults = faults(&Scenario { seed, ..scenario.clone() });
            all.extend(faults.into_iter().map(|fault| format!("{name}, seed {seed}: {fault}")));
        }
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
}

fn simulated(name: &str) -> (Scenario, Record) {
    let scenario = asset("equations", name);
    let record = simulate(&scenario);
    (scenario, record)
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
    let names = "absorber cart dry-friction helmholtz mathieu quadratic-damping rlc-circuit rotor van-der-pol";
    for name in names.split(' ') {
        let (truth, record) = simulated(name);
        let suggestion = started(truth.plant.kind.equation(), &record);
        let told = suggestion.reasons.iter().filter(|reason| reason.starts_with("guess of the equation's parameters"));
        assert_eq!(told.count(), 1, "{name}: {:?}", suggestion.reasons);
        let run = finished_on(&suggestion.scenario, record);
        assert_eq!(run.estimates().len(), 2);
        for estimates in run.estimates() {
            for channel in truth.plant.kind.parameters() {
                let expected = truth.plant.parameter(channel).unwrap().at(0.0);
                let found = last(estimates, channel).0;
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
    let suggestion = started(scenario.plant.kind.equation(), &simulate(&scenario));
    let said = "d, k begin with the guesses of the equation: without an input";
    assert!(suggestion.reasons.iter().any(|reason| reason.starts_with(said)), "{:?}", suggestion.reasons);
    let mean = &suggestion.scenario.filters[0].initial_mean;
    for channel in scenario.plant.kind.parameters() {
        assert_eq!(mean[channel], 1.0, "{channel:?}");
    }
}

#[test]
fn a_typed_oscillator_begins_as_the_built_in_one() {
    let record = simulate(&Scenario { duration: 30.0, ..Scenario::default() });
    let built_in = suggest(&scenario_for(&record), &record);
    let typed = started("x'' + 2 ζ ωₙ x' + ωₙ² x = f", &record);
    assert_eq!(typed.reasons, built_in.reasons);
    for (a, b) in typed.scenario.filters.iter().zip(&built_in.scenario.filters) {
        assert_eq!((&a.initial_mean, &a.initial_std), (&b.initial_mean, &b.initial_std));
    }
}
