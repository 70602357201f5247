//! Jobs give the same bits as a run in one go, for any slices, also where a single sample of a large filter is divided.

use std::sync::Arc;

use kalmanscope_core::signal::Step;
use kalmanscope_core::{
    Channel, Evidence, FilterKind, FilterSettings, Hold, InputKind, Pass, Quantity, Run, RunError, Scenario,
    ScenarioError, Sensor, Signal, Source, Tape, Update,
};
use kalmanscope_diagnosis::{Hindsight, Job, Study, Wanted};

use crate::run::{assert_same_estimates, finished, finished_on, measured, of_all_kinds};

const WINDOW: usize = 100_000;

fn scenario() -> Scenario {
    let mut scenario = Scenario { duration: 8.0, ..Scenario::default() };
    let sensor_std = scenario.true_sensor_std();
    scenario.filters[0].smoother = true;
    let kind = FilterKind::PF;
    let particles = FilterSettings { name: "PF".to_owned(), kind, ensemble_size: 60, sensor_std, ..Default::default() };
    scenario.filters.insert(0, particles);
    for (filter, id) in scenario.filters.iter_mut().zip([7, 2, 3]) {
        filter.id = id;
    }
    scenario
}

fn study(scenario: &Scenario, source: Source, window: usize) -> Study {
    let mut study = Study::new(scenario, source, window).unwrap();
    study.want(Wanted { bounds: true, ..Wanted::default() });
    assert!(study.advance_to(usize::MAX, &mut || true));
    study
}

fn slices(pieces: usize) -> impl FnMut() -> bool {
    let mut left = pieces;
    move || {
        left = left.checked_sub(1).unwrap_or(pieces);
        left > 0
    }
}

fn complete(job: &mut Job, study: &Study, pieces: usize) -> Vec<f64> {
    let mut while_time = slices(pieces);
    let mut all = Vec::new();
    loop {
        let progress = job.advance(study, &mut while_time);
        all.push(progress.all);
        if progress.is_done() {
            assert!(progress.filters.iter().all(|&share| share == 1.0));
            return all;
        }
    }
}

fn turn(study: &mut Study, scenario: &Scenario, source: Option<Source>, samples: usize, pieces: usize) -> Update {
    let mut job = Job::new(study, scenario, source, samples).unwrap();
    complete(&mut job, study, pieces);
    job.finish(study)
}

fn assert_same(study: &Study, scenario: &Scenario) {
    let run = finished(scenario);
    let other = self::study(scenario, Source::Simulated, WINDOW);
    assert_eq!(study.run().checksum(), run.checksum());
    assert_eq!(study.run().record(), run.record());
    assert_eq!((study.run().done(), study.run().samples()), (run.done(), run.samples()));
    assert_eq!(study.analysis().diagnostics().len(), run.estimates().len());
    for (one, other) in study.analysis().diagnostics().iter().zip(other.analysis().diagnostics()) {
        assert_eq!(one.log_likelihood().to_bits(), other.log_likelihood().to_bits());
        assert_eq!(one.nees().last().map(|x| x.to_bits()), other.nees().last().map(|x| x.to_bits()));
    }
    let smoothed = run.smoothed();
    assert_eq!(study.analysis().smoothed().len(), smoothed.len());
    for (one, other) in study.analysis().smoothed().iter().zip(&smoothed) {
        assert_eq!((one.name(), one.len(), one.checksum()), (other.name(), other.len(), other.checksum()));
    }
    for filter in &scenario.filters {
        let [one, other] = [study, &other].map(|s| s.analysis().bound(filter.id).unwrap());
        assert_eq!((one.len(), one.std(600, 2).to_bits()), (other.len(), other.std(600, 2).to_bits()));
    }
}

#[test]
fn a_job_gives_the_bits_of_a_run_for_any_slices() {
    for pieces in [1, 2, 7, usize::MAX] {
        let before = scenario();
        let mut study = study(&before, Source::Simulated, WINDOW);
        let checksum = study.run().checksum();
        let mut edited = before.clone();
        edited.sensors[0].noise_std *= 1.5;
        edited.filters.remove(2);
        let mut job = Job::new(&mut study, &edited, None, edited.samples()).unwrap();
        let progress = complete(&mut job, &study, pieces);
        assert!(progress.is_sorted(), "{progress:?}");
        assert_eq!(study.run().checksum(), checksum, "the study stays as it is");
        assert_eq!(job.finish(&mut study), Update::Everything);
        assert_same(&study, &edited);
    }
}

