//! The input of a user: scenarios with their settings, measured records, and the texts and files that both are read from.

pub(crate) mod axis;
pub mod document;
pub(crate) mod force;
pub(crate) mod hash;
pub mod import;
mod local_cubic;
pub mod record;
pub mod scenario;
pub mod setting;
pub mod signal;
pub(crate) mod sorting;
pub(crate) mod task;
