//! The causes of what is wrong with each filter.

use kalmanscope_core::diagnosis::Finding;
use kalmanscope_core::{Analysis, Diagnosis, Diagnostics, Estimates, Record, Run, Scenario};

/// The remedies of each filter's verdict, each of one cause or of several, the likeliest first: none where a filter is consistent,
/// or there is no verdict. Each is confirmed by running the filter again with its knobs turned, over 10,000 samples at most.
pub fn causes(run: &Run, analysis: &Analysis) -> Vec<Vec<Finding>> {
    let of = |(place, (estimates, diagnostics))| {
        causes_of(run.scenario(), place, analysis.diagnosis(place), diagnostics, estimates, run.record())
    };
    run.estimates().iter().zip(analysis.diagnostics()).enumerate().map(of).collect()
}

/// The remedies of the verdict on the filter at `place` of a scenario.
pub(crate) fn causes_of(
    scenario: &Scenario,
    place: usize,
    diagnosis: Option<&Diagnosis>,
    diagnostics: &Diagnostics,
    estimates: &Estimates,
    record: &Record,
) -> Vec<Finding> {
    let has_causes = |diagnosis: &&Diagnosis| diagnosis.verdict.as_ref().is_some_and(|verdict| !verdict.kind.is_good());
    let diagnosis = diagnosis.filter(has_causes);
    // A run that has begun can begin again.
    let search = diagnosis.and_then(|one| one.search(scenario, place, diagnostics, estimates, record).ok());
    search.map_or_else(Vec::new, |mut search| {
        while !search.advance(&mut || true) {}
        search.findings()
    })
}
