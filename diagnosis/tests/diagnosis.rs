//! The diagnosis on situations drawn at random, of seeds that no limit was set on: part of the tables that
//! `cargo bench -p kalmanscope-diagnosis --bench diagnosis` prints.

use std::sync::Arc;

use kalmanscope_core::{Channel, Diagnostics, Quantity, Record, Run, Scenario, simulate};
use kalmanscope_diagnosis::{CAUSES, Diagnosis, Evidence, Subject, TESTS, VerdictKind};

use crate::numbers::{mean, rms};
use crate::run::{built_in, finished, finished_on, readings, with_input};
use crate::situations::{FIRST, Fault, Situation, largest_error, without_truth};
use crate::threads::on_two_threads;
use crate::{diagnosis, remedies};

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

fn statistic<'a>(evidence: &'a [Evidence], name: &str, sensor: Quantity) -> &'a Evidence {
    let is_it = |one: &&Evidence| one.test.name == name && one.subject == Subject::Sensor(sensor);
    evidence.iter().find(is_it).unwrap_or_else(|| panic!("{name} of the {}", sensor.key()))
}

#[test]
fn statistics_of_innovations_are_those_of_direct_sums() {
    let run = finished(&built_in("constant"));
    let (estimates, record) = (&run.estimates()[0], run.record());
    let found = diagnosis(estimates, record);
    assert!(found.bad_parts.is_empty());
    let input = record.input();
    let center = mean(input);
    let size = rms(&input.iter().map(|f| f - center).collect::<Vec<_>>());
    let input: Vec<f64> = input.iter().map(|f| (f - center).clamp(-5.0 * size, 5.0 * size)).collect();
    for (place, sensor) in estimates.sensors().iter().enumerate() {
        let (m, n) = (estimates.sensors().len(), (estimates.len() - 1) as f64);
        // Innovations are limited to five standard deviations where they are multiplied.
        let all: Vec<f64> = (1..estimates.len())
            .map(|k| estimates.innovation(k)[place] / estimates.innovation_cov(k)[place * (m + 1)].sqrt())
            .collect();
        let limited: Vec<f64> = std::iter::once(0.0).chain(all.iter().map(|e| e.clamp(-5.0, 5.0))).collect();
        let product = |a: &[f64], b: &[f64], lag: usize| a.iter().skip(lag).zip(b).map(|(a, b)| a * b).sum::<f64>();
        let square = product(&limited, &limited, 0);
        let r = |lag: usize| product(&limited, &limited, lag) / square;
        let ljung_box = n * (n + 2.0) * (1..=20).map(|lag| r(lag) * r(lag) / (n - lag as f64)).sum::<f64>();
        let scale = (square * product(&input, &input, 0)).sqrt();
        let behind = (0..=15).map(|lag| product(&limited, &input, lag));
        let before = (1..=4).map(|lag| product(&input, &limited, lag));
        let largest = behind.chain(before).fold(0.0, |most: f64, sum| most.max((sum / scale).abs()));
        for (name, expected) in [
            ("innovations of a sensor (NIS)", rms(&all).powi(2)),
            ("mean of the innovations", limited.iter().sum::<f64>() / n.sqrt()),
            ("whiteness of the innovations", ljung_box),
            ("cross-correlation of innovations and input", largest * n.sqrt()),
        ] {
            let value = statistic(&found.evidence, name, *sensor).statistic;
            assert!((value - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{name}: {value}, not {expected}");
        }
    }
}

fn changed(change: impl Fn(usize, &mut f64, &mut [f64])) -> (Run, Arc<Record>) {
    let scenario = Scenario { duration: 60.0, ..Scenario::default() };
    let record = simulate(&scenario);
    let mut rows: Vec<(f64, Vec<f64>)> = (0..record.len()).map(|k| (record.input()[k], readings(&record, k))).collect();
    rows.iter_mut().enumerate().for_each(|(k, (force, measured))| change(k, force, measured));
    let record = with_input(&record, rows.iter().map(|row| row.0).collect());
    let record = Arc::new(record.with_measured(|sensor, k, _| rows[k].1[sensor]));
    (finished_on(&scenario, Arc::clone(&record)), record)
}

#[test]
fn missing_numbers_and_large_ones_leave_probabilities() {
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
    for (name, change) in changes {
        let (run, record) = changed(change);
        let estimates = &run.estimates()[0];
        let diagnostics = Diagnostics::new(estimates, &record);
        let over = |samples| Diagnosis::over(samples, &diagnostics, estimates, &record);
        assert!(Diagnosis::over(0..0, &Diagnostics::default(), estimates, &record).is_none());
        let none = over(9000..9000).unwrap();
        assert!(none.verdict.is_none() || estimates.stop().is_some(), "{name}: {:?}", none.verdict);
        for evidence in over(1000..9000).unwrap().evidence {
            assert!((0.0..=1.0).contains(&evidence.p_value), "{name}: {evidence:?}");
        }
    }
}
