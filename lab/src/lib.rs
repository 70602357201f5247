//! Ensembles: one scenario run thousands of times, with other settings each time.
//!
//! ```text
//! Scenario + axes ──▶ Ensemble ──cells──▶ Runner ──rows of numbers──▶ maps, Monte Carlo, tuning
//! ```
//!
//! ```
//! use kalmanscope_core::{Axis, Scenario, Source};
//! use kalmanscope_lab::{Ensemble, Plan, Runner};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let axis = Axis::parse("filters.EKF.initial_mean.natural_frequency=4:12:3")?;
//! let measures = vec!["rmse.natural_frequency".parse()?];
//! let scenario = Scenario { duration: 10.0, ..Scenario::default() };
//! let ensemble = Ensemble::new(scenario, Plan { filters: vec![0], measures, axes: vec![axis], ..Plan::default() })?;
//! let rows = Runner::new(ensemble, Source::Simulated)?.rows(&[0, 1, 2]);
//! assert!(rows[0] < rows[2]);
//! # Ok(())
//! # }
//! ```

mod cell;
mod ensemble;
mod last_error;
mod monte_carlo;
pub mod order;
mod outcome;
mod plan;
pub mod posterior;
mod runner;
mod share;
mod sheet;
mod threads;
mod trace;
#[cfg(feature = "tune")]
pub mod tune;

pub use cell::CellTask;
pub use ensemble::{Ensemble, EnsembleError, MAX_CELLS, channels};
pub use last_error::LastError;
pub use monte_carlo::{Judged, MonteCarlo};
pub use plan::Plan;
pub use runner::{CellRun, Runner, outcomes_of};
pub use share::share_interval;
pub use sheet::{Sheet, Slice};
pub use threads::{Lost, Parts, Priority, Report, Step, Threads, Wanted};
pub use trace::Trace;
