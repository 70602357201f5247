//! Filters side by side: eight runs at a time in the lanes of vector registers, two in a browser, each with the bits of the
//! single filter.
//!
//! ```text
//! runs ──alike──▶ batches ──steps in lanes──▶ outcomes
//! ```
//!
//! The lanes are those of the core's engine; here are the choice of the instruction set while running, and the batches. Since no
//! operation is fused, all instructions give the same bits. [`outcomes`] runs a filter that has no lanes by itself.
//!
//! ```
//! use kalmanscope_core::{Run, Scenario};
//! use kalmanscope_lanes::{LaneRun, outcomes};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let scenario = Scenario { duration: 10.0, ..Scenario::default() };
//! let mut run = Run::new(&Scenario { filters: vec![], ..scenario.clone() })?;
//! run.finish();
//! let guesses: Vec<Scenario> = (0..12)
//!     .map(|i| {
//!         let mut guess = scenario.clone();
//!         guess.filters[0].initial_mean[kalmanscope_core::Channel::NATURAL_FREQUENCY] = 4.0 + 0.5 * f64::from(i);
//!         guess
//!     })
//!     .collect();
//! let runs: Vec<LaneRun> = guesses.iter().map(|scenario| LaneRun { scenario, place: 0, record: run.record() }).collect();
//! let outcomes = outcomes(&runs)?;
//! assert!(outcomes.iter().all(|outcome| (outcome.mean[2] - 6.0).abs() < 0.5));
//! # Ok(())
//! # }
//! ```

mod batch;
mod level;

pub use batch::{LaneRun, outcomes, outcomes_with, serves};
pub use level::{LANES, Level};
