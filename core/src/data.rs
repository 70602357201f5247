//! The input of a user: scenarios with their settings, measured records, and the texts and files that both are read from.

pub(crate) mod axis;
pub mod document;
pub mod free_decay;
pub(crate) mod hash;
pub mod import;
pub(crate) mod length;
pub(crate) mod mapping;
pub mod record;
pub(crate) mod resample;
pub mod scenario;
pub mod setting;
pub mod signal;
pub(crate) mod task;