#[test]
fn unaffected_parts_are_not_computed_again() {
    let mut current = scenario();
    let mut study = study(&current, Source::Simulated, WINDOW);
    type Edit = fn(&mut Scenario);
    let edits: [(Edit, &[u32]); 6] = [
        (|s| s.filters[2].fading = 1.01, &[3]),
        (|s| s.filters[1].iterations += 1, &[2]),
        (|s| s.filters.insert(1, FilterSettings { name: "new".to_owned(), id: 9, ..s.filters[1].clone() }), &[9]),
        (|s| s.filters.truncate(3), &[]),
        (|s| s.filters.swap(0, 2), &[]),
        (|s| s.filters[2].ensemble_size = 70, &[7]),
    ];
    for (edit, changed) in edits {
        edit(&mut current);
        let samples = current.samples();
        assert_eq!(turn(&mut study, &current, None, samples, 1), Update::Filters(changed.to_vec()));
        // The analysis of unchanged filters may still be behind.
        assert!(study.advance_to(samples, &mut || true));
        assert_same(&study, &current);
    }
}

#[test]
fn a_scenario_that_is_handed_over_gets_unique_ids() {
    let twice = Scenario { filters: vec![FilterSettings { id: 0, ..scenario().filters[1].clone() }; 2], ..scenario() };
    let run = Run::from_source(twice, Source::Simulated).unwrap();
    assert_eq!(run.scenario().filters.iter().map(|filter| filter.id).collect::<Vec<_>>(), [1, 2]);
}

#[test]
fn an_abandoned_job_changes_nothing() {
    let before = scenario();
    let mut study = study(&before, Source::Simulated, WINDOW);
    let longer = Scenario { duration: 60.0, ..before.clone() };
    let mut job = Job::new(&mut study, &longer, None, longer.samples()).unwrap();
    assert!(!job.advance(&study, &mut || false).is_done());
    job.cancel(&mut study);
    assert_same(&study, &before);
    let wrong = Scenario { dt: -1.0, ..before.clone() };
    assert!(matches!(Job::new(&mut study, &wrong, None, 801), Err(RunError::Scenario(_))));
    assert_same(&study, &before);
}

#[test]
fn cheap_filters_come_first() {
    let before = scenario();
    let mut study = study(&before, Source::Simulated, WINDOW);
    let mut edited = Scenario { seed: 5, duration: 30.0, ..before };
    edited.filters[0].ensemble_size = 1000;
    let mut job = Job::new(&mut study, &edited, None, edited.samples()).unwrap();
    let mut while_time = slices(1);
    loop {
        let progress = job.advance(&study, &mut while_time);
        assert!(progress.filters[0] == 0.0 || progress.filters[1..] == [1.0, 1.0], "{progress:?}");
        if progress.filters[0] > 0.0 {
            assert!(progress.filters[0] < 0.02, "the time is looked at often: {progress:?}");
            break;
        }
    }
}

#[test]
fn a_study_with_a_window_keeps_the_same_samples_however_it_comes_there() {
    let scenario = Scenario { duration: 20.0, ..scenario() };
    let mut stepped = Study::new(&scenario, Source::Simulated, 500).unwrap();
    while !stepped.advance_to(1801, &mut || false) {}
    let other = Scenario { seed: 3, ..scenario.clone() };
    let mut jumped = Study::new(&other, Source::Simulated, 500).unwrap();
    turn(&mut jumped, &scenario, None, 1801, 3);
    for study in [&stepped, &jumped] {
        assert_eq!((study.run().done(), study.run().record().forgotten()), (1801, 1500));
        assert_eq!(study.run().checksum(), stepped.run().checksum());
        assert_eq!(study.analysis().diagnostics()[1].len(), 301);
        let settled = |study: &Study| study.analysis().diagnostics()[1].settled(Channel::NATURAL_FREQUENCY);
        assert_eq!(settled(study), settled(&stepped));
    }
    let mut run = finished(&scenario);
    while !jumped.advance_to(2001, &mut || false) {}
    run.forget(run.len() - jumped.run().len());
    assert_eq!(run.checksum(), jumped.run().checksum());
}

#[test]
fn a_measured_record_stays_when_settings_change() {
    let mut current = scenario();
    let record = Arc::new(measured(&current));
    let mut run = finished_on(&current, Arc::clone(&record));
    let is_measured = |run: &Run| matches!(run.source(), Source::Measured(same) if Arc::ptr_eq(&same, &record));
    let fresh = |scenario: &Scenario| finished_on(scenario, Arc::clone(&record)).checksum();
    current.filters[1].fading = 1.02;
    assert_eq!(run.update(&current).unwrap(), Update::Filters(vec![2]));
    assert!(is_measured(&run) && run.checksum() == fresh(&current));
    // The settings of the truth do not affect a measured record.
    current.duration = 99.0;
    current.plant.disturbance_std *= 2.0;
    assert_eq!(run.update(&current).unwrap(), Update::Filters(vec![]));
    assert!(is_measured(&run) && run.checksum() == fresh(&current));
    // The seed affects the filters' random numbers.
    current.seed += 1;
    assert_eq!(run.update(&current).unwrap(), Update::Everything);
    run.finish();
    assert!(is_measured(&run) && run.checksum() == fresh(&current));

    let mut other = current.clone();
    other.input = InputKind::GroundAcceleration;
    let error = run.update(&other).unwrap_err();
    assert!(error.to_string().contains("a force, but the scenario's is the acceleration of the ground"), "{error}");
    assert_eq!((is_measured(&run), run.checksum()), (true, fresh(&current)));
    other = current.clone();
    other.add_sensor(Sensor::new(Quantity::ACCELERATION, 0.1));
    if record.measured_quantity(Quantity::ACCELERATION).is_none() {
        assert_eq!(run.update(&other), Err(RunError::MissingSensor(Quantity::ACCELERATION)));
        assert_eq!(run.checksum(), fresh(&current));
    }
}

