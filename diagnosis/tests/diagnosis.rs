//! The diagnosis on situations drawn at random, of seeds that no limit was set on: part of the tables that
//! `cargo bench -p kalmanscope-diagnosis --bench diagnosis` prints; and a diagnosis that follows a record.

use std::sync::Arc;

use kalmanscope_core::{Channel, Diagnostics, Record, Run, Scenario, simulate};
use kalmanscope_diagnosis::{CAUSES, Diagnosis, Evidence, LiveDiagnosis, TESTS, VerdictKind};

use crate::judgement::{diagnosis, remedies};
use crate::run::{built_in, finished_on, readings, with_input};
use crate::situations::{FIRST, Fault, Situation, largest_error, without_truth};
use crate::threads::on_two_threads;

struct Outcome {
    fault: Fault,
    name: String,
    verdicts: [VerdictKind; 2],
    off: f64,
    causes: Vec<&'static str>,
}

fn outcome(situation: &Situation, seed: u64, with_causes: bool) -> Outcome {
    let known = situation.record().unwrap();
    let run = finished_on(&situation.told, known.clone());
    let estimates = &run.estimates()[0];
    let mut causes = Vec::new();
    let verdicts = [known.clone(), without_truth(&known)].map(|record| {
        let verdict = diagnosis(estimates, &record).verdict;
        if with_causes && causes.is_empty() {
            causes.extend(remedies(&run, 0, &record).iter().map(|remedy| remedy.first.cause.key));
        }
        verdict.map_or(VerdictKind::Diverged, |verdict| verdict.kind)
    });
    let off = largest_error(estimates, &known);
    let name = format!("{:?} [{}], seed {seed}", situation.faults, situation.note);
    Outcome { fault: situation.faults[0], name, verdicts, off, causes }
}

fn outcomes(faults: &[Fault], number: u64, with_causes: bool) -> Vec<Outcome> {
    let all: Vec<_> = faults.iter().flat_map(|&fault| (FIRST..FIRST + number).map(move |seed| (fault, seed))).collect();
    on_two_threads(&all, |&(fault, seed)| outcome(&Situation::with(fault, seed), seed, with_causes))
}

#[test]
fn well_tuned_filters_raise_no_alarm() {
    let all = outcomes(&[Fault::WellTuned], 150, false);
    let alarms: Vec<_> = all.iter().filter(|o| o.verdicts.iter().any(|v| *v != VerdictKind::Consistent)).collect();
    assert!(alarms.len() <= 2, "{:?}", alarms.iter().map(|o| (&o.name, o.verdicts)).collect::<Vec<_>>());
}

#[test]
fn no_verdict_is_the_contrary_of_what_is_true_or_blind() {
    for seed in FIRST..FIRST + 240 {
        let Outcome { fault, name, verdicts, off, .. } = outcome(&Situation::draw(seed), seed, false);
        for verdict in verdicts {
            assert!(!fault.contrary().contains(&verdict), "{name}: {verdict:?}");
        }
        assert!(!(off > 5.0 && verdicts[0].is_good()), "{name}: {off}σ off and {:?}", verdicts[0]);
    }
}

#[test]
fn wrong_settings_are_found_with_and_without_the_truth() {
    let of_sensors = [Fault::SensorNoiseTooLarge, Fault::SensorNoiseTooSmall, Fault::SensorNoiseContrary];
    let others = [Fault::ProcessNoiseTooSmall, Fault::MissingMode, Fault::WindUp, Fault::SuddenChange];
    for (faults, shares) in [(&of_sensors[..], [0.95, 0.95]), (&others[..], [0.95, 0.8])] {
        for (&fault, known) in faults.iter().flat_map(|fault| [(fault, 0), (fault, 1)]) {
            let all = outcomes(&[fault], 30, false);
            let found = all.iter().filter(|o| o.verdicts[known] != VerdictKind::Consistent).count();
            assert!(found as f64 >= shares[known] * 30.0 - 1.0, "{fault:?}: {found} of 30");
        }
    }
}

