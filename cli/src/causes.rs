//! The causes of what is wrong with each filter.

use kalmanscope_core::diagnosis::Finding;
use kalmanscope_core::{Analysis, Run};

/// The remedies of each filter's verdict, each of one cause or of several, the likeliest first: none where a filter is consistent,
/// or there is no verdict. Each is confirmed by running the filter again with its knobs turned, over 10,000 samples at most.
pub fn causes(run: &Run, analysis: &Analysis) -> Vec<Vec<Finding>> {
    let of = |place: usize| {
        let (estimates, diagnostics) = (run.estimates().get(place)?, analysis.diagnostics().get(place)?);
        let diagnosis = analysis.diagnosis(place)?;
        diagnosis.verdict.as_ref().filter(|verdict| !verdict.kind.is_good())?;
        let search = diagnosis.search(run.scenario(), place, diagnostics, estimates, run.record());
        // A run that has begun can begin again.
        let mut search = search.ok()?;
        while !search.advance(&mut || true) {}
        Some(search.findings())
    };
    (0..run.estimates().len()).map(|place| of(place).unwrap_or_default()).collect()
}
