//! The causes of each filter's verdict.

use kalmanscope_core::{Diagnostics, Estimates, Record, Run, Scenario, Task as _};
use kalmanscope_diagnosis::{Analysis, Diagnosis};
use kalmanscope_diagnosis::{Remedy, Search};

/// The remedies of each filter's verdict, each of one cause or of several, the likeliest first; for a consistent filter the models
/// that are likelier than its own. One without a verdict has none. Running the filter again with the edits made, over 10,000 samples at most,
/// confirms each remedy.
pub fn causes(run: &Run, analysis: &Analysis) -> Vec<Vec<Remedy>> {
    let of = |(place, (estimates, diagnostics)): (usize, (&Estimates, &Diagnostics))| {
        causes_of(run.scenario(), place, analysis.diagnosis(place), diagnostics, estimates, run.record())
    };
    run.estimates().iter().zip(analysis.diagnostics()).enumerate().map(of).collect()
}

pub(crate) fn causes_of(
    scenario: &Scenario,
    place: usize,
    diagnosis: Option<&Diagnosis>,
    diagnostics: &Diagnostics,
    estimates: &Estimates,
    record: &Record,
) -> Vec<Remedy> {
    let diagnosis = diagnosis.filter(|diagnosis| diagnosis.verdict.is_some());
    // A run that has begun can begin again.
    let search = diagnosis.and_then(|one| one.search(scenario, place, diagnostics, estimates, record).ok());
    search.map_or_else(Vec::new, Search::run)
}
