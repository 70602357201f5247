//! The filters against plain, slow implementations of their papers.

mod from_papers;
pub(crate) mod matrix;
mod plants;
mod settings;
pub(crate) mod textbook;
mod truths;
