//! Remedies against faults that are drawn at random, alone and two at once.
//!
//! ```text
//! cargo bench -p kalmanscope-core --bench remedies -- [FROM] [NUMBER]
//! ```
//!
//! Prints for each situation, over NUMBER seeds from FROM on: the filters that were not to be believed, and of these how many the
//! first remedy makes good, in how many it makes the worse parameter's error larger by more than a fifth (and in how many a filter
//! without the fault has such an error by chance), in how many that error is beyond the 2σ that are drawn, how many are within
//! 3σ before and after it, and how often the first cause is right. Limits of causes and of the search may be set on seeds below
//! 1,000,000 of the situations of the first part; those of the second part are only reported. Nothing knows the truth but the
//! errors.

#[expect(dead_code, reason = "the bench of diagnoses draws one fault")]
mod situations;

use std::collections::BTreeMap;

use kalmanscope_core::setting::Edit;
use kalmanscope_core::{Channel, Diagnostics, Record, Run, Scenario, Task as _};
use kalmanscope_diagnosis::VerdictKind;
use kalmanscope_diagnosis::{Diagnosis, Remedy};

use situations::Fault::{self, *};
use situations::{SETS, Situation, is_asked_for, on_two_threads, seeds, without_truth};

/// Situations on some of whose seeds limits may be set.
const FOR_LIMITS: &[&[Fault]] = &[
    &[InputGain],
    &[SensorBias],
    &[InputDelay],
    &[SuddenChange],
    &[UnknownWave],
    &[DryFriction],
    &[Quantised],
    &[Outliers],
    &[NoisierLater],
    &[InputGain, SensorNoiseTooSmall],
    &[SensorBias, InputDelay],
    &[InputOffset, SuddenChange],
];

const UNTOUCHED: &[&[Fault]] = &[
    &[InputOffset],
    &[SensorNoiseTooSmall],
    &[ProcessNoiseTooSmall],
    &[SlowDrift],
    &[Swing],
    &[HardeningSpring],
    &[Drag],
    &[Clipped],
    &[Coloured],
    &[NoiseSwings],
    &[Hum],
    &[NoisyInput],
    &[Scale],
    &[DeadInput],
    &[InputGain, SensorBias],
    &[InputGain, SensorNoiseTooLarge],
    &[InputGain, Outliers],
    &[InputGain, HardeningSpring],
    &[SensorBias, ProcessNoiseTooSmall],
    &[InputDelay, SensorNoiseTooSmall],
    &[SuddenChange, Quantised],
    &[SlowDrift, SensorNoiseTooLarge],
    &[UnknownWave, InputGain],
    &[DryFriction, InputGain],
];

/// Situations that were written down after the last limit had been set.
const FRESH: &[&[Fault]] = &[
    &[SensorBias, HardeningSpring],
    &[SensorBias, SensorNoiseTooLarge],
    &[InputOffset, SensorNoiseTooSmall],
    &[InputOffset, InputGain],
    &[Swing, InputGain],
    &[Swing, ProcessNoiseTooSmall],
    &[SuddenChange, SensorBias],
    &[SuddenChange, SensorNoiseTooLarge],
    &[InputDelay, ProcessNoiseTooSmall],
    &[InputDelay, Outliers],
    &[HardeningSpring, SensorNoiseTooSmall],
    &[NoisierLater, InputGain],
];

const NUMBER: u64 = 12;

/// Limits the error of a parameter that is believed, in standard deviations.
const WITHIN: f64 = 3.0;

const GROWS: f64 = 1.2;

