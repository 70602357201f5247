//! The verdicts, over ten seeds of each situation that they must distinguish.
//!
//! The limits of the tests are set elsewhere, on situations drawn at random (`benches/diagnosis.rs`).

use kalmanscope_core::scenario::Fault;
use kalmanscope_core::signal::{Ramp, Sine, Step};
use kalmanscope_core::{
    Channel, Diagnostics, FilterKind, FilterSettings, Force, PlantKind, Run, Scenario, Signal, simulate,
};
use kalmanscope_diagnosis::VerdictKind::{
    self, Consistent, Diverged, Lost, NotIdentifiable, Overconfident, Recovered, Underconfident, WoundUp,
};
use kalmanscope_diagnosis::{Diagnosis, Verdict};

use crate::run::{built_in, finished, finished_on, measured, oscillator, values, with_fault};
use crate::{diagnosis, remedies};

const SEEDS: std::ops::RangeInclusive<u64> = 1..=10;

fn verdict_on(run: &Run) -> Option<Verdict> {
    diagnosis(&run.estimates()[0], run.record()).verdict
}

fn verdict(scenario: &Scenario) -> Option<Verdict> {
    verdict_on(&finished(scenario))
}

fn without_truth(scenario: &Scenario) -> Run {
    finished_on(scenario, measured(scenario))
}

fn well_tuned(kind: FilterKind) -> Scenario {
    let filter = FilterSettings { kind, fading: 1.0, ..Scenario::default().filters[0].clone() };
    Scenario { plant: oscillator(6.0, 0.05), filters: vec![filter], ..Scenario::default() }
}

fn process_times(scenario: &mut Scenario, channels: &[Channel], factor: f64) {
    for &channel in channels {
        scenario.filters[0].process_std[channel] *= factor;
    }
}

fn sensor_variance_times(scenario: &mut Scenario, factor: f64) {
    scenario.filters[0].sensor_std.iter_mut().for_each(|std| *std *= factor.sqrt());
}

fn frequency_falls(scenario: &mut Scenario, to: f64, fading: f64) {
    scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Step(Step { from: 6.0, to, at: 30.0 }));
    scenario.filters[0].fading = fading;
}

fn frequency_moves(scenario: &mut Scenario, signal: Signal) {
    scenario.plant.set(Channel::NATURAL_FREQUENCY, signal);
    process_times(scenario, &[Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO], 0.01);
}

fn no_excitation(scenario: &mut Scenario) {
    scenario.force = Force::None;
    process_times(scenario, &[Channel::DISPLACEMENT, Channel::VELOCITY], 0.01);
}

/// The name of a situation, what changes in a well-tuned filter's, and its verdicts.
type Situation = (&'static str, fn(&mut Scenario), &'static [VerdictKind]);

