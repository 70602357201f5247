//! The share of right diagnoses over situations drawn at random.
//!
//! ```text
//! cargo bench -p kalmanscope-diagnosis --bench diagnosis -- [FROM] [NUMBER]
//! ```
//!
//! Prints confusion tables of verdict and cause, with and without the truth, and what first remedies do; with `--two`, of two faults
//! at once. The limits of tests, causes and remedies are set on seeds below 1,000,000; the tables are those of seeds from there on.

mod situations;
#[path = "../../core/tests/common/threads.rs"]
mod threads;

use std::collections::BTreeMap;

use kalmanscope_core::setting::Edit;
use kalmanscope_core::{Diagnostics, Record, Run, Task as _};
use kalmanscope_diagnosis::{Diagnosis, Remedy, VerdictKind};

use situations::{Fault, Situation, is_asked_for, largest_error, seeds, without_truth};
use threads::on_two_threads;

const NUMBER: u64 = 2_880;

fn main() {
    let trials = !is_asked_for("--no-causes");
    let verbose = is_asked_for("--verbose");
    let seeds: Vec<u64> = seeds(NUMBER).collect();
    let outcomes = on_two_threads(&seeds, |seed| Outcome::of(*seed, trials, verbose));
    for known in [true, false] {
        print_verdicts(&outcomes, known);
    }
    print_mistakes(&outcomes);
    if trials {
        print_causes(&outcomes);
        print_probabilities(&outcomes);
        print_remedies(&outcomes);
    }
}

struct Outcome {
    fault: Fault,
    /// Those of all faults.
    right: Vec<&'static str>,
    verdicts: [Option<VerdictKind>; 2],
    /// The largest error of a parameter over the last fifth, in standard deviations.
    off: f64,
    causes: Vec<&'static str>,
    said: Vec<f64>,
    /// A model that is likelier than a filter with a good verdict, without the truth.
    likelier: Option<&'static str>,
    /// Whether the first remedy makes a bad verdict good, and the largest error then.
    remedied: Option<(bool, f64)>,
}

impl Outcome {
    fn of(seed: u64, with_trials: bool, verbose: bool) -> Self {
        let mut situation = Situation::draw(seed);
        if is_asked_for("--two") {
            let other = Fault::ALL[(seed / 7 % Fault::ALL.len() as u64) as usize];
            situation = Situation::of(&[situation.faults[0], other], seed);
        }
        let fault = situation.faults[0];
        let right = situation.faults.iter().flat_map(|fault| fault.causes().iter().copied()).collect();
        let whole = situation.record().expect("the situation is valid");
        let mut verdicts = [None; 2];
        let (mut causes, mut said, mut likelier, mut remedied) = (Vec::new(), Vec::new(), None, None);
        let mut run = Run::on_record(&situation.told, whole.clone()).expect("the situation is valid");
        run.finish();
        let off = largest_error(&run.estimates()[0], &whole);
        for (place, known) in [true, false].into_iter().enumerate() {
            let record: &Record = if known { &whole } else { &without_truth(&whole) };
            let estimates = &run.estimates()[0];
            let diagnostics = Diagnostics::new(estimates, record);
            let Some(diagnosis) = Diagnosis::new(&diagnostics, estimates, record) else { continue };
            verdicts[place] = diagnosis.verdict.as_ref().map(|verdict| verdict.kind);
            let is_good = verdicts[place].is_some_and(VerdictKind::is_good);
            let wants_causes = verdicts[place] != Some(VerdictKind::Consistent) && causes.is_empty();
            if with_trials && (wants_causes || is_good && !known) {
                let search = diagnosis.search(&situation.told, 0, &diagnostics, estimates, record);
                let remedies = search.expect("the situation is valid").run();
                if is_good {
                    likelier = remedies.first().map(|remedy| remedy.first.cause.key);
                } else {
                    causes.extend(remedies.iter().map(|remedy| remedy.first.cause.key));
                    said = Remedy::probabilities(&remedies);
                    remedied = remedies.first().and_then(|first| after(&situation, first, &whole));
                }
                if verbose {
                    for remedy in &remedies {
                        let after = remedy.after.as_ref().map_or("", |verdict| verdict.kind.name());
                        let edits: Vec<String> = remedy.first.edits.iter().map(Edit::toml_line).collect();
                        let sentence = &remedy.first.sentence;
                        println!("@{seed} {:.1} {sentence} -> {after}: {}", remedy.gain, edits.join("; "));
                    }
                }
            }
            if verbose {
                let verdict = diagnosis.verdict.map_or(String::new(), |verdict| verdict.to_string());
                println!("{seed} {fault:?} [{}] {known}, {off:.1}σ: {verdict}", situation.note);
                for e in &diagnosis.evidence {
                    println!(
                        "#{seed},{fault:?},{known},{},{:?},{},{},{},{:?}",
                        e.test.name, e.subject, e.statistic, e.p_value, e.effect, e.speaks_for
                    );
                }
            }
        }
        Self { fault, right, verdicts, off, causes, said, likelier, remedied }
    }
}

