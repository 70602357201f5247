//! A structure in an earthquake: total acceleration, and a ground whose acceleration is linear between samples.

use std::sync::Arc;

use kalmanscope_core::diagnosis::VerdictKind;
use kalmanscope_core::import::{Builder, read};
use kalmanscope_core::{Analysis, Channel, Hold, Run, Scenario, Wanted};

use crate::lesson_records::earthquake;

/// Records of other noise than the one that comes along.
const SEEDS: std::ops::RangeInclusive<u64> = 101..=110;

/// The filters of the built-in scenario on another record.
fn identified(seed: u64, hold: Hold) -> Run {
    let mut scenario = Scenario::from_toml(include_str!("../../assets/scenarios/earthquake.toml")).unwrap();
    scenario.hold = hold;
    let table = read(earthquake::file(seed), None).unwrap();
    let mapping = scenario.record.clone().unwrap();
    let imported = Builder::new(&table, &mapping, scenario.input, hold).unwrap().finish().unwrap();
    let mut run = Run::on_record(&scenario, Arc::new(imported.record)).unwrap();
    run.finish();
    run
}

/// The last estimate of a channel.
fn last(run: &Run, filter: usize, channel: Channel) -> f64 {
    let estimates = &run.estimates()[filter];
    estimates.mean(estimates.len() - 1)[estimates.place(channel).unwrap()]
}

#[test]
fn frequency_and_damping_are_right_and_believed() {
    for seed in SEEDS {
        let run = identified(seed, Hold::First);
        let analysis = Analysis::new(&run, Wanted::default());
        for filter in 0..run.estimates().len() {
            let error = |channel, truth: f64| (last(&run, filter, channel) / truth - 1.0).abs();
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
            let zeta = last(&run, filter, Channel::DAMPING_RATIO) / earthquake::DAMPING_RATIO - 1.0;
            assert!(zeta > 0.03, "seed {seed}, filter {filter}: {zeta}");
            let (diagnosis, diagnostics) = (analysis.diagnosis(filter).unwrap(), &analysis.diagnostics()[filter]);
            assert!(!diagnosis.verdict.as_ref().unwrap().kind.is_good(), "seed {seed}, filter {filter}");
            let trials = diagnosis.trials(run.scenario(), filter, diagnostics, estimates, run.record());
            let mut trials = trials.unwrap();
            while !trials.advance(&mut || true) {}
            let first = trials.remedies().first().map(|remedy| remedy.first.cause.key);
            assert_eq!(first, Some("input_hold"), "seed {seed}, filter {filter}");
        }
    }
}
