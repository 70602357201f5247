//! Runs in batches of those that are alike.

use kalmanscope_core::internals::engine::{Run, Setup};
use kalmanscope_core::score::Outcome;
use kalmanscope_core::{Record, RunError, Scenario};

use crate::level::{LANES, Level};

/// One filter of a scenario, to be run over a record.
#[derive(Clone, Copy, Debug)]
pub struct LaneRun<'a> {
    /// The scenario.
    pub scenario: &'a Scenario,
    /// The place of the filter in it.
    pub place: usize,
    /// The record.
    pub record: &'a Record,
}

/// Whether lanes serve a run: any that the [engine](Setup::new) serves. [`outcomes`] runs all others too, at the speed of a single
/// filter.
///
/// # Errors
/// Those of [`Setup::new`].
pub fn serves(run: &LaneRun<'_>) -> Result<bool, RunError> {
    Ok(Setup::new(run.scenario, run.place, run.record)?.is_some())
}

/// The outcomes of some runs, in their order, with the best instructions that this processor has. Runs that differ in
/// numbers only, over one record or over records of the same length and dt, run side by side. Each has the bits of
/// [`Outcome::of`], whatever the other runs.
///
/// # Errors
/// Those of [`Setup::new`], for the first run that has one.
pub fn outcomes(runs: &[LaneRun<'_>]) -> Result<Vec<Outcome>, RunError> {
    outcomes_with(Level::best(), runs, &[])
}

/// [`outcomes`] with these instructions, or the best ones below them that the processor has, and with looks at the filters at
/// these samples, which are in order, as those of [`Outcome::at`].
///
/// # Errors
/// Those of [`outcomes`].
pub fn outcomes_with(level: Level, runs: &[LaneRun<'_>], samples: &[usize]) -> Result<Vec<Outcome>, RunError> {
    let setups: Result<Vec<Option<Setup>>, RunError> =
        runs.iter().map(|run| Setup::new(run.scenario, run.place, run.record)).collect();
    let setups = setups?;
    let mut results: Vec<Option<Outcome>> = vec![None; runs.len()];
    for group in groups(&setups, runs) {
        for members in group.chunks(LANES) {
            let batch: Vec<Run<'_>> = members.iter().map(|(_, run)| *run).collect();
            for ((place, _), outcome) in members.iter().zip(level.outcomes(&batch, samples)) {
                results[*place] = Some(outcome);
            }
        }
    }
    let single = |(result, run): (Option<Outcome>, &LaneRun<'_>)| match result {
        Some(outcome) => Ok(outcome),
        None => Outcome::at(run.scenario, run.place, run.record, samples),
    };
    results.into_iter().zip(runs).map(single).collect()
}

/// The runs that can go side by side, each with its place; those over one record come together.
fn groups<'a>(setups: &'a [Option<Setup>], runs: &[LaneRun<'a>]) -> Vec<Vec<(usize, Run<'a>)>> {
    let mut groups: Vec<Vec<(usize, Run<'a>)>> = Vec::new();
    for (place, (setup, LaneRun { record, .. })) in setups.iter().zip(runs).enumerate() {
        let Some(setup) = setup else { continue };
        let run = Run { setup, record };
        match groups.iter_mut().find(|group| group[0].1.goes_with(&run)) {
            Some(group) => group.push((place, run)),
            None => groups.push(vec![(place, run)]),
        }
    }
    for group in &mut groups {
        group.sort_by_key(|(_, run)| std::ptr::from_ref(run.record).addr());
    }
    groups
}