fn after(situation: &Situation, remedy: &Remedy, record: &std::sync::Arc<Record>) -> Option<(bool, f64)> {
    let turned = Edit::apply_all(&remedy.edits, &situation.told).ok().filter(|_| !remedy.edits.is_empty())?;
    let mut run = Run::on_record(&turned, record.clone()).ok()?;
    run.finish();
    let is_good = remedy.after.as_ref().is_some_and(|verdict| verdict.kind.is_good());
    Some((is_good, largest_error(&run.estimates()[0], record)))
}

/// Of filters that are not to be believed.
fn print_remedies(outcomes: &[Outcome]) {
    println!("\nfirst remedies: bad, good after it, largest error grows by a fifth, within 3σ before and after");
    let bad = |outcome: &&Outcome| outcome.verdicts.iter().flatten().any(|kind| !kind.is_good());
    for fault in Fault::ALL.iter().copied() {
        let all: Vec<&Outcome> = outcomes.iter().filter(|outcome| outcome.fault == fault).filter(bad).collect();
        if all.is_empty() {
            continue;
        }
        let count = |is: &dyn Fn(&Outcome) -> bool| all.iter().filter(|outcome| is(outcome)).count();
        let off = |outcome: &Outcome| outcome.remedied.map_or(outcome.off, |(_, off)| off);
        println!(
            "{:24} {:4} {:4} {:4} {:4} {:4}",
            format!("{fault:?}"),
            all.len(),
            count(&|one| one.remedied.is_some_and(|(is_good, _)| is_good)),
            count(&|one| off(one) > 1.2 * one.off),
            count(&|one| one.off <= 3.0),
            count(&|one| off(one) <= 3.0)
        );
    }
}

fn print_verdicts(outcomes: &[Outcome], known: bool) {
    println!("\nverdicts, {}", if known { "truth known" } else { "truth unknown" });
    let mut table: BTreeMap<Fault, BTreeMap<&str, usize>> = BTreeMap::new();
    for outcome in outcomes {
        let verdict = outcome.verdicts[usize::from(!known)].map_or("none", VerdictKind::name);
        *table.entry(outcome.fault).or_default().entry(verdict).or_default() += 1;
    }
    for (fault, row) in table {
        let cells: Vec<String> = row.into_iter().map(|(verdict, count)| format!("{verdict} {count}")).collect();
        println!("{:24} {}", format!("{fault:?}"), cells.join(", "));
    }
}

fn print_causes(outcomes: &[Outcome]) {
    println!(
        "\ncauses, of runs with a verdict that is not consistent: first, among the first two, of; the first ones named"
    );
    let (mut hits, mut runs) = (0, 0);
    for fault in Fault::ALL.iter().copied().filter(|fault| !fault.causes().is_empty()) {
        let of = |o: &&Outcome| o.fault == fault && o.verdicts.iter().flatten().any(|v| *v != VerdictKind::Consistent);
        let all: Vec<&Outcome> = outcomes.iter().filter(of).collect();
        let named = |most: usize| {
            let hit = |o: &&&Outcome| o.causes.iter().take(most).any(|cause| o.right.contains(cause));
            all.iter().filter(hit).count()
        };
        let mut first: BTreeMap<&str, usize> = BTreeMap::new();
        for outcome in &all {
            *first.entry(outcome.causes.first().copied().unwrap_or("none")).or_default() += 1;
        }
        let cells: Vec<String> = first.into_iter().map(|(cause, count)| format!("{cause} {count}")).collect();
        println!("{:24} {:4} {:4} {:4}   {}", format!("{fault:?}"), named(1), named(2), all.len(), cells.join(", "));
        (hits, runs) = (hits + named(2), runs + all.len());
    }
    println!("all: {hits} of {runs} among the first two");
}