const SITUATIONS: &[Situation] = &[
    ("well tuned", |_| (), &[Consistent]),
    ("well tuned, 5 s", |s| s.duration = 5.0, &[Consistent]),
    ("well tuned, 1 s", |s| s.duration = 1.0, &[Consistent]),
    ("fading", |s| s.filters[0].fading = 1.005, &[Consistent]),
    ("bad first guess", |s| s.filters[0].initial_mean[Channel::NATURAL_FREQUENCY] = 14.0, &[Consistent, Recovered]),
    ("mirrored first guess", |s| s.filters[0].initial_mean = values([0.0, 0.0, -8.0, -0.1]), &[Consistent, Recovered]),
    ("fading, sudden change", |s| frequency_falls(s, 4.8, 1.005), &[Consistent, Recovered]),
    (
        "fading, sudden change 3 s ago",
        |s| {
            frequency_falls(s, 4.8, 1.005);
            s.duration = 33.0;
        },
        &[Consistent, Recovered, Overconfident],
    ),
    ("fading, frequency halved", |s| frequency_falls(s, 3.0, 1.005), &[Consistent, Recovered]),
    ("no excitation", no_excitation, &[Consistent, NotIdentifiable]),
    ("Q too small, sudden change", |s| frequency_falls(s, 4.8, 1.0), &[Overconfident, Recovered]),
    (
        "Q too small, drift",
        |s| frequency_moves(s, Signal::Ramp(Ramp { from: 6.0, to: 5.0, start: 10.0, end: 50.0 })),
        &[Overconfident],
    ),
    (
        "Q too small, swinging frequency",
        |s| frequency_moves(s, Signal::Sine(Sine { mean: 6.0, amplitude: 0.5, period: 20.0 })),
        &[Overconfident],
    ),
    ("Q far too large", |s| process_times(s, Channel::all(), 100.0), &[Underconfident]),
    ("R a tenth", |s| sensor_variance_times(s, 0.1), &[Overconfident]),
    ("R tenfold", |s| sensor_variance_times(s, 10.0), &[Underconfident]),
    ("R a hundredth", |s| sensor_variance_times(s, 0.01), &[Overconfident]),
    ("R hundredfold", |s| sensor_variance_times(s, 100.0), &[Underconfident]),
    ("small disturbance", |s| s.plant.disturbance_std = 1.0, &[Overconfident]),
    ("large disturbance", |s| s.plant.disturbance_std = 3.0, &[Overconfident]),
    (
        "wrong frequency held for certain",
        |s| {
            s.filters[0].kind = FilterKind::KF;
            s.filters[0].initial_mean[Channel::NATURAL_FREQUENCY] = 5.7;
        },
        &[Overconfident, Diverged],
    ),
    (
        "fading without excitation",
        |s| {
            no_excitation(s);
            (s.filters[0].fading, s.duration) = (1.005, 20.0);
        },
        &[WoundUp, Lost, Diverged],
    ),
    (
        "stiffening spring",
        |s| {
            s.filters[0].plant = Some(std::mem::replace(&mut s.plant.kind, PlantKind::DUFFING));
            s.plant.set(Channel::CUBIC_STIFFNESS, 400.0);
        },
        &[Overconfident, Diverged],
    ),
    (
        "sure of a wrong frequency",
        |s| {
            s.filters[0].initial_mean[Channel::NATURAL_FREQUENCY] = 40.0;
            Channel::all().iter().for_each(|channel| s.filters[0].initial_std[*channel] *= 0.1);
            process_times(s, Channel::all(), 0.01);
        },
        &[Diverged],
    ),
];

#[track_caller]
fn assert_verdict(name: &str, seed: u64, expected: &[VerdictKind], verdict: Option<Verdict>) {
    let verdict = verdict.unwrap_or_else(|| panic!("{name}, seed {seed}: no verdict"));
    assert!(expected.contains(&verdict.kind), "{name}, seed {seed}: {verdict}");
}

#[test]
fn every_situation_has_its_verdict() {
    for kind in [FilterKind::EKF, FilterKind::UKF] {
        for &(name, change, expected) in SITUATIONS {
            for seed in SEEDS {
                let mut scenario = Scenario { seed, ..well_tuned(kind) };
                change(&mut scenario);
                let run = finished(&scenario);
                let name = format!("{}, {name}", kind.name());
                let found = verdict_on(&run).unwrap_or_else(|| panic!("{name}, seed {seed}: no verdict"));
                let is_named = found.kind != WoundUp || found.reason.contains("times its first value");
                assert!(is_named, "{name}, seed {seed}: {found}");
                assert_verdict(&name, seed, expected, Some(found));
                if kind == FilterKind::EKF && INNOVATIONS_TELL.iter().any(|told| name.ends_with(told)) {
                    let verdict = verdict_on(&finished_on(&scenario, run.record().clone().without_truth())).unwrap();
                    let said = "(the truth is not known: innovations only)";
                    assert!(verdict.reason.ends_with(said), "{verdict}");
                    assert_verdict(&format!("{name}, without the truth"), seed, expected, Some(verdict));
                }
            }
        }
    }
}

/// Situations whose verdict needs no truth.
const INNOVATIONS_TELL: [&str; 9] = [
    ", well tuned",
    "fading, sudden change",
    "Q too small, drift",
    "Q far too large",
    "R a tenth",
    "R tenfold",
    "small disturbance",
    "large disturbance",
    "wrong frequency held for certain",
];

