//! Measured records, also live and with clocks of their own, and the files that they are read from. Nothing here knows a scenario or a run.
//!
//! The hidden modules are for the crates of this workspace.

pub mod document;
#[doc(hidden)]
pub mod hash;
pub mod import;
#[doc(hidden)]
pub mod length;
#[doc(hidden)]
pub mod mapping;
pub mod record;
#[doc(hidden)]
pub mod resample;
#[doc(hidden)]
pub mod task;

pub use length::Length;
pub use record::{Record, RecordError};
pub use task::{Task, Work};