#[test]
fn the_cause_is_among_the_first_two_that_are_named() {
    let faults: Vec<Fault> = Fault::ALL.iter().copied().filter(|fault| !fault.causes().is_empty()).collect();
    let all = outcomes(&faults, 4, true);
    let wrong: Vec<_> =
        all.iter().filter(|o| o.verdicts.iter().any(|verdict| *verdict != VerdictKind::Consistent)).collect();
    let named = wrong.iter().filter(|o| o.causes.iter().take(2).any(|cause| o.fault.causes().contains(cause))).count();
    assert!(named as f64 >= 0.8 * wrong.len() as f64, "{named} of {}", wrong.len());
}

#[test]
fn a_sample_of_too_few_particles_is_called_collapsed_and_a_sound_one_is_not() {
    let all = outcomes(&[Fault::CollapsedSample, Fault::LargeSample], 15, false);
    let of = |is: fn(f64) -> bool| all.iter().filter(move |outcome| is(outcome.off));
    for (sound, verdicts) in of(|off| off < 2.0).map(|outcome| (&outcome.name, outcome.verdicts)) {
        assert!(!verdicts.contains(&VerdictKind::Collapsed), "{sound}");
    }
    let gone = || of(|off| off > 100.0);
    let is_found = |outcome: &&Outcome| {
        outcome.verdicts.iter().all(|v| matches!(v, VerdictKind::Collapsed | VerdictKind::Lost | VerdictKind::Diverged))
    };
    assert!(gone().count() >= 5 && gone().filter(is_found).count() + 1 >= gone().count(), "{}", gone().count());
}

fn of_the_spring(situation: &Situation) -> Option<String> {
    let record = without_truth(&situation.record().unwrap());
    let remedies = remedies(&finished_on(&situation.told, record.clone()), 0, &record);
    remedies.into_iter().find(|one| one.first.cause.key == "spring").map(|one| one.first.sentence)
}

#[test]
fn a_spring_that_hardens_is_not_said_to_yield_nor_the_other_way_round() {
    let mut said = [(0, 0); 2];
    for seed in FIRST..FIRST + 6 {
        for times in [1.0, 3.0, 10.0] {
            let mut hardening = Situation::with(Fault::HardeningSpring, seed);
            let cubic = hardening.truth.plant.parameter(Channel::CUBIC_STIFFNESS).unwrap().at(0.0);
            hardening.truth.plant.set(Channel::CUBIC_STIFFNESS, times * cubic);
            if let Some(sentence) = of_the_spring(&hardening) {
                let right = sentence.starts_with("the spring hardens");
                said[0] = (said[0].0 + usize::from(right), said[0].1 + 1);
                assert!(right, "{}, seed {seed}, {times} times that: {sentence}", hardening.note);
            }
        }
        if let Some(sentence) = of_the_spring(&Situation::with(Fault::YieldingSpring, seed)) {
            let right = sentence.contains("yields") || sentence.contains("softens");
            said[1] = (said[1].0 + usize::from(right), said[1].1 + 1);
        }
    }
    assert!(said[0].1 >= 16 && said[1].1 >= 5 && said[1].0 + 1 >= said[1].1, "{said:?}");
}

#[test]
fn tests_and_causes_have_names_of_their_own_and_say_how_to_read_them() {
    for test in TESTS {
        assert_eq!(TESTS.iter().filter(|other| other.name == test.name).count(), 1, "{}", test.name);
        for text in [test.statistic, test.distribution, test.source, test.reading] {
            assert!(!text.is_empty(), "{}", test.name);
        }
    }
    for cause in CAUSES {
        assert_eq!(CAUSES.iter().filter(|other| other.key == cause.key).count(), 1, "{}", cause.key);
        assert!(!cause.hint.is_empty());
    }
    let known = |key: &&str| CAUSES.iter().any(|cause| cause.key == *key);
    assert!(Fault::ALL.iter().all(|fault| fault.causes().iter().all(known)));
}

