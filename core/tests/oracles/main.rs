//! The filters against plain, slow implementations of their papers.
#![expect(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

mod cases;
mod chains;
mod from_papers;
mod identification;
mod limits;
mod matrix;
mod other_plants;
mod plants;
#[path = "../common/run.rs"]
mod run;
mod sampled;
mod taylor;
mod textbook;
