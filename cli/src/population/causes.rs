//! The causes of each bad verdict among the members of a population.

use std::collections::BTreeMap;
use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicUsize, Ordering};

use kalmanscope_cli::causes;
use kalmanscope_core::diagnosis::Remedy;
use kalmanscope_core::{Analysis, Measure, Run, Source, VerdictKind, Wanted};
use kalmanscope_lab::{Runner, Slice};

use crate::progress::Progress;

/// The causes of one filter's bad verdicts, counted over the members.
#[derive(Clone, Debug, Default)]
pub(super) struct Causes {
    /// The members with a bad verdict.
    pub(super) bad: usize,
    /// The members in which each cause is the first, and in which it is among the first two, the commonest first.
    pub(super) named: Vec<(&'static str, [usize; 2])>,
    /// The members without any cause, and those whose verdict is not explained by the first one.
    pub(super) none: usize,
    pub(super) unexplained: usize,
    /// The sum of the probabilities that the first causes are the right ones.
    pub(super) said: f64,
}

/// The causes of each filter, searched by some threads.
pub(super) fn of_members(runner: &Runner, slices: &[Slice], threads: usize, quiet: bool) -> Vec<Causes> {
    let ensemble = runner.ensemble();
    let cells: Vec<usize> = slices.iter().flat_map(|slice| bad_cells(runner, slice)).collect();
    let progress = Mutex::new(Progress::new(cells.len(), quiet));
    let next = AtomicUsize::new(0);
    let work = || {
        let mut found = Vec::new();
        loop {
            let at = next.fetch_add(1, Ordering::Relaxed);
            let Some(&cell) = cells.get(at) else { return found };
            progress.lock().unwrap_or_else(PoisonError::into_inner).tell(at, "causes");
            found.extend(of_member(runner, cell));
        }
    };
    let found: Vec<Vec<Option<Found>>> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..threads.max(1)).map(|_| scope.spawn(work)).collect();
        let join = |thread: std::thread::ScopedJoinHandle<'_, Vec<Vec<Option<Found>>>>| {
            thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        };
        threads.into_iter().flat_map(join).collect()
    });
    let of_filter = |nth: usize| {
        let mut causes = Causes::default();
        let mut counts: BTreeMap<&'static str, [usize; 2]> = BTreeMap::new();
        for found in found.iter().filter_map(|member| member.get(nth)?.as_ref()) {
            causes.bad += 1;
            causes.none += usize::from(found.causes.is_empty());
            causes.said += found.said;
            causes.unexplained += usize::from(!found.is_explained);
            for (place, name) in found.causes.iter().enumerate() {
                let [first, among] = counts.entry(name).or_default();
                *first += usize::from(place == 0);
                *among += 1;
            }
        }
        causes.named = counts.into_iter().collect();
        causes.named.sort_by_key(|&(_, counts)| std::cmp::Reverse(counts));
        causes
    };
    (0..ensemble.plan().filters.len()).map(of_filter).collect()
}

/// The result of a search for the causes of a bad verdict.
struct Found {
    /// The names of the first two causes.
    causes: Vec<&'static str>,
    /// Whether the first one explains the verdict.
    is_explained: bool,
    /// The probability of the first one; 0 where there is none.
    said: f64,
}

/// The members of a slice of which a filter has a bad verdict.
fn bad_cells(runner: &Runner, slice: &Slice) -> Vec<usize> {
    let plan = runner.ensemble().plan();
    let verdict = plan.measures.iter().position(|measure| *measure == Measure::VERDICT);
    let is_bad = |row: &[f64]| {
        let of = |nth: usize| verdict.map_or(f64::NAN, |place| row[nth * plan.measures.len() + place]);
        (0..plan.filters.len()).any(|nth| kind(of(nth)).is_some_and(|kind| !kind.is_good()))
    };
    let rows = slice.rows.chunks_exact(runner.ensemble().width());
    slice.cells.iter().zip(rows).filter(|(_, row)| is_bad(row)).map(|(&cell, _)| cell).collect()
}

/// The kind of a verdict from its number in a row.
fn kind(number: f64) -> Option<VerdictKind> {
    number.is_finite().then(|| VerdictKind::ALL[number as usize])
}

/// The causes of the verdict on each filter of a member; `None` where the verdict is good, or where there is none.
fn of_member(runner: &Runner, cell: usize) -> Option<Vec<Option<Found>>> {
    let scenario = runner.ensemble().at(cell);
    let run = match runner.source() {
        Source::Measured(record) | Source::Live(record) => Run::on_record(&scenario, record.clone()),
        Source::Simulated => Run::new(&scenario),
    };
    let mut run = run.ok()?;
    run.finish();
    let analysis = Analysis::new(&run, Wanted::default());
    let remedies = causes(&run, &analysis);
    let of = |(place, remedies): (usize, &Vec<Remedy>)| {
        let verdict = analysis.diagnosis(place)?.verdict.as_ref()?;
        if verdict.kind.is_good() {
            return None;
        }
        let causes = remedies.iter().take(2).map(|remedy| remedy.first.cause.name).collect();
        let said = Remedy::probabilities(remedies).first().copied().unwrap_or_default();
        Some(Found { causes, is_explained: Remedy::is_explained(remedies), said })
    };
    Some(remedies.iter().enumerate().map(of).collect())
}
