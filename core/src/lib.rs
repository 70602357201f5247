//! Identification of an oscillator with Kalman filters, headless.
//!
//! ```text
//! Scenario ──simulate──▶ Record ──filters──▶ Estimates ──diagnostics──▶ Diagnostics ──tests──▶ Diagnosis
//! (settings)   (or a CSV: measured record)
//! ```
//!
//! [`Run::step`] is the only engine: a whole record is that step in a loop. The same scenario gives the same bits on
//! every platform, because random numbers come from seeded ChaCha8 streams, one per purpose, and transcendental
//! functions from `libm`.
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
//! [`OnlineFilter`] is a filter of a scenario over samples that come in one by one; [`Pass`] is one over a record. Both report to a
//! [`Sink`], which a program can be itself. For KF, EKF, IEKF, UKF, SR-UKF and CKF neither reserves memory for a sample, unless
//! noise is learnt.
//! [`smoothed()`] looks back from the end of a record.
//!
//! [`Scenario::from_document`] reads a scenario from JSON, or from a [`Document`] that a program has made:
//!
//! ```
//! use kalmanscope_core::{Document, OnlineFilter, Scenario};
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let settings = Document::from_json(r#"{"dt": 0.02, "filters": [{"kind": "ukf"}]}"#)?;
//! let mut filter = OnlineFilter::new(&Scenario::from_document(&settings)?, 0)?;
//! for (time, force, readings) in [(0.0, 0.0, [0.0, 0.0]), (0.02, 1.0, [0.01, f64::NAN]), (0.04, 1.0, [0.0, 0.03])] {
//!     if let Some(sample) = filter.step(time, force, &readings)? {
//!         println!("{time} s: natural frequency {} rad/s, before the update {}", sample.mean[2], sample.prior_mean[2]);
//!     }
//! }
//! # Ok(())
//! # }
//! ```

pub mod analysis;
pub mod augment;
pub mod axis;
pub mod channel;
pub mod cramer_rao;
pub mod diagnosis;
pub mod diagnostics;
pub mod document;
pub mod engine;
pub mod equation;
pub mod estimates;
pub mod filter;
pub mod force;
pub mod free_run;
pub mod frequency_response;
pub mod import;
pub mod in_slices;
pub mod integrate;
pub mod job;
pub mod kernel;
pub mod linalg;
pub mod model;
pub mod online;
pub mod pass;
pub mod plant;
pub mod quantity;
pub mod record;
pub mod remarks;
pub mod run;
mod sample;
pub mod scenario;
pub mod score;
pub mod setting;
pub mod signal;
pub mod simulate;
pub mod sink;
pub mod sorting;
pub mod source;
pub mod spectrogram;
pub mod spectrum;
pub mod study;
pub mod suggest;
pub mod tape;
pub mod window;

mod bank;
mod by_channel;
mod catalogue;
mod cost;
mod estimator;
mod fourier;
mod gaussian_likelihood;
mod guesses;
mod hash;
mod log_sum;
mod random;
mod run_error;
mod select;
mod smoothed;
mod smoother;
mod spare;
mod waste;

pub use analysis::{Analysis, Bound, Wanted};
pub use axis::{Axis, AxisError, Spacing};
pub use channel::Channel;
pub use cramer_rao::CramerRao;
pub use diagnosis::{Diagnosis, LiveDiagnosis, Verdict, VerdictKind};
pub use diagnostics::{Diagnostics, Summary};
pub use document::{Document, DocumentError};
pub use estimates::{Estimates, Stop};
pub use filter::{
    Adaptation, FilterError, FilterKind, KalmanFilter, MeasurementModel, Propagation, Robust, SystemError,
};
pub use force::Force;
pub use free_run::{Fit, FreeRun, Identified, Running};
pub use in_slices::InSlices;
pub use job::{Job, Progress};
pub use model::{Hold, InputKind, Model};
pub use online::{OnlineError, OnlineFilter};
pub use pass::Pass;
pub use plant::PlantKind;
pub use quantity::{Aspect, Quantity};
pub use record::{Record, RecordError};
pub use remarks::{Remark, Trouble};
pub use run::{Run, Update};
pub use run_error::RunError;
pub use scenario::{FilterColor, FilterSettings, Plant, Scenario, ScenarioError, Sensor, Values};
pub use score::Scores;
pub use signal::Signal;
pub use simulate::{TruthError, TruthStop};
pub use sink::{Sample, Sink};
pub use smoothed::smoothed;
pub use source::Source;
pub use spectrogram::{Spectrogram, Windows};
pub use spectrum::Spectrum;
pub use study::Study;
pub use tape::Tape;
pub use window::Window;