#[test]
fn a_filter_that_learns_a_noise_that_was_too_large_is_underconfident_for_a_time() {
    for kind in [FilterKind::EKF, FilterKind::UKF] {
        for seed in SEEDS {
            let mut scenario = Scenario { seed, ..well_tuned(kind) };
            sensor_variance_times(&mut scenario, 10.0);
            let constant = verdict(&scenario).unwrap();
            scenario.filters[0].adaptation.sensor_noise = true;
            let learnt = verdict(&scenario).unwrap();
            let both = format!("{}, seed {seed}: {constant}; {learnt}", kind.name());
            assert!(constant.kind == Underconfident && learnt.kind == Recovered, "{both}");
            assert!(learnt.reason.starts_with("between 0 s and 6.0 s innovations² are 0."), "{both}");
        }
    }
}

#[test]
fn unidentified_parameters_are_named() {
    let mut scenario = well_tuned(FilterKind::EKF);
    no_excitation(&mut scenario);
    let reason = verdict(&scenario).unwrap().reason;
    assert!(reason.contains("σ of the damping ratio is still "), "{reason}");
    let reason = verdict(&well_tuned(FilterKind::EKF)).unwrap().reason;
    assert!(!reason.contains("still"), "{reason}");
}

const GOOD: &[VerdictKind] = &[Consistent, Recovered];
const UNTOLD: &[VerdictKind] = &[Consistent, NotIdentifiable];
const BAD: &[VerdictKind] = &[Overconfident];

const BUILT_IN: &[(&str, &[&[VerdictKind]])] = &[
    ("acceleration-only", &[GOOD, GOOD]),
    ("chirp", &[GOOD, GOOD]),
    ("constant", &[GOOD, GOOD]),
    ("free-vibration", &[GOOD, GOOD]),
    ("hammer", &[GOOD, GOOD]),
    ("known-parameters", &[GOOD, BAD]),
    ("no-excitation", &[UNTOLD, UNTOLD]),
    ("slow-drift", &[BAD, BAD]),
    ("stiffness-loss", &[GOOD, GOOD]),
];

#[test]
fn built_in_scenarios_have_their_verdicts() {
    for (name, expected) in BUILT_IN {
        let scenario = built_in(name);
        assert_eq!(scenario.filters.len(), expected.len());
        for (filter, &kinds) in scenario.filters.iter().zip(*expected) {
            let alone = |seed| Scenario { seed, filters: vec![filter.clone()], ..scenario.clone() };
            let name = format!("{name} {}", filter.name);
            assert_verdict(&name, scenario.seed, kinds, verdict(&alone(scenario.seed)));
            // Without excitation, about three records in a hundred give an error above 3σ.
            let right = SEEDS.filter(|&seed| kinds.contains(&verdict(&alone(seed)).unwrap().kind)).count();
            assert!(right >= 9, "{name}: {right} of 10");
        }
    }
}

#[test]
fn a_verdict_waits_for_twenty_measurements() {
    let scenario = well_tuned(FilterKind::EKF);
    let mut run = Run::new(&scenario).unwrap();
    run.advance_to(20);
    assert_eq!(verdict_on(&run), None);
    run.advance_to(21);
    assert!(verdict_on(&run).is_some());

    let mut stopping = Scenario { duration: 5.0, ..scenario };
    stopping.filters[0].fading = 1e60;
    let verdict = verdict(&stopping).unwrap();
    assert!(verdict.kind == Diverged && verdict.reason.starts_with("the "), "{verdict}");
}

#[test]
fn innovations_that_are_too_small_together_are_not_called_overconfident() {
    for seed in SEEDS {
        let mut scenario = Scenario { seed, duration: 60.0, ..well_tuned(FilterKind::EKF) };
        for (std, factor) in scenario.filters[0].sensor_std.iter_mut().zip([0.7_f64, 10.0]) {
            *std *= factor.sqrt();
        }
        let run = without_truth(&scenario);
        let nis = Diagnostics::new(&run.estimates()[0], run.record()).mean_nis().unwrap();
        assert!(nis.mean < 0.9 * nis.expected, "seed {seed}: {nis:?}");
        let verdict = verdict_on(&run).unwrap();
        assert!([Underconfident, VerdictKind::PatternLeft].contains(&verdict.kind), "seed {seed}: {verdict}");
        assert!(verdict.reason.contains("times what the filter expects"), "seed {seed}: {verdict}");
    }
}

