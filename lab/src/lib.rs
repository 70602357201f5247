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

mod ensemble;
mod monte_carlo;
pub mod next_sensor;
pub mod posterior;
mod runner;
mod threads;
pub mod tune;

pub use ensemble::{Ensemble, EnsembleError, EnsembleRows, MAX_CELLS, Plan, Slice, Trace, channels};
pub use monte_carlo::{LastError, MonteCarlo, RunVerdicts, share_interval};
pub use runner::{CellRun, Runner, cell_task};
pub use threads::{Lost, Priority, Report, Threads, WorkParts, WorkStep, WorkToken, in_parts, processors};
