//! The filters of a scenario one after the other: as soon as the results of one are taken, its history is dropped.

use std::sync::Arc;

use kalmanscope_core::{
    Analysis, CramerRao, Diagnosis, Diagnostics, Hindsight, Pass, Record, Run, RunError, Scenario, Summary, Wanted,
};

use crate::causes::{FilterProgress, Work, causes_of};
use crate::free_run::{FreeRuns, fits_of};
use crate::results::{FilterResults, Results, over_bound};

/// The samples after which the diagnostics follow and matrices are dropped: a few megabytes.
const CHUNK: usize = 10_000;

impl<'a> Results<'a> {
    /// The results of a scenario's filters over the record of a finished run without filters, with the free runs of
    /// their final models over some records, each with its name. They have the same bits as those of
    /// [`Results::of_run`], but memory holds at most one history, without covariances; a filter with a smoother keeps
    /// all covariances of its history.
    ///
    /// `tell` is called after each piece of work.
    ///
    /// # Errors
    /// [`RunError`] where the scenario is impossible or the record lacks one of its sensors.
    pub fn in_turn(
        scenario: &Scenario,
        run: &'a Run,
        records: &[(&str, &Record)],
        tell: &mut dyn FnMut(FilterProgress<'_>),
    ) -> Result<Self, RunError> {
        let mut scenario = scenario.clone();
        scenario.number_filters();
        let mut results = Self::empty(scenario.clone(), run);
        results.free_runs = records.iter().map(|(name, record)| FreeRuns::new(name, record)).collect();
        let mut bounds = Vec::new();
        for place in 0..scenario.filters.len() {
            let one = one(&scenario, place, &mut results, records, &mut bounds, tell)?;
            results.filters.push(one);
            results.smoothers.extend(smoothed(&scenario, place, run.record())?);
        }
        Ok(results)
    }
}

type LastBound = (usize, CramerRao);

fn one(
    scenario: &Scenario,
    place: usize,
    results: &mut Results<'_>,
    records: &[(&str, &Record)],
    bounds: &mut Vec<LastBound>,
    tell: &mut dyn FnMut(FilterProgress<'_>),
) -> Result<FilterResults, RunError> {
    let record = results.record;
    let mut pass = Pass::new(scenario, place, record)?;
    let mut history = Pass::history_over(scenario, place, record)?;
    let mut diagnostics = Diagnostics::new(&history, record);
    let name = history.name().to_owned();
    while pass.done() < record.len() && pass.stop().is_none() {
        pass.follow(record, pass.done() + CHUNK, &mut history);
        diagnostics.follow(&history, record);
        history.drop_matrices();
        tell(FilterProgress {
            place,
            name: &name,
            work: Work::Filter,
            share: pass.done() as f64 / record.len() as f64,
        });
    }
    let diagnosis = Diagnosis::new(&diagnostics, &history, record, None);
    let summary = Summary::of(&diagnostics, diagnosis.as_ref(), &history, record);
    let mut tell_causes = |share: f64| tell(FilterProgress { place, name: &name, work: Work::Causes, share });
    let of = (diagnosis.as_ref(), &diagnostics, &history, record);
    let causes = causes_of(scenario, place, of, &mut tell_causes);
    drop(diagnostics);
    for (runs, (_, other)) in results.free_runs.iter_mut().zip(records) {
        runs.fits.extend(fits_of(scenario, place, &history, other, std::ptr::eq(record, *other)));
    }
    let mut tell_bound = |share: f64| tell(FilterProgress { place, name: &name, work: Work::Bound, share });
    let bound = bound_for(scenario, place, record, bounds, &mut tell_bound);
    let over_bound = bound.map_or_else(Vec::new, |bound| over_bound(&history, bound));
    Ok(FilterResults { summary, diagnosis, causes, over_bound, remarks: history.remarks().to_vec(), step_time: None })
}

/// The bound for a filter over a whole record. Filters with the same initial belief and process noise share one; only the last one
/// is kept.
fn bound_for<'b>(
    scenario: &Scenario,
    place: usize,
    record: &Record,
    bounds: &'b mut Vec<LastBound>,
    tell: &mut dyn FnMut(f64),
) -> Option<&'b CramerRao> {
    if !bounds.iter().any(|(_, bound)| bound.is_for(scenario, place)) {
        bounds.clear();
        let mut bound = CramerRao::new(scenario, place, record.dt())?;
        for end in (0..record.len()).step_by(CHUNK) {
            tell(end as f64 / record.len() as f64);
            bound.follow_to((end + CHUNK).min(record.len()), record);
        }
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
    let mut run = Run::on_record(&alone, Arc::new(record.clone()))?;
    run.finish();
    let analysis = Analysis::new(&run, Wanted { smoothed: Hindsight::All, ..Wanted::NOTHING });
    Ok(analysis.smoothed().first().map(|smoothed| Summary::new(smoothed, record)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{causes, run_scenario};

    fn records<'a>(run: &'a Run, other: &'a Record, own: bool) -> Vec<(&'static str, &'a Record)> {
        own.then(|| ("its own record", run.record())).into_iter().chain([("other.csv", other)]).collect()
    }

    /// The table with free runs, and the JSON, of a scenario on its own record and over another, with a history and without one.
    fn both(text: &str, own: bool) -> [(String, String); 2] {
        let scenario = Scenario::from_toml(text).unwrap();
        let whole = run_scenario(&scenario, None).unwrap();
        let analysis = Analysis::new(&whole, Wanted { bounds: true, ..Wanted::default() });
        let other = whole.record().part(100..400);
        let with = Results::of_run(&whole, &analysis, causes(&whole, &analysis, &mut |_| {}))
            .with_free_runs(&whole, &records(&whole, &other, own));
        let mut alone = Run::new(&Scenario { filters: Vec::new(), ..scenario.clone() }).unwrap();
        alone.finish();
        let mut told = Vec::new();
        let mut tell = |FilterProgress { place, work, share, .. }: FilterProgress<'_>| told.push((place, work, share));
        let without = Results::in_turn(&scenario, &alone, &records(&alone, &other, own), &mut tell).unwrap();
        assert!(told.is_sorted(), "{told:?}");
        let is_told = |work: Work| told.iter().any(|(_, other, _)| *other == work);
        let is_bad = without.filters.iter().any(|one| !one.causes.is_empty());
        assert!(!is_bad || is_told(Work::Causes), "{told:?}");
        assert!(scenario.filters.is_empty() || (is_told(Work::Filter) && is_told(Work::Bound)), "{told:?}");
        assert_eq!((with.any_stopped(), without.verdicts().count()), (without.any_stopped(), scenario.filters.len()));
        [with, without].map(|results| (results.table(true) + &results.free_runs(), results.json().unwrap()))
    }

    #[test]
    fn results_are_the_same_without_a_history() {
        for (own, text) in [
            (true, ""),
            (
                false,
                "duration = 20.0\n[[filters]]\nsmoother = true\n[[filters]]\nkind = \"pf\"\nensemble_size = 50\n[[filters]]\nkind = \"kf\"",
            ),
            (
                true,
                "duration = 120.0\n[[filters]]\nsensor_std = [0.001, 0.06]\n[[filters]]\nfading = 1e300\n[[filters]]\nkind = \"ukf\"",
            ),
            (false, "duration = 5.0\nfilters = []"),
        ] {
            let [with, without] = both(text, own);
            assert_eq!(with.0, without.0);
            assert_eq!(with.1, without.1);
        }
    }
}
