//! The diagnosis on situations drawn at random, of seeds that no limit was set on: part of the tables that
//! `cargo bench -p kalmanscope-core --bench diagnosis` prints.

use kalmanscope_core::diagnosis::{CAUSES, Diagnosis, TESTS, VerdictKind};
use kalmanscope_core::{Channel, Diagnostics, Run};

use crate::situations::{Fault, Situation, largest_error, without_truth};

/// The first seed that no limit was set on.
const FIRST: u64 = 1_000_000;

/// The diagnosis of one situation.
struct Outcome {
    fault: Fault,
    /// The seed and what was drawn, in words.
    name: String,
    /// With and without the truth.
    verdicts: [VerdictKind; 2],
    /// The largest error of a parameter over the last fifth, in standard deviations.
    off: f64,
    /// The causes, the likeliest first; none where they were not asked for.
    causes: Vec<&'static str>,
}

fn outcome(situation: &Situation, seed: u64, with_causes: bool) -> Outcome {
    let known = situation.record().unwrap();
    let mut run = Run::on_record(&situation.told, known.clone()).unwrap();
    run.finish();
    let estimates = &run.estimates()[0];
    let mut causes = Vec::new();
    let verdicts = [known.clone(), without_truth(&known)].map(|record| {
        let diagnostics = Diagnostics::new(estimates, &record);
        let diagnosis = Diagnosis::new(&diagnostics, estimates, &record, None).unwrap();
        if with_causes && causes.is_empty() {
            let trials = diagnosis.trials(&situation.told, 0, &diagnostics, estimates, &record);
            let mut trials = trials.unwrap();
            while !trials.advance(&mut || true) {}
            causes.extend(trials.remedies().iter().map(|remedy| remedy.first.cause.key));
        }
        diagnosis.verdict.map_or(VerdictKind::Diverged, |verdict| verdict.kind)
    });
    let off = largest_error(estimates, &known);
    let name = format!("{:?} [{}], seed {seed}", situation.fault, situation.note);
    Outcome { fault: situation.fault, name, verdicts, off, causes }
}

fn outcomes(faults: &[Fault], number: u64, with_causes: bool) -> Vec<Outcome> {
    std::thread::scope(|scope| {
        let halves = [0, 1].map(|half| {
            let all = faults.iter().flat_map(|&fault| (0..number).map(move |i| (fault, FIRST + i)));
            let mine: Vec<(Fault, u64)> = all.skip(half).step_by(2).collect();
            let one = move |(fault, seed)| outcome(&Situation::with(fault, seed), seed, with_causes);
            scope.spawn(move || mine.into_iter().map(one).collect::<Vec<_>>())
        });
        halves.into_iter().flat_map(|half| half.join().unwrap()).collect()
    })
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
    let faults: Vec<Fault> = Fault::ALL.into_iter().filter(|fault| !fault.causes().is_empty()).collect();
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

/// The sentence of the diagnosis on the spring of a situation, if there is one.
fn of_the_spring(situation: &Situation) -> Option<String> {
    let record = without_truth(&situation.record().unwrap());
    let mut run = Run::on_record(&situation.told, record.clone()).unwrap();
    run.finish();
    let estimates = &run.estimates()[0];
    let diagnostics = Diagnostics::new(estimates, &record);
    let diagnosis = Diagnosis::new(&diagnostics, estimates, &record, None).unwrap();
    let mut trials = diagnosis.trials(&situation.told, 0, &diagnostics, estimates, &record).unwrap();
    while !trials.advance(&mut || true) {}
    let remedies = trials.remedies();
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

/// Where a part is forgiven for an error, the sentence names the error, and not innovations that are as large as expected.
#[test]
fn what_a_filter_has_recovered_from_is_said() {
    let mut told = Vec::new();
    for seed in [503_256, 504_624, 505_632] {
        let situation = Situation::draw(seed);
        let record = situation.record().unwrap();
        let mut run = Run::on_record(&situation.told, record.clone()).unwrap();
        run.finish();
        let estimates = &run.estimates()[0];
        let diagnosis = Diagnosis::new(&Diagnostics::new(estimates, &record), estimates, &record, None).unwrap();
        let recovery = diagnosis.evidence.into_iter().filter(|one| one.test.name == "recovery");
        told.extend(recovery.map(|one| one.sentence));
    }
    assert_eq!(told.len(), 3);
    assert!(told.iter().all(|sentence| sentence.contains("times its σ off")), "{told:#?}");
}
