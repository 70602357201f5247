//! Maps of Kalman filters on a graphics processor: the runs of a map side by side, one thread a run, in single precision.
//!
//! ```text
//! plant, sensors ──notes──▶ list of operations ──text──▶ WGSL ──┐
//! runs ──alike──▶ Batch ──words──▶ shader, some samples a dispatch ──states──▶ outcomes
//!    └ what it does not serve: the caller's processor
//! ```
//!
//! KF, EKF, UKF and CKF of built-in plants and of equations go there, with up to nine components ([`serves`]). The
//! program of a kind of filters is written from the list of operations that their plant and sensors take ([`program`]),
//! and compiled once. Sums, like everything else, are of `f32`, so the numbers differ from those of the core: errors by
//! some thousandths where a filter has converged. Where rounding makes a filter's path another one, as at the border of
//! the guesses from which it converges, the results differ altogether.
//!
//! ```no_run
//! use kalmanscope_core::{Axis, Scenario, Source};
//! use kalmanscope_gpu::{Gpu, Software};
//! use kalmanscope_lab::{Ensemble, Plan, Runner};
//! # async fn example() -> Result<(), Box<dyn std::error::Error>> {
//! let axis = Axis::parse("filters.EKF.initial_mean.natural_frequency=4:12:3")?;
//! let measures = vec!["rmse.natural_frequency".parse()?];
//! let plan = Plan { filters: vec![0], measures, axes: vec![axis], ..Plan::default() };
//! let runner = Runner::new(Ensemble::new(Scenario::default(), plan)?, Source::Simulated)?;
//! let gpu = Gpu::find(Software::Refused).await?;
//! let rows = gpu.rows(&runner, &[0, 1, 2], &|| true).await?;
//! # Ok(())
//! # }
//! ```

mod adapter;
mod batch;
mod layout;
mod program;
mod shader;
mod text;

pub use adapter::{Gpu, GpuError, Software};
pub use batch::{program, serves};
pub use kalmanscope_lanes::LaneRun;

/// Parts for the tests of this crate.
#[doc(hidden)]
pub mod internals {
    pub use crate::adapter::is_software;
    pub use crate::text::unrolled;
}
