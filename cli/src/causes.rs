//! The causes of each filter's verdict, and the progress of long work.

use kalmanscope_core::diagnosis::Remedy;
use kalmanscope_core::{Analysis, Diagnosis, Diagnostics, Estimates, Record, Run, Scenario, Task as _};

/// The remedies of each filter's verdict, each of one cause or of several, the likeliest first; for a consistent filter the models
/// that are likelier than its own. One without a verdict has none. Running the filter again with the edits made, over 10,000 samples at most,
/// confirms each remedy. `report` is called after each piece of work.
pub fn causes(run: &Run, analysis: &Analysis, report: &mut dyn FnMut(FilterProgress<'_>)) -> Vec<Vec<Remedy>> {
    let of = |(place, (estimates, diagnostics)): (usize, (&Estimates, &Diagnostics))| {
        let of = (analysis.diagnosis(place), diagnostics, estimates, run.record());
        let mut report =
            |share: f64| report(FilterProgress { place, name: estimates.name(), work: Work::Causes, share });
        causes_of(run.scenario(), place, of, &mut report)
    };
    run.estimates().iter().zip(analysis.diagnostics()).enumerate().map(of).collect()
}

/// The pieces of a search, of about a millisecond, between two reports of its progress.
const PIECES: usize = 50;

/// The remedies of the verdict on the filter at `place` of a scenario. `report` is called with the share of the search that is done.
pub(crate) fn causes_of(
    scenario: &Scenario,
    place: usize,
    (diagnosis, diagnostics, estimates, record): (Option<&Diagnosis>, &Diagnostics, &Estimates, &Record),
    report: &mut dyn FnMut(f64),
) -> Vec<Remedy> {
    let diagnosis = diagnosis.filter(|diagnosis| diagnosis.verdict.is_some());
    // A run that has begun can begin again.
    let search = diagnosis.and_then(|one| one.search(scenario, place, diagnostics, estimates, record).ok());
    let Some(mut search) = search else { return Vec::new() };
    let (mut pieces, mut furthest) = (0, 0.0);
    loop {
        // A search that finds more to try is less far than it was.
        furthest = search.progress().max(furthest);
        report(furthest);
        let mut while_time = || {
            pieces += 1;
            pieces % PIECES != 0
        };
        if search.advance(&mut while_time) {
            return search.finish();
        }
    }
}

/// The progress of the results of a filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterProgress<'a> {
    /// The filter's place in the scenario.
    pub place: usize,
    /// Its name.
    pub name: &'a str,
    /// The work that is under way.
    pub work: Work,
    /// The share of it that is done, from 0 to 1.
    pub share: f64,
}

/// The work on the results of a filter, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Work {
    /// The filter itself.
    Filter,
    /// The search for the causes of its verdict.
    Causes,
    /// Its Cramér-Rao bound.
    Bound,
}
