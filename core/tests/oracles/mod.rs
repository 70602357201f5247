//! The filters against plain, slow implementations of their papers.

mod from_papers;
mod plants;
mod settings;
pub(crate) mod textbook;
pub(crate) mod truths;