#[test]
fn what_a_filter_has_recovered_from_is_said() {
    let mut told = Vec::new();
    for seed in [503_256, 504_624, 505_632] {
        let situation = Situation::draw(seed);
        let record = situation.record().unwrap();
        let run = finished_on(&situation.told, record.clone());
        let evidence = diagnosis(&run.estimates()[0], &record).evidence;
        let recovery = evidence.into_iter().filter(|one| one.test.name == "recovery");
        told.extend(recovery.map(|one| one.sentence));
    }
    assert_eq!(told.len(), 3);
    assert!(told.iter().all(|sentence| sentence.contains("is off by")), "{told:#?}");
}

const WINDOW: usize = 2000;

/// A multiple of the length of every window of a periodogram.
const ALIGNED: usize = 1024;

const SCENARIOS: &str = "acceleration-only chirp hammer free-vibration no-excitation r-wrong-by-ten shear-building \
                         staircase stiffness-loss";

fn is_line(one: &Evidence) -> bool {
    one.test.name.contains("spectrum")
}

fn is_near(a: f64, b: f64, tolerance: f64) -> bool {
    a == b || a.is_nan() && b.is_nan() || (a - b).abs() <= tolerance * (a.abs() + b.abs())
}

/// Different windows of the periodograms change the numbers of lines; returns whether then other evidence counts.
fn assert_same(live: &Diagnosis, whole: &Diagnosis, same_windows: bool, name: &str) -> bool {
    assert_eq!(live.bad_parts, whole.bad_parts, "{name}");
    let counting = |of: &Diagnosis| of.evidence.iter().map(|one| one.counts).collect::<Vec<bool>>();
    let differ = !same_windows && live.evidence.iter().any(is_line) && counting(live) != counting(whole);
    assert_eq!(live.evidence.len(), whole.evidence.len(), "{name}");
    for (a, b) in live.evidence.iter().zip(&whole.evidence) {
        let what = format!("{name}: {a:?} instead of {b:?}");
        assert_eq!((a.test.name, a.subject, a.speaks_for), (b.test.name, b.subject, b.speaks_for), "{what}");
        assert_eq!(a.samples, b.samples, "{what}");
        assert!(differ || a.counts == b.counts, "{what}");
        if same_windows || !is_line(a) {
            assert!(is_near(a.statistic, b.statistic, 1e-7) && is_near(a.effect, b.effect, 1e-7), "{what}");
            assert!((a.p_value - b.p_value).abs() < 1e-6, "{what}");
        }
    }
    if !differ {
        let kinds = [live, whole].map(|of| of.verdict.as_ref().map(|verdict| verdict.kind));
        assert_eq!(kinds[0], kinds[1], "{name}");
    }
    differ
}

#[derive(Default)]
struct Compared {
    all: usize,
    lines: usize,
}

fn compare(run: &mut Run, known: Option<&Arc<Record>>, forgets: bool, name: &str, compared: &mut Compared) {
    let mut live: Vec<LiveDiagnosis> = run.estimates().iter().map(|_| LiveDiagnosis::default()).collect();
    for portion in [7, 15, 1, 33, 60, 200, 97, 30, 31, 250, 60, 3, 0, 900, 61, 60, 59, 1157, 1343, 30, 400, 401, 402] {
        run.advance_to(run.done() + portion);
        if forgets && run.len() > WINDOW + 900 {
            assert!(run.forget(run.len() - WINDOW - 5));
        }
        let record = known.map_or(run.record(), |known| known.as_ref());
        for (estimates, live) in run.estimates().iter().zip(&mut live) {
            let diagnostics = Diagnostics::new(estimates, record);
            let samples = run.len().saturating_sub(WINDOW)..run.len();
            let name = format!("{name}, {}, {samples:?} after {}", estimates.name(), record.forgotten());
            let is_aligned = (record.forgotten() + samples.start).is_multiple_of(ALIGNED);
            let ours = live.over(samples.clone(), &diagnostics, estimates, record, None).unwrap();
            if portion % 5 == 0 {
                // Another window between, also one that begins earlier, changes nothing.
                live.over(samples.start.saturating_sub(700)..samples.end, &diagnostics, estimates, record, None);
                let again = live.over(samples.clone(), &diagnostics, estimates, record, None).unwrap();
                assert!(!assert_same(&again, &ours, true, &name));
            }
            let whole = Diagnosis::over(samples, &diagnostics, estimates, record, None).unwrap();
            let is_whole = is_aligned && whole.bad_parts.is_empty();
            compared.all += 1;
            compared.lines += usize::from(assert_same(&ours, &whole, is_whole, &name));
        }
    }
}

