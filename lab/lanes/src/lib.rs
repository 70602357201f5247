//! Filters side by side: eight runs at a time in the lanes of vector registers, two in a browser, each with the bits of the
//! single filter.
//!
//! ```text
//! runs ──alike──▶ batches ──steps in lanes──▶ outcomes
//!                    └ a lane whose step is special: the single filter takes it
//! ```
//!
//! KF, EKF and UKF of the linear and the Duffing oscillator run in their own lanes ([`serves`]). The engine's lanes serve
//! further plants, augmentations, inputs that are not held, logarithms, weights of measurements, noise that is learnt, and
//! jumps. [`outcomes`] runs any other filter by itself. A step in lanes is straight-line code: the kernel's operations
//! in the kernel's order, and a mask of the lanes for which they hold. The instruction set is chosen while running;
//! since no operation is fused, all give the same bits. A plant is one file and one line in `plant.rs`.
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

#![expect(
    clippy::needless_range_loop,
    reason = "closures of iterators that are not inlined have no vector instructions; indices are those of the equations"
)]

#[cfg(not(target_arch = "wasm32"))]
mod array;
mod batch;
mod belief;
mod engine;
mod expect;
mod factor;
mod impulse;
mod lane;
mod lane_run;
mod level;
mod linearised;
mod observation;
#[cfg(target_arch = "wasm32")]
mod pair;
mod plant;
mod run;
mod runge_kutta;
mod sigma_points;
mod sums;
mod update;
#[cfg(target_arch = "x86_64")]
mod vector;

pub use batch::{outcomes, outcomes_with, serves};
pub use lane::LANES;
pub use lane_run::LaneRun;
pub use level::Level;