#[test]
fn a_study_goes_from_a_simulation_to_a_record_and_back() {
    let current = scenario();
    let record = Arc::new(measured(&current));
    let mut study = study(&current, Source::Simulated, 300);
    let source = Some(Source::Measured(Arc::clone(&record)));
    assert_eq!(turn(&mut study, &current, source, record.len(), 2), Update::Everything);
    assert_eq!((study.run().len(), study.run().record()), (record.len(), &*record));
    assert!(study.analysis().bounds()[0].bound.is_empty(), "no truth, no bound");
    let mut edited = current.clone();
    edited.filters[2].fading = 1.03;
    assert_eq!(turn(&mut study, &edited, None, record.len(), 2), Update::Filters(vec![3]));
    assert_eq!(study.run().record(), &*record);
    assert_eq!(study.run().checksum(), finished_on(&edited, record).checksum());
    turn(&mut study, &current, Some(Source::Simulated), 201, 2);
    assert_eq!((study.run().len(), study.run().samples()), (201, current.samples()));
}

fn heavy(kind: FilterKind, filters: usize, members: usize) -> Scenario {
    let mut scenario = Scenario { duration: 1.0, ..Scenario::default() };
    let filter = FilterSettings { kind, ensemble_size: members, id: 0, ..scenario.filters[0].clone() };
    scenario.filters =
        (0..filters).map(|i| FilterSettings { name: format!("{} {i}", kind.name()), ..filter.clone() }).collect();
    scenario.number_filters();
    scenario
}

#[test]
fn one_sample_of_many_large_filters_is_divided() {
    let scenario = heavy(FilterKind::PF, 5, 6000);
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
    let mut scenario = heavy(FilterKind::PF, 3, 6000);
    scenario.filters[1].initial_std = scenario.filters[1].initial_std.clone().with([(Channel::DISPLACEMENT, 1e200)]);
    scenario.filters[2].kind = FilterKind::ENKF;
    let simulated = finished(&scenario);
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
    let mut large = heavy(FilterKind::PF, 1, 100_000);
    assert_eq!(large.validate(), Ok(()));
    large.filters[0].substeps = 100;
    let Err(ScenarioError::Value { key, value, allowed }) = large.validate() else { panic!("it is allowed") };
    assert_eq!((key.as_str(), value.as_str()), ("filters[0].ensemble_size", "100000"));
    let most: usize = allowed.split_whitespace().find_map(|word| word.parse().ok()).expect("it says how many");
    large.filters[0].ensemble_size = most;
    assert_eq!(large.validate(), Ok(()));
    large.filters[0].ensemble_size = most + most / 100 + 1;
    assert!(large.validate().is_err());
}

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

/// For filters that are computed elsewhere, as by workers of a page.
fn elsewhere() -> Scenario {
    let mut scenario = Scenario { duration: 6.0, ..Scenario::default() };
    let first = scenario.filters[0].clone();
    // The plant changes, so that filters jump.
    scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Step(Step { from: 6.0, to: 3.0, at: 3.0 }));
    scenario.filters = of_all_kinds(&first);
    scenario.filters.iter_mut().for_each(|filter| filter.jump = filter.kind != FilterKind::KF);
    let mut learns = FilterSettings { id: 0, kind: FilterKind::EKF, ..first.clone() };
    learns.adaptation.sensor_noise = true;
    let stops = FilterSettings { id: 0, kind: FilterKind::EKF, fading: 1e100, ..first };
    scenario.filters.extend([learns, stops]);
    scenario.number_filters();
    scenario
}

fn short_study() -> Study {
    Study::new(&Scenario { duration: 1.0, ..Scenario::default() }, Source::Simulated, WINDOW).unwrap()
}

