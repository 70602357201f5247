//! Simulates a scenario's record and runs its filters, sample by sample.

pub(crate) mod estimates;
pub(crate) mod estimator;
pub(crate) mod events;
pub(crate) mod mixture;
pub(crate) mod pass;
pub(crate) mod passage;
pub(crate) mod remarks;
pub(crate) mod run;
pub(crate) mod run_error;
pub(crate) mod simulate;
pub(crate) mod sink;
pub(crate) mod smoother;
pub(crate) mod tape;
pub(crate) mod waste;
