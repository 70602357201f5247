//! The largest filters: a screen must be able to go on within a fraction of a second.

use std::sync::Arc;

use kalmanscope_core::{Channel, FilterKind, FilterSettings, Job, Run, Scenario, ScenarioError, Source, Study};

/// The default scenario with filters of a kind.
fn scenario(kind: FilterKind, filters: usize, members: usize) -> Scenario {
    let mut scenario = Scenario { duration: 1.0, ..Scenario::default() };
    let filter = FilterSettings { kind, ensemble_size: members, id: 0, ..scenario.filters[0].clone() };
    scenario.filters =
        (0..filters).map(|i| FilterSettings { name: format!("{} {i}", kind.name()), ..filter.clone() }).collect();
    scenario.number_filters();
    scenario
}

#[test]
fn one_sample_of_many_large_filters_is_divided() {
    let scenario = scenario(FilterKind::PF, 5, 6000);
    let mut study = Study::new(&scenario, Source::Simulated, 1000).expect("it can be run");
    // One piece of work a call.
    let mut calls = 0;
    while !study.advance_to(4, &mut || false) {
        calls += 1;
        for estimates in study.run().estimates() {
            assert_eq!(estimates.len(), study.run().len(), "all filters are shown at one sample");
        }
    }
    assert!(calls >= 4 * 5, "{calls}");
    let mut run = Run::new(&scenario).expect("it can be run");
    run.advance_to(4);
    assert_eq!(study.run().checksum(), run.checksum());
}

#[test]
fn a_filter_that_stops_and_one_of_a_measured_record_are_divided_with_the_same_bits() {
    let mut scenario = scenario(FilterKind::PF, 3, 6000);
    scenario.filters[1].initial_std = scenario.filters[1].initial_std.clone().with([(Channel::DISPLACEMENT, 1e200)]);
    scenario.filters[2].kind = FilterKind::ENKF;
    let mut simulated = Run::new(&scenario).expect("it can be run");
    simulated.finish();
    let record = Arc::new(simulated.record().clone());
    for source in [Source::Simulated, Source::Measured(record)] {
        let mut study = Study::new(&scenario, source, 50).expect("it can be run");
        while !study.advance_to(80, &mut || false) {}
        for (one, other) in study.run().estimates().iter().zip(simulated.estimates()) {
            assert_eq!(one.stop(), other.stop());
            let Some(last) = one.len().checked_sub(1) else { continue };
            let at = 79 - study.run().record().forgotten();
            assert_eq!((last, one.mean(at)), (at, other.mean(79)));
        }
    }
}

#[test]
fn a_filter_whose_sample_takes_too_long_is_refused_with_the_size_that_is_allowed() {
    let mut heavy = scenario(FilterKind::PF, 1, 100_000);
    assert_eq!(heavy.validate(), Ok(()));
    heavy.filters[0].substeps = 100;
    let Err(ScenarioError::Value { key, value, allowed }) = heavy.validate() else { panic!("it is allowed") };
    assert_eq!((key.as_str(), value.as_str()), ("filters[0].ensemble_size", "100000"));
    let most: usize = allowed.split_whitespace().find_map(|word| word.parse().ok()).expect("it says how many");
    heavy.filters[0].ensemble_size = most;
    assert_eq!(heavy.validate(), Ok(()));
    heavy.filters[0].ensemble_size = most + most / 100 + 1;
    assert!(heavy.validate().is_err());
}

/// Each step of the truth is halved again and again.
#[test]
fn a_truth_that_is_hard_to_follow_is_divided() {
    let text = include_str!("../../tests/hostile/hard-truth.toml");
    let scenario = Scenario::from_toml(text).expect("it is valid");
    let mut run = Run::new(&scenario).expect("it can be run");
    run.advance_to(40);
    let mut study = Study::new(&scenario, Source::Simulated, 1000).expect("it can be run");
    let mut calls = 1;
    while !study.advance_to(40, &mut || false) {
        calls += 1;
    }
    assert!(calls > 10, "{calls}");
    assert_eq!((study.run().truth_stop(), study.run().len()), (run.truth_stop(), run.len()));
    let truth = |run: &Run| run.record().truth(Channel::DISPLACEMENT).map(<[f64]>::to_vec);
    assert_eq!(truth(study.run()), truth(&run));
    // The same as the next picture.
    let another = Scenario { seed: 2, ..scenario };
    let mut job = Job::new(&mut study, &another, None, 40).expect("it can be run");
    let mut calls = 1;
    while !job.advance(&study, &mut || false).is_done() {
        calls += 1;
    }
    assert!(calls > 10, "{calls}");
}
