//! Whether a filter deserves to be believed: its diagnosis, and the runs that are judged as they go on.

pub(crate) mod analysis;
pub mod diagnosis;
pub(crate) mod measure;
pub(crate) mod story;
pub(crate) mod study;
mod words;
