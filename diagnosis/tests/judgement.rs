//! What is said of a run.

use kalmanscope_core::{Diagnostics, Estimates, Record, Run, Task as _};
use kalmanscope_diagnosis::{Diagnosis, Remedy, VerdictKind};

pub(crate) fn diagnosis(estimates: &Estimates, record: &Record) -> Diagnosis {
    let diagnostics = Diagnostics::new(estimates, record);
    Diagnosis::new(&diagnostics, estimates, record).expect("there is something to judge")
}

pub(crate) fn verdict(run: &Run, filter: usize) -> VerdictKind {
    diagnosis(&run.estimates()[filter], run.record()).verdict.expect("there are enough readings").kind
}

pub(crate) fn remedies(run: &Run, filter: usize, record: &Record) -> Vec<Remedy> {
    let estimates = &run.estimates()[filter];
    let diagnostics = Diagnostics::new(estimates, record);
    let search = diagnosis(estimates, record).search(run.scenario(), filter, &diagnostics, estimates, record);
    search.expect("it can be run").run()
}