#[test]
fn filters_that_are_computed_elsewhere_have_the_same_bits() {
    let (scenario, mut near, mut far) = (elsewhere(), short_study(), short_study());
    let mut job = Job::new(&mut near, &scenario, None, 601).unwrap();
    while !job.advance(&near, &mut || true).is_done() {}
    job.finish(&mut near);
    let mut job = Job::new(&mut far, &scenario, None, 601).unwrap();
    let places = job.leave_long(0.0);
    assert_eq!(places.len(), scenario.filters.len());
    assert!(!job.advance(&far, &mut || true).is_done());
    let record = job.whole_record(&far).unwrap().clone();
    for place in places {
        let mut pass = Pass::new(&scenario, place, &record).unwrap();
        for samples in [4, 300, 601] {
            let mut tape = Tape::default();
            pass.follow(&record, samples, &mut tape);
            assert!(job.take(place, &Tape(tape.0.clone())));
        }
        assert!(!job.take(place, &Tape(vec![1.0, 0.0, 0.0, 7.0])), "no sample of this filter");
    }
    assert!(job.advance(&far, &mut || true).is_done());
    assert_eq!(job.finish(&mut far), Update::Everything);
    for (near, far) in near.run().estimates().iter().zip(far.run().estimates()) {
        assert_same_estimates(near, far, near.name());
        assert!(near.jumps().eq(far.jumps()), "{}", near.name());
    }
    assert!(near.run().estimates().iter().any(|estimates| estimates.stop().is_some()));
    assert!(near.run().estimates().iter().filter(|estimates| estimates.jumps().next().is_some()).count() > 3);
    assert!(near.run().estimates().iter().any(|estimates| !estimates.remarks().is_empty()));
}

#[test]
fn filters_that_are_taken_back_begin_again() {
    let (scenario, mut study) = (elsewhere(), short_study());
    let part = Job::new(&mut study, &scenario, None, 300).unwrap().leave_long(0.0);
    assert!(part.is_empty(), "a part of a record is computed here");
    let mut job = Job::new(&mut study, &scenario, None, 601).unwrap();
    let places = job.leave_long(0.0);
    job.advance(&study, &mut || true);
    let record = job.whole_record(&study).unwrap().clone();
    let mut tape = Tape::default();
    Pass::new(&scenario, places[0], &record).unwrap().follow(&record, 200, &mut tape);
    assert!(job.take(places[0], &tape));
    job.take_back();
    assert!(job.advance(&study, &mut || true).is_done());
    job.finish(&mut study);
    assert_eq!(study.run().checksum(), finished(&scenario).checksum());
}

#[test]
fn an_edit_of_a_live_record_gives_the_bits_of_a_new_run() {
    let mut scenario = Scenario { hold: Hold::First, duration: 5.0, ..scenario() };
    scenario.filters[2].input_delay = -3;
    let record = measured(&scenario);
    let part = |length: usize| Arc::new(record.part(0..length));
    let mut study = Study::new(&scenario, Source::Live(part(100)), 1000).expect("it can be run");
    study.want(Wanted { smoothed: Hindsight::All, ..Wanted::NOTHING });
    let everything = usize::MAX;
    study.advance_to(everything, &mut || true);
    assert!(study.lengthen(part(250)));
    study.advance_to(everything, &mut || true);
    scenario.filters[1].fading = 1.02;
    let done = study.run().done();
    let mut job = Job::new(&mut study, &scenario, None, done).expect("it is possible");
    while !job.advance(&study, &mut || false).is_done() {}
    assert!(study.lengthen(part(300)), "it grows while the job is under way");
    job.finish(&mut study);
    study.advance_to(everything, &mut || true);
    assert_eq!(study.run().done(), 297);
    assert!(study.analysis().smoothed().is_empty(), "a smoother needs the end, which has not come");
    let mut whole = Run::on_record(&scenario, part(300)).expect("it can be run");
    whole.advance_to(297);
    assert_eq!(study.run().checksum(), whole.checksum());
}

#[test]
fn a_study_has_the_evidence_however_it_goes_on() {
    let scenario = Scenario { duration: 20.0, ..Scenario::default() };
    let whole = finished(&scenario);
    let all: Vec<Evidence> = whole.estimates().iter().map(Evidence::new).collect();
    for window in [usize::MAX, 200] {
        let mut study = Study::new(&scenario, Source::Simulated, window).expect("it is possible");
        study.want(Wanted::EVIDENCE);
        for done in [7, 500, 2001] {
            while !study.advance_to(done, &mut || false) {}
            let (run, evidence) = (study.run(), study.analysis().evidence());
            assert_eq!(evidence.len(), 2);
            for (evidence, all) in evidence.iter().zip(&all) {
                let forgotten = run.record().forgotten();
                assert_eq!(evidence.len(), run.len());
                assert!((0..run.len()).all(|k| evidence.at(k) == all.at(forgotten + k)));
                assert_eq!(evidence.at(run.len()), None);
            }
        }
    }
}