fn main() {
    let (seeds, verbose) = (seeds(NUMBER), is_asked_for("--verbose"));
    let parts: &[(&str, &[&[Fault]])] = &[("for limits", FOR_LIMITS), ("untouched", UNTOUCHED), ("fresh", FRESH)];
    let parts = if is_asked_for("--limits") { &parts[..1] } else { parts };
    println!("first remedies, of filters that are not to be believed, seeds {} to {}", seeds.start, seeds.end - 1);
    let mut all = Vec::new();
    for (name, situations) in parts {
        println!("\n{name:24}   bad  good  grows (perfect)  misleads  within 3σ   cause");
        let jobs: Vec<(&[Fault], u64)> =
            situations.iter().flat_map(|faults| seeds.clone().map(move |seed| (*faults, seed))).collect();
        let outcomes = on_two_threads(&jobs, |&(faults, seed)| Outcome::of(faults, seed, verbose));
        for faults in *situations {
            let own: Vec<&Outcome> = outcomes.iter().filter(|outcome| outcome.faults == *faults).collect();
            let title: Vec<String> = faults.iter().map(|fault| format!("{fault:?}")).collect();
            print_row(&title.join(" + "), &own, true);
        }
        print_row("all of these", &outcomes.iter().collect::<Vec<_>>(), false);
        all.extend(outcomes);
    }
    println!();
    print_row("all", &all.iter().collect::<Vec<_>>(), false);
}

struct Outcome {
    faults: &'static [Fault],
    is_bad: bool,
    before: Errors,
    /// None without a remedy.
    after: Option<(Errors, bool)>,
    /// Those of a filter that is well tuned for the same oscillator and noise without the faults.
    perfect: Errors,
    causes: Vec<&'static str>,
}

#[derive(Clone, Copy, Debug)]
struct Errors {
    relative: [f64; 2],
    in_std: [f64; 2],
}

impl Errors {
    fn worse(self) -> f64 {
        self.relative[0].max(self.relative[1])
    }

    fn mislead(self, before: Self) -> bool {
        let place = usize::from(self.relative[1] > self.relative[0]);
        self.worse() > GROWS * before.worse() && self.in_std[place] > 2.0
    }

    fn are_within(self) -> bool {
        self.in_std.iter().all(|error| *error <= WITHIN)
    }
}

impl Outcome {
    fn of(faults: &'static [Fault], seed: u64, verbose: bool) -> Self {
        let of = |they_act: bool| {
            let situation = Situation::of(faults, seed, they_act, SETS);
            let record = situation.record().expect("the situation is valid");
            let blind = without_truth(&record);
            (situation.told, record, blind)
        };
        let (told, record, blind) = of(true);
        let (verdict, before, remedies) = judged(&told, &record, &blind, true);
        let is_bad = verdict.is_none_or(|kind| !kind.is_good());
        let first = remedies.first().filter(|_| is_bad);
        let causes: Vec<_> = first.map_or(Vec::new(), |one| one.causes().map(|likely| likely.cause.key).collect());
        let turned = first.filter(|one| !one.edits.is_empty());
        let turned = turned.map(|one| Edit::apply_all(&one.edits, &told).expect("the trial did so"));
        let after = turned.map(|turned| {
            let (kind, errors, _) = judged(&turned, &record, &blind, false);
            (errors, kind.is_some_and(VerdictKind::is_good))
        });
        let sound = of(false);
        let (_, perfect, _) = judged(&sound.0, &sound.1, &sound.2, false);
        if verbose {
            let (name, kind) = (&told.filters[0].name, verdict.map_or("none", VerdictKind::name));
            let mut lines = vec![format!("{seed} {faults:?} {name} {kind} {before:.4?}")];
            for one in remedies.iter().take(3) {
                let causes: Vec<_> = one.causes().map(|likely| likely.sentence.as_str()).collect();
                let after = one.after.as_ref().map_or("none", |verdict| verdict.kind.name());
                lines.push(format!("    {:+.0} {} -> {after}", one.gain, causes.join("; ")));
            }
            lines.push(format!("    {after:.4?}, without the fault {perfect:.4?}"));
            println!("{}", lines.join("\n"));
        }
        Self { faults, is_bad, before, after, perfect, causes }
    }
}