#[test]
fn a_pattern_in_innovations_that_are_no_larger_than_expected_is_not_called_overconfident() {
    let mut left = 0;
    for seed in SEEDS {
        let mut scenario = Scenario { seed, duration: 60.0, ..well_tuned(FilterKind::EKF) };
        scenario.sensors.iter_mut().for_each(|sensor| with_fault(sensor, Fault::COLOURED, &[0.01]));
        let run = without_truth(&scenario);
        let nis = Diagnostics::new(&run.estimates()[0], run.record()).mean_nis().unwrap();
        let verdict = verdict_on(&run).unwrap();
        let is_above = nis.mean > nis.expected * (1.0 + 2.0 * (2.0 / (2.0 * 6000.0_f64)).sqrt());
        assert!(is_above || verdict.kind != Overconfident, "seed {seed}: {verdict}");
        if verdict.kind == VerdictKind::PatternLeft {
            // The noise of a Gauss-Markov process with a = 1/e has √((1 + a) / (1 - a)) = 1.47 times the effect of white noise.
            assert!(verdict.reason.contains("may be off by about 1."), "seed {seed}: {verdict}");
            left += 1;
        }
    }
    assert!(left >= 8, "{left} of ten");
}

#[test]
fn noise_that_is_common_to_two_sensors_is_named() {
    for seed in SEEDS {
        let mut scenario = Scenario { seed, duration: 60.0, ..well_tuned(FilterKind::EKF) };
        scenario.filters[0].sensor_std = vec![0.02, 0.1];
        for (sensor, std) in scenario.sensors.iter_mut().zip([0.02, 0.1]) {
            sensor.noise_std = std * 0.5_f64.sqrt();
        }
        let noise = simulate(&Scenario { seed: seed + 1000, force: Force::None, ..scenario.clone() });
        let noise = |k: usize| noise.measured(0)[k] / 0.02;
        let record = simulate(&scenario).with_measured(|sensor, k, x| x + [0.02, 0.1][sensor] * noise(k));
        let run = finished_on(&scenario, record.without_truth());
        assert!(!verdict_on(&run).unwrap().kind.is_good(), "seed {seed}");
        let found = remedies(&run, 0, run.record());
        assert_eq!(found[0].first.cause.key, "common_noise", "seed {seed}: {:?}", found[0].first.sentence);
    }
}

#[test]
fn two_gains_of_which_only_the_product_is_known_are_named() {
    for seed in SEEDS {
        let both = "augment = [\"input_gain\", \"sensor_gain_displacement\"]\n\
                    initial_std = { input_gain = 0.3, sensor_gain_displacement = 0.3 }\n";
        let one = "augment = [\"input_gain\"]\n";
        let [both, one] = [both, one].map(|augment| {
            let truth =
                "[plant]\nnatural_frequency = 6.0\n[[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.005\n";
            let text = format!("seed = {seed}\nduration = 60.0\n{truth}[[filters]]\nfading = 1.0\n{augment}");
            verdict_on(&without_truth(&Scenario::from_toml(&text).unwrap())).unwrap().reason
        });
        let words = "only the product of the input gain and the sensor gain of the displacement is known";
        assert!(both.contains(words) && !one.contains("is known, to"), "{seed}: {both}; {one}");
    }
}

#[test]
fn a_verdict_needs_readings_and_diagnostics_and_names_the_mirror_image() {
    let mut scenario = Scenario { duration: 20.0, ..well_tuned(FilterKind::EKF) };
    scenario.filters[0].initial_mean = values([0.0, 0.0, -7.0, -0.1]);
    let run = finished(&scenario);
    let (estimates, record) = (&run.estimates()[0], run.record());
    let of = |diagnostics: &Diagnostics| Diagnosis::new(diagnostics, estimates, record)?.verdict;
    let reason = of(&Diagnostics::new(estimates, record)).unwrap().reason;
    assert!(reason.contains("the mirror image"), "{reason}");
    assert_eq!(of(&Diagnostics::default()), None);
    scenario.sensors.clear();
    scenario.filters[0].sensor_std.clear();
    assert_eq!(verdict(&scenario), None);
}
