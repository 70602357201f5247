//! Equations of the gallery, and records of lessons of other noise and forces than those that come along.

use kalmanscope_core::diagnosis::VerdictKind;
use kalmanscope_core::equation::EquationSettings;
use kalmanscope_core::suggest::{Suggestion, scenario_for, suggest};
use kalmanscope_core::{Channel, Force, Hold, PlantKind, Record, Run, Scenario, simulate};

use crate::run::{
    asset, assets, built_in, diagnosis, finished, finished_on, finished_on_file, last, remedies, verdict,
};

#[path = "../../lessons/src/records/earthquake.rs"]
mod earthquake;
#[path = "../../lessons/src/records/oscillator.rs"]
mod oscillator;
#[path = "../../lessons/src/records/random.rs"]
mod random;
#[path = "../../lessons/src/records/staircase.rs"]
mod staircase;

use staircase::{DWELL, FREQUENCIES, RATE};

const SEEDS: std::ops::RangeInclusive<u64> = 101..=110;

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

fn followed(seed: u64, change: impl Fn(&mut Scenario)) -> Run {
    let mut scenario = built_in("staircase");
    change(&mut scenario);
    finished_on_file(&scenario, staircase::file(seed))
}

#[test]
fn frequency_and_damping_are_right_and_believed_and_a_ground_that_is_held_is_named_as_the_cause() {
    for (seed, hold) in SEEDS.flat_map(|seed| [(seed, Hold::First), (seed, Hold::Zero)]) {
        let run = finished_on_file(&Scenario { hold, ..built_in("earthquake") }, earthquake::file(seed));
        for (filter, estimates) in run.estimates().iter().enumerate() {
            let error = |channel, truth: f64| last(estimates, channel).0 / truth - 1.0;
            let wn = error(Channel::NATURAL_FREQUENCY, earthquake::NATURAL_FREQUENCY);
            let zeta = error(Channel::DAMPING_RATIO, earthquake::DAMPING_RATIO);
            let (what, verdict) = (format!("seed {seed}, filter {filter}: {wn}, {zeta}"), verdict(&run, filter));
            if hold == Hold::First {
                assert!(wn.abs() < 0.002 && zeta.abs() < 0.03, "{what}");
                assert_eq!(verdict, VerdictKind::Consistent, "{what}");
            } else {
                assert!(zeta > 0.03 && !verdict.is_good(), "{what}");
                let first = remedies(&run, filter, run.record()).first().map(|remedy| remedy.first.cause.key);
                assert_eq!(first, Some("input_hold"), "{what}");
            }
        }
    }
}

fn errors(run: &Run, filter: usize) -> Vec<f64> {
    let estimates = &run.estimates()[filter];
    let place = estimates.place(Channel::NATURAL_FREQUENCY).unwrap();
    let error = |dwell: u32| {
        let end = f64::from((dwell + 1) * DWELL) - 1.0 / f64::from(RATE);
        let k = ((end / run.record().dt()).round() as usize).min(estimates.len() - 1);
        estimates.mean(k)[place] / staircase::natural_frequency((dwell + 1) * DWELL * RATE - 1) - 1.0
    };
    (0..FREQUENCIES.len() as u32).map(error).collect()
}

#[test]
fn fading_memory_follows_each_step_within_two_per_cent_and_without_it_a_filter_is_left_behind() {
    for seed in SEEDS {
        let run = followed(seed, |_| {});
        for filter in 0..run.estimates().len() {
            let errors = errors(&run, filter);
            assert!(errors.iter().all(|error| error.abs() < 0.02), "seed {seed}, filter {filter}: {errors:?}");
        }
        let run = followed(seed, |scenario| scenario.filters.iter_mut().for_each(|filter| filter.fading = 1.0));
        let errors = errors(&run, 0);
        assert!(errors[3] < -0.05, "seed {seed}: {errors:?}");
    }
}