fn judged(
    told: &Scenario,
    record: &Record,
    blind: &std::sync::Arc<Record>,
    search: bool,
) -> (Option<VerdictKind>, Errors, Vec<Remedy>) {
    let mut run = Run::on_record(told, blind.clone()).expect("the scenario is valid");
    run.finish();
    let estimates = &run.estimates()[0];
    let late = estimates.len() * 4 / 5..estimates.len();
    let errors = [Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO].map(|channel| {
        let (Some(truth), Some(place)) = (record.truth(channel), estimates.place(channel)) else {
            return [f64::INFINITY; 2];
        };
        let stopped = estimates.stop().is_some();
        let mean = |of: &dyn Fn(usize) -> f64| {
            let sum = late.clone().map(|k| of(k) * of(k)).sum::<f64>();
            if stopped { f64::INFINITY } else { (sum / late.len() as f64).sqrt() }
        };
        let error = |k: usize| estimates.canonical_mean(k, place) - truth[k];
        [mean(&|k| error(k) / truth[k]), mean(&|k| error(k) / estimates.std(k, place))]
    });
    let errors = Errors { relative: errors.map(|error| error[0]), in_std: errors.map(|error| error[1]) };
    let diagnostics = Diagnostics::new(estimates, blind);
    let Some(diagnosis) = Diagnosis::new(&diagnostics, estimates, blind, None) else {
        return (None, errors, Vec::new());
    };
    let mut remedies = Vec::new();
    if search && diagnosis.verdict.as_ref().is_some_and(|verdict| !verdict.kind.is_good()) {
        let search = diagnosis.search(told, 0, &diagnostics, estimates, blind);
        remedies = search.expect("the scenario is valid").run();
    }
    (diagnosis.verdict.map(|verdict| verdict.kind), errors, remedies)
}

fn print_row(title: &str, outcomes: &[&Outcome], with_causes: bool) {
    let bad: Vec<&&Outcome> = outcomes.iter().filter(|outcome| outcome.is_bad).collect();
    let count = |is: &dyn Fn(&Outcome) -> bool| bad.iter().filter(|outcome| is(outcome)).count();
    let good = count(&|one| one.after.is_some_and(|(_, good)| good));
    let grows = count(&|one| one.after.is_some_and(|(after, _)| after.worse() > GROWS * one.before.worse()));
    let perfect = count(&|one| one.perfect.worse() > GROWS * one.before.worse());
    let misleads = count(&|one| one.after.is_some_and(|(after, _)| after.mislead(one.before)));
    let before = count(&|one| one.before.are_within());
    let after = count(&|one| one.after.map_or(one.before, |(after, _)| after).are_within());
    let right =
        |one: &Outcome| one.faults.iter().any(|fault| fault.causes().contains(one.causes.first().unwrap_or(&"")));
    let named = bad.iter().filter(|one| one.faults.iter().any(|fault| !fault.causes().is_empty())).count();
    let mut text = format!(
        "{title:24} {:5} {good:5} {grows:6} {perfect:9} {misleads:9}  {before:4} → {after:<4} {:3} of {named}",
        bad.len(),
        count(&right)
    );
    if with_causes {
        let mut first: BTreeMap<String, usize> = BTreeMap::new();
        for outcome in &bad {
            let words = if outcome.causes.is_empty() { "none".to_owned() } else { outcome.causes.join("+") };
            *first.entry(words).or_default() += 1;
        }
        let mut first: Vec<_> = first.into_iter().collect();
        first.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        let cells: Vec<String> = first.into_iter().map(|(cause, count)| format!("{cause} {count}")).collect();
        text += &format!("   {}", cells.join(", "));
    } else {
        let share = |count: usize| 100.0 * count as f64 / bad.len().max(1) as f64;
        text += &format!(
            "   good {:.0} %, grows {:.0} % ({:.0} %), misleads {:.1} %, within 3σ {:.0} %",
            share(good),
            share(grows),
            share(perfect),
            share(misleads),
            share(after)
        );
    }
    println!("{text}");
}
