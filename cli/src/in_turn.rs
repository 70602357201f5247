//! The filters of a scenario one after the other: as soon as the results of one are taken, its history is dropped.

use std::sync::Arc;

use kalmanscope_core::{CramerRao, Diagnostics, Pass, Record, Run, RunError, Scenario};
use kalmanscope_diagnosis::{Analysis, Diagnosis, Hindsight, Summary, Wanted};

use crate::causes::causes_of;
use crate::free_run::{FreeRunResults, fits_of};
use crate::results::{FilterResults, Results, over_bound};

/// The samples after which the diagnostics follow and matrices are dropped: a few megabytes.
const CHUNK: usize = 10_000;

impl<'a> Results<'a> {
    /// The results of a scenario's filters over the record of a finished run without filters, with the free runs of
    /// their final models over some records, each with its name. They have the same bits as those of
    /// [`Results::of_run`], but memory holds at most one history, without covariances; a filter with a smoother keeps
    /// all covariances of its history.
    ///
    /// # Errors
    /// [`RunError`] where the scenario is impossible or the record lacks one of its sensors.
    pub fn in_turn(scenario: &Scenario, run: &'a Run, records: &[(&str, &Record)]) -> Result<Self, RunError> {
        let mut scenario = scenario.clone();
        scenario.number_filters();
        let mut results = Self::empty(scenario.clone(), run);
        results.free_runs = records.iter().map(|(name, one)| FreeRunResults::new(name, one, run.record())).collect();
        let mut bounds = Vec::new();
        for place in 0..scenario.filters.len() {
            let one = one((&scenario, place, run), &mut results.free_runs, records, &mut bounds)?;
            results.filters.push(one);
            results.smoothers.extend(smoothed(&scenario, place, run.record())?);
        }
        Ok(results)
    }
}

type LastBound = (usize, CramerRao);

fn one(
    (scenario, place, run): (&Scenario, usize, &Run),
    free_runs: &mut [FreeRunResults],
    records: &[(&str, &Record)],
    bounds: &mut Vec<LastBound>,
) -> Result<FilterResults, RunError> {
    let record = run.record();
    let mut pass = Pass::new(scenario, place, record)?;
    let mut history = Pass::history_over(scenario, place, record)?;
    let mut diagnostics = Diagnostics::new(&history, record);
    while pass.done() < record.len() && pass.stop.is_none() {
        pass.follow(record, pass.done() + CHUNK, &mut history);
        diagnostics.follow_to(history.len(), &history, record);
        history.drop_matrices();
    }
    let diagnosis = Diagnosis::new(&diagnostics, &history, record);
    let summary = Summary::of(&diagnostics, diagnosis.as_ref(), &history, record);
    let causes = causes_of(scenario, place, diagnosis.as_ref(), &diagnostics, &history, record);
    // Free runs and the bound need it no more, and both take memory of their own.
    drop(diagnostics);
    for (runs, (_, other)) in free_runs.iter_mut().zip(records) {
        runs.fits.extend(fits_of(scenario, place, &history, other, runs.is_own));
    }
    let bound = bound_for(scenario, place, record, bounds);
    let over_bound = bound.map_or_else(Vec::new, |bound| over_bound(&history, bound));
    Ok(FilterResults { summary, diagnosis, causes, over_bound, remarks: history.remarks().to_vec() })
}

/// Filters with the same initial belief and process noise share a bound; only the last one is kept.
fn bound_for<'b>(
    scenario: &Scenario,
    place: usize,
    record: &Record,
    bounds: &'b mut Vec<LastBound>,
) -> Option<&'b CramerRao> {
    if !bounds.iter().any(|(_, bound)| bound.is_for(scenario, place)) {
        // A bound has numbers for each sample: one for every filter would take the memory that running in turn saves.
        bounds.clear();
        let mut bound = CramerRao::new(scenario, place, record.dt())?;
        bound.follow_to(record.len(), record);
        bounds.push((place, bound));
    }
    bounds.last().map(|(_, bound)| bound)
}

fn smoothed(scenario: &Scenario, place: usize, record: &Record) -> Result<Option<Summary>, RunError> {
    let settings = &scenario.filters[place];
    if !settings.smoother {
        return Ok(None);
    }
    let alone = Scenario { filters: vec![settings.clone()], ..scenario.clone() };
    // The pass has dropped its gains and covariances, so the filter runs again before its smoother.
    let mut run = Run::on_record(&alone, Arc::new(record.clone()))?;
    run.finish();
    let analysis = Analysis::new(&run, Wanted { smoothed: Hindsight::All, ..Wanted::NOTHING });
    Ok(analysis.smoothed().first().map(|smoothed| Summary::new(smoothed, record)))
}