#[test]
fn built_in_scenarios_have_the_diagnoses_of_one_pass() {
    for forgets in [false, true] {
        let mut compared = Compared::default();
        for name in SCENARIOS.split(' ') {
            compare(&mut Run::new(&built_in(name)).unwrap(), None, forgets, name, &mut compared);
        }
        assert!(compared.all > 350 && compared.lines <= compared.all / 30, "{} of {}", compared.lines, compared.all);
    }
}

#[test]
fn situations_at_random_have_the_diagnoses_of_one_pass() {
    let mut compared = Compared::default();
    for seed in 40..40 + 2 * Fault::ALL.len() as u64 {
        let situation = Situation::draw(seed);
        let mut record = situation.record().unwrap();
        let mut run = Run::on_record(&situation.told, Arc::clone(&record)).unwrap();
        if seed % 2 == 0 {
            record = without_truth(&record);
        }
        let name = format!("{:?} [{}], seed {seed}", situation.faults, situation.note);
        compare(&mut run, Some(&record), false, &name, &mut compared);
    }
    assert!(compared.lines <= compared.all / 30, "{} of {}", compared.lines, compared.all);
}

fn changed(change: impl Fn(usize, &mut f64, &mut [f64])) -> (Run, Arc<Record>) {
    let scenario = Scenario { duration: 60.0, ..Scenario::default() };
    let record = simulate(&scenario);
    let mut rows: Vec<(f64, Vec<f64>)> = (0..record.len()).map(|k| (record.input()[k], readings(&record, k))).collect();
    rows.iter_mut().enumerate().for_each(|(k, (force, measured))| change(k, force, measured));
    let record = with_input(&record, rows.iter().map(|row| row.0).collect());
    let record = Arc::new(record.with_measured(|sensor, k, _| rows[k].1[sensor]));
    (Run::on_record(&scenario, Arc::clone(&record)).unwrap(), record)
}

#[test]
fn missing_numbers_and_large_ones_change_nothing() {
    type Change = fn(usize, &mut f64, &mut [f64]);
    let changes: [(&str, Change); 7] = [
        ("every third missing", |k, _, z| z[k % 2] = if k % 3 == 0 { f64::NAN } else { z[k % 2] }),
        ("a gap", |k, _, z| z.iter_mut().for_each(|z| *z = if (1500..2100).contains(&k) { f64::NAN } else { *z })),
        ("one sensor only", |_, _, z| z[1] = f64::NAN),
        ("a jump", |k, _, z| z[0] += if k == 2005 { 1e10 } else { 0.0 }),
        ("strokes", |k, f, _| *f = if k % 300 == 17 { 400.0 } else { 0.01 * *f }),
        ("a huge stroke", |k, f, _| *f += if k == 2005 { 1e10 } else { 0.0 }),
        ("an offset", |_, f, _| *f += 1e6),
    ];
    let mut compared = Compared::default();
    for (name, change) in changes {
        let (mut run, record) = changed(change);
        compare(&mut run, Some(&record), false, name, &mut compared);
        let (live, estimates) = (&mut LiveDiagnosis::default(), &run.estimates()[0]);
        assert!(live.over(0..0, &Diagnostics::default(), estimates, &record, None).is_none());
        let none = live.over(9000..9000, &Diagnostics::new(estimates, &record), estimates, &record, None).unwrap();
        assert!(none.verdict.is_none() || estimates.stop().is_some(), "{name}: {:?}", none.verdict);
    }
    assert!(compared.lines <= compared.all / 30, "{} of {}", compared.lines, compared.all);
}
