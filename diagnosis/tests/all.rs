//! The tests of the diagnosis from outside, and of all that needs a verdict: one program. `cargo test -p kalmanscope-diagnosis --test all NAME::`
//! runs those of one file.
#![expect(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

// These modules are those of the core's tests and of the benchmark.
#[path = "../../core/tests/common/numbers.rs"]
#[expect(dead_code, reason = "the core's tests use the rest")]
mod numbers;
#[path = "../../core/tests/common/phone.rs"]
mod phone;
#[path = "../../core/tests/common/run.rs"]
#[expect(dead_code, reason = "the core's tests use the rest")]
mod run;
#[path = "../benches/situations/mod.rs"]
#[expect(dead_code, reason = "the benchmark takes its arguments from it")]
mod situations;
#[path = "../../core/tests/common/threads.rs"]
mod threads;

mod ambient;
mod causes;
mod decay;
mod diagnosis;
mod docs;
mod findings;
mod gallery;
mod inside;
mod job;
mod look_ahead;
mod measured;
mod measures;
mod plucks;
mod snapshots;
mod start_value_records;
mod start_values;
mod verdicts;

use kalmanscope_core::{Diagnostics, Estimates, Record, Run, Task as _};
use kalmanscope_diagnosis::{Diagnosis, Remedy, VerdictKind};

fn diagnosis(estimates: &Estimates, record: &Record) -> Diagnosis {
    let diagnostics = Diagnostics::new(estimates, record);
    Diagnosis::new(&diagnostics, estimates, record).unwrap()
}

fn verdict(run: &Run, filter: usize) -> VerdictKind {
    diagnosis(&run.estimates()[filter], run.record()).verdict.unwrap().kind
}

fn remedies(run: &Run, filter: usize, record: &Record) -> Vec<Remedy> {
    let estimates = &run.estimates()[filter];
    let diagnostics = Diagnostics::new(estimates, record);
    let search = diagnosis(estimates, record).search(run.scenario(), filter, &diagnostics, estimates, record);
    search.unwrap().run()
}
