//! Identification of an oscillator with Kalman filters, headless.
//!
//! ```text
//! Scenario ──simulate──▶ Record ──filters──▶ Estimates ──diagnostics──▶ Diagnostics ──tests──▶ Diagnosis
//! (settings)   (or a CSV: measured record)
//! ```
//!
//! [`Run::step`] is the only engine: a whole record is that step in a loop. The same scenario gives the same bits on every platform.
//!
//! ```
//! use kalmanscope_core::{Run, Scenario};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let scenario = Scenario::from_toml("duration = 20.0\n[plant]\nnatural_frequency = 6.0")?;
//! let mut run = Run::new(&scenario)?;
//! run.finish();
//! let ekf = &run.estimates()[0];
//! let wn = ekf.mean(ekf.len() - 1)[2];
//! assert!((wn - 6.0).abs() < 0.1);
//! # Ok(())
//! # }
//! ```
//!
//! # Filters without a run
//! [`KalmanFilter`] needs no scenario: it filters any linear system of matrices A, B, H, Q and R, with a measurement function of
//! one's own if need be ([`MeasurementModel`]).
//!
//! [`EventFilter`] follows sensors with clocks of their own, whose readings may come late.
//! [`OnlineFilter`] is a filter of a scenario over samples that come in one by one; [`Pass`] is one over a record. Both report to a
//! [`Sink`], which a program can be itself. For KF, EKF, IEKF, UKF, SR-UKF and CKF neither reserves memory for a sample, unless
//! noise is learnt or readings are weighed.
//! [`smoothed()`] looks back from the end of a record.
//!
//! [`Scenario::from_document`] reads a scenario from JSON, or from a [`Document`](document::Document):
//!
//! ```
//! use kalmanscope_core::{LastSample, OnlineFilter, Scenario, document};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let settings = document::from_json(r#"{"dt": 0.02, "filters": [{"kind": "ukf"}]}"#)?;
//! let mut filter = OnlineFilter::new(&Scenario::from_document(&settings)?, 0)?;
//! let mut last = LastSample::default();
//! for (force, readings) in [(0.0, [0.0, 0.0]), (1.0, [0.01, f64::NAN]), (1.0, [0.0, 0.03])] {
//!     filter.step(force, &readings, &mut last);
//!     println!("natural frequency {} rad/s, before the update {}", last.sample().mean[2], last.sample().prior_mean[2]);
//! }
//! assert_eq!((filter.pass.done(), filter.pass.stop), (3, None));
//! # Ok(())
//! # }
//! ```

mod axis;
pub mod document;
pub mod equation;
pub mod plant;
mod run;
pub mod scenario;
pub mod setting;
pub mod signal;
mod statistics;

#[doc(hidden)]
pub mod internals;

pub use kalmanscope_filters::{channel, filter};
pub use kalmanscope_records::{import, record};
pub use statistics::{diagnostics, free_decay, free_run, frequency_response, score, suggest};

pub use axis::{Axis, AxisError, Spacing};
pub use kalmanscope_filters::{
    Adaptation, Aspect, AspectInfo, Channel, FilterError, FilterKind, ForcedMass, Hold, InputKind, KalmanFilter,
    MeasurementModel, Propagation, Quantity, Robust, Stop, SystemError, Term,
};
pub use kalmanscope_records::{Length, Record, RecordError, Task, Work};
pub use plant::PlantKind;
pub use plant::model::Model;
pub use run::estimates::Estimates;
pub use run::events::{EventError, EventFilter, EventSetupError};
pub use run::pass::{OnlineFilter, Pass};
pub use run::remarks::{Remark, Trouble};
pub use run::run_error::RunError;
pub use run::simulate::{Simulator, Source, TruthError, TruthStop, simulate};
pub use run::sink::{AssumedNoise, LastSample, Sample, Sink};
pub use run::spread::Spread;
pub use run::tape::Tape;
pub use run::{Run, Update, smoothed};
pub use scenario::{FilterColor, FilterSettings, Plant, Scenario, ScenarioError, Sensor, Values};
pub use signal::{Force, Signal};
pub use statistics::cramer_rao::CramerRao;
pub use statistics::diagnostics::Diagnostics;
pub use statistics::free_run::{Fit, FreeRun, Identified};
pub use statistics::model_classes::{Evidence, ModelClasses};
pub use statistics::score::Scores;
pub use statistics::spectrum::{Spectrogram, Spectrum};