fn print_probabilities(outcomes: &[Outcome]) {
    const ENDS: [f64; 8] = [0.0, 0.05, 0.15, 0.3, 0.7, 0.85, 0.95, 1.0];
    println!(
        "\nprobabilities of causes: from, to; of the first ones the number, mean said, share right; of all the same"
    );
    for ends in ENDS.windows(2) {
        let mut line = format!("{:5.2} to {:4.2}", ends[0], ends[1]);
        for most in [1, usize::MAX] {
            let (mut count, mut sum, mut right) = (0, 0.0, 0);
            for outcome in outcomes.iter().filter(|outcome| !outcome.fault.causes().is_empty()) {
                for (cause, said) in outcome.causes.iter().zip(&outcome.said).take(most) {
                    if (ends[0]..ends[1]).contains(said) {
                        (count, sum) = (count + 1, sum + said);
                        right += usize::from(outcome.right.contains(cause));
                    }
                }
            }
            let [mean, share] = [sum, right as f64].map(|sum| 100.0 * sum / f64::from(count));
            line += &format!("   {count:5} {mean:5.1} % {share:5.1} %");
        }
        println!("{line}");
    }
}

fn print_mistakes(outcomes: &[Outcome]) {
    let count = |is: &dyn Fn(&Outcome) -> bool| outcomes.iter().filter(|outcome| is(outcome)).count();
    let tuned = |o: &Outcome| o.fault == Fault::WellTuned;
    let has = |o: &Outcome, is: fn(VerdictKind) -> bool| o.verdicts.iter().flatten().any(|verdict| is(*verdict));
    let alarms =
        count(&|o| tuned(o) && has(o, |kind| !matches!(kind, VerdictKind::Consistent | VerdictKind::NotIdentifiable)));
    // A well-tuned filter may also learn nothing about a parameter.
    let untold = count(&|o| tuned(o) && has(o, |kind| kind == VerdictKind::NotIdentifiable));
    let contrary = count(&|o| o.verdicts.iter().flatten().any(|v| o.fault.contrary().contains(v)));
    println!(
        "\nfalse alarms: {alarms} of {} well-tuned runs (besides, {untold} in which the record does not tell a parameter); \
         contrary verdicts: {contrary}",
        count(&tuned)
    );
    let sampled = |o: &Outcome| matches!(o.fault, Fault::CollapsedSample | Fault::LargeSample);
    let collapsed = |o: &Outcome| has(o, |kind| kind == VerdictKind::Collapsed);
    println!(
        "called collapsed, of {} particle filters that are less than 2σ off in the last fifth: {}; of {} that are more than \
         20σ off: {}",
        count(&|o| sampled(o) && o.off < 2.0),
        count(&|o| sampled(o) && o.off < 2.0 && collapsed(o)),
        count(&|o| sampled(o) && o.off > 20.0),
        count(&|o| sampled(o) && o.off > 20.0 && collapsed(o)),
    );
    let good = |o: &Outcome| o.verdicts[1].is_some_and(VerdictKind::is_good);
    let silent = |o: &Outcome| good(o) && o.likelier.is_none();
    println!(
        "called consistent or recovered, truth unknown, of {} with a parameter more than 3σ off in the last fifth: {}; without a likelier \
         model: {}, with 3σ {}, 5σ {}; with one, of {} that are well tuned: {}",
        count(&|o| o.off > 3.0),
        count(&|o| good(o) && o.off > 3.0),
        count(&silent),
        count(&|o| silent(o) && o.off > 3.0),
        count(&|o| silent(o) && o.off > 5.0),
        count(&|o| tuned(o) && good(o)),
        count(&|o| tuned(o) && o.likelier.is_some()),
    );
}
