//! The filters against others that were written to be compared with: naive, slow, from the papers.
#![expect(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

mod by_the_book;
mod cases;
mod chains;
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
