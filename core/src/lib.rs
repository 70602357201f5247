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
//! [`EventFilter`] follows sensors with clocks of their own, whose readings may come late.
//! [`OnlineFilter`] is a filter of a scenario over samples that come in one by one; [`Pass`] is one over a record. Both report to a
//! [`Sink`], which a program can be itself. For KF, EKF, IEKF, UKF, SR-UKF and CKF neither reserves memory for a sample, unless
//! noise is learnt or readings are weighed.
//! [`smoothed()`] looks back from the end of a record.
//!
//! [`Scenario::from_document`] reads a scenario from JSON, or from a [`Document`](document::Document) that a program has made:
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
//! assert_eq!((filter.pass().done(), filter.pass().stop()), (3, None));
//! # Ok(())
//! # }
//! ```
//!
//! # Modules
//! The types that most programs need stand here, at the root. Modules have what belongs to them, from the lowest of the crate's five
//! floors to the highest; each folder of `src` is a floor, and imports only from those before it.
//!
//! | floor | module | for |
//! |---|---|---|
//! | mathematics | [`channel`] | the components of a state, and what can be [added](channel::augment) to it |
//! | | [`plant`] | equations of motion, and plants of one's own |
//! | | [`equation`] | equations of motion that a user types |
//! | | [`filter`] | kinds of filters, and filters of one's own |
//! | data | [`scenario`] | all that a run depends on |
//! | | [`signal`] | parameters of the truth as functions of time |
//! | | [`setting`] | each setting with its name, unit, limits and address |
//! | | [`record`] | the input and the measurements over time |
//! | | [`import`] | records from files |
//! | | [`free_decay`] | free decays in the readings of an accelerometer and in sounds |
//! | samples | | ([`simulate()`], [`Run`], [`Pass`], [`OnlineFilter`], [`EventFilter`], [`Sink`], [`Estimates`]) |
//! | numbers | [`score`] | what a map shows of a filter, without its history |
//! | | [`diagnostics`] | errors, NEES, NIS and whiteness over time |
//! | | [`free_run`] | what an identified model predicts without measurements |
//! | | [`frequency_response`] | frequency responses of plants, true and estimated |
//! | | [`suggest`] | start values of filters from a record's data |

mod data;
mod mathematics;
mod numbers;
mod samples;

#[doc(hidden)]
pub mod internals;

pub use data::{document, free_decay, import, record, scenario, setting, signal};
pub use mathematics::{channel, equation, filter, plant};
pub use numbers::{diagnostics, free_run, frequency_response, score, suggest};

pub use data::axis::{Axis, AxisError, Spacing};
pub use data::length::Length;
pub use data::record::{Record, RecordError};
pub use data::scenario::{FilterColor, FilterSettings, Plant, Scenario, ScenarioError, Sensor, Values};
pub use data::signal::{Force, Signal};
pub use data::task::Task;
pub use mathematics::channel::Channel;
pub use mathematics::filter::{
    Adaptation, FilterError, FilterKind, KalmanFilter, MeasurementModel, Propagation, Robust, SystemError,
};
pub use mathematics::filter_error::Stop;
pub use mathematics::model::{Hold, InputKind, Model};
pub use mathematics::plant::PlantKind;
pub use mathematics::quantity::{Aspect, AspectInfo, Quantity, Term};
pub use numbers::cramer_rao::CramerRao;
pub use numbers::diagnostics::Diagnostics;
pub use numbers::free_run::{Fit, FreeRun, Identified, Running};
pub use numbers::model_classes::{Evidence, ModelClasses};
pub use numbers::score::Scores;
pub use numbers::spectrogram::{Spectrogram, Windows};
pub use numbers::spectrum::Spectrum;
pub use samples::estimates::Estimates;
pub use samples::events::{EventError, EventFilter, EventSetupError};
pub use samples::pass::{OnlineFilter, Pass};
pub use samples::remarks::{Remark, Trouble};
pub use samples::run::{Run, Update, smoothed};
pub use samples::run_error::RunError;
pub use samples::simulate::{Simulator, Source, TruthError, TruthStop, simulate};
pub use samples::sink::{AssumedNoise, LastSample, Sample, Sink};
pub use samples::tape::Tape;
