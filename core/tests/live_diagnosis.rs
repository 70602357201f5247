//! The diagnosis of a growing record is that of one pass over the same samples.

use std::sync::Arc;

use kalmanscope_core::diagnosis::{Diagnosis, Evidence, LiveDiagnosis};
use kalmanscope_core::record::Input;
use kalmanscope_core::{Channel, Diagnostics, Record, Run, Scenario};

use crate::situations::{Fault, Situation, without_truth};

/// The samples of a window.
const WINDOW: usize = 2000;

/// A multiple of the length of every window of a periodogram.
const ALIGNED: usize = 1024;

const SCENARIOS: &[&str] = &[
    include_str!("../../assets/scenarios/acceleration-only.toml"),
    include_str!("../../assets/scenarios/chirp.toml"),
    include_str!("../../assets/scenarios/hammer.toml"),
    include_str!("../../assets/scenarios/free-vibration.toml"),
    include_str!("../../assets/scenarios/no-excitation.toml"),
    include_str!("../../assets/scenarios/r-wrong-by-ten.toml"),
    include_str!("../../assets/scenarios/shear-building.toml"),
    include_str!("../../assets/scenarios/staircase.toml"),
    include_str!("../../assets/scenarios/stiffness-loss.toml"),
];

fn is_line(one: &Evidence) -> bool {
    one.test.name.contains("spectrum")
}

fn is_near(a: f64, b: f64, tolerance: f64) -> bool {
    a == b || a.is_nan() && b.is_nan() || (a - b).abs() <= tolerance * (a.abs() + b.abs())
}

/// Asserts that two diagnoses say the same. Where the windows of the periodograms are not the same, the numbers of lines are
/// not, and all tests are decided together: returns whether then other evidence counts.
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

/// The number of diagnoses that have been compared, and of those in which another window of a periodogram decides.
#[derive(Default)]
struct Compared {
    all: usize,
    lines: usize,
}

/// Follows a run in portions of different lengths and compares the diagnoses.
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
        for toml in SCENARIOS {
            let mut run = Run::new(&Scenario::from_toml(toml).unwrap()).unwrap();
            compare(&mut run, None, forgets, toml.lines().next().unwrap(), &mut compared);
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
        let name = format!("{:?} [{}], seed {seed}", situation.fault, situation.note);
        compare(&mut run, Some(&record), false, &name, &mut compared);
    }
    assert!(compared.lines <= compared.all / 30, "{} of {}", compared.lines, compared.all);
}

/// A record of the built-in scenario and a run over it, with changed columns.
fn changed(change: impl Fn(usize, &mut f64, &mut [f64])) -> (Run, Arc<Record>) {
    let scenario = Scenario { duration: 60.0, ..Scenario::default() };
    let mut run = Run::new(&Scenario { filters: Vec::new(), ..scenario.clone() }).unwrap();
    run.finish();
    let record = run.record();
    let mut values = record.input().to_vec();
    let mut columns: Vec<Vec<f64>> = (0..record.sensors().len()).map(|i| record.measured(i).to_vec()).collect();
    for (k, f) in values.iter_mut().enumerate() {
        let mut measured: Vec<f64> = columns.iter().map(|column| column[k]).collect();
        change(k, f, &mut measured);
        columns.iter_mut().zip(measured).for_each(|(column, value)| column[k] = value);
    }
    let input = Input { kind: record.input_kind(), hold: record.hold(), values };
    let measured = record.sensors().iter().copied().zip(columns).collect();
    let truth = Channel::all().iter().filter_map(|&c| Some((c, record.truth(c)?.to_vec()))).collect();
    let record = Arc::new(Record::new(record.dt(), input, measured).unwrap().with_truth(truth).unwrap());
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
    }
    assert!(compared.lines <= compared.all / 30, "{} of {}", compared.lines, compared.all);
}

/// The diagnosis of a window is the same, however often and over which windows the test has asked before.
#[test]
fn asking_changes_nothing() {
    let mut run = Run::new(&Scenario::default()).unwrap();
    let (mut often, mut seldom) = (LiveDiagnosis::default(), LiveDiagnosis::default());
    while run.done() < 6000 {
        run.advance_to(run.done() + 1 + run.done() % 37);
        let estimates = &run.estimates()[0];
        let diagnostics = Diagnostics::new(estimates, run.record());
        let from = run.len().saturating_sub(WINDOW);
        let ask = |live: &mut LiveDiagnosis, from| {
            live.over(from..run.len(), &diagnostics, estimates, run.record(), None).unwrap()
        };
        let ours = ask(&mut often, from);
        if run.done().is_multiple_of(5) {
            assert!(!assert_same(&ours, &ask(&mut seldom, from), true, &format!("{from}")));
            // Another window between, also one that begins earlier.
            ask(&mut seldom, from.saturating_sub(700));
            assert!(!assert_same(&ours, &ask(&mut seldom, from), true, &format!("{from} again")));
        }
    }
    let whole = Diagnostics::new(&run.estimates()[0], run.record());
    assert!(often.over(0..0, &Diagnostics::default(), &run.estimates()[0], run.record(), None).is_none());
    let none = often.over(9000..9000, &whole, &run.estimates()[0], run.record(), None).unwrap();
    assert_eq!(none.verdict, None);
}
