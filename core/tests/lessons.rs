//! Records of lessons, of other noise and forces than those that come along: a structure in an earthquake, whose total acceleration is
//! measured over a ground that is linear between samples; and a stiffness that goes up and down in steps, under a force that nobody
//! measures.

use kalmanscope_core::diagnosis::VerdictKind;
use kalmanscope_core::{Analysis, Channel, Hold, Run, Scenario, Wanted};

use crate::run::{finished_on_file, last, remedies};

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

fn identified(seed: u64, hold: Hold) -> Run {
    let scenario = Scenario::from_toml(include_str!("../../assets/scenarios/earthquake.toml")).unwrap();
    finished_on_file(&Scenario { hold, ..scenario }, earthquake::file(seed))
}

fn followed(seed: u64, change: impl Fn(&mut Scenario)) -> Run {
    let mut scenario = Scenario::from_toml(include_str!("../../assets/scenarios/staircase.toml")).unwrap();
    change(&mut scenario);
    finished_on_file(&scenario, staircase::file(seed))
}

#[test]
fn frequency_and_damping_are_right_and_believed() {
    for seed in SEEDS {
        let run = identified(seed, Hold::First);
        let analysis = Analysis::new(&run, Wanted::default());
        for filter in 0..run.estimates().len() {
            let error = |channel, truth: f64| (last(&run.estimates()[filter], channel).0 / truth - 1.0).abs();
            let wn = error(Channel::NATURAL_FREQUENCY, earthquake::NATURAL_FREQUENCY);
            let zeta = error(Channel::DAMPING_RATIO, earthquake::DAMPING_RATIO);
            assert!(wn < 0.002 && zeta < 0.03, "seed {seed}, filter {filter}: {wn}, {zeta}");
            let verdict = analysis.diagnosis(filter).unwrap().verdict.as_ref().unwrap();
            assert_eq!(verdict.kind, VerdictKind::Consistent, "seed {seed}, filter {filter}: {verdict}");
        }
    }
}

#[test]
fn a_ground_that_is_held_is_named_as_the_cause() {
    for seed in SEEDS {
        let run = identified(seed, Hold::Zero);
        let analysis = Analysis::new(&run, Wanted::default());
        for (filter, estimates) in run.estimates().iter().enumerate() {
            let zeta = last(estimates, Channel::DAMPING_RATIO).0 / earthquake::DAMPING_RATIO - 1.0;
            assert!(zeta > 0.03, "seed {seed}, filter {filter}: {zeta}");
            let verdict = analysis.diagnosis(filter).unwrap().verdict.as_ref().unwrap();
            assert!(!verdict.kind.is_good(), "seed {seed}, filter {filter}");
            let first = remedies(&run, filter, run.record()).first().map(|remedy| remedy.first.cause.key);
            assert_eq!(first, Some("input_hold"), "seed {seed}, filter {filter}");
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
fn fading_memory_follows_each_step_within_two_per_cent() {
    for seed in SEEDS {
        let run = followed(seed, |_| {});
        for filter in 0..run.estimates().len() {
            let errors = errors(&run, filter);
            assert!(errors.iter().all(|error| error.abs() < 0.02), "seed {seed}, filter {filter}: {errors:?}");
        }
    }
}

#[test]
fn a_filter_that_never_forgets_is_left_behind() {
    for seed in SEEDS {
        let run = followed(seed, |scenario| scenario.filters.iter_mut().for_each(|filter| filter.fading = 1.0));
        let errors = errors(&run, 0);
        assert!(errors[3] < -0.05, "seed {seed}: {errors:?}");
    }
}
