//! The filters against plain, slow implementations of their papers.

mod cases;
mod chains;
mod from_papers;
mod identification;
mod limits;
pub(crate) mod matrix;
mod other_plants;
mod plants;
mod sampled;
mod taylor;
pub(crate) mod textbook;
