#![doc = include_str!("../README.md")]
//!
//! The hidden modules are for the crates of this workspace.

#[doc(hidden)]
pub mod catalogue;
pub mod channel;
#[doc(hidden)]
pub mod engine;
pub mod filter;
#[doc(hidden)]
pub mod filter_error;
#[doc(hidden)]
pub mod fourier;
#[doc(hidden)]
pub mod gaussian_likelihood;
#[doc(hidden)]
pub mod least_squares;
#[doc(hidden)]
pub mod linalg;
#[doc(hidden)]
pub mod lists;
#[doc(hidden)]
pub mod noise_scale;
#[doc(hidden)]
pub mod quantity;
#[doc(hidden)]
pub mod random;
#[doc(hidden)]
pub mod registry;
#[doc(hidden)]
pub mod truncated_normal;

pub use channel::Channel;
pub use engine::dynamics::{Dynamics, MotionEquation};
pub use engine::model::{Reading, StateModel};
pub use engine::number::{Function, Real};
pub use filter::{
    Adaptation, FilterError, FilterKind, KalmanFilter, MeasurementModel, Propagation, Robust, SystemError,
};
pub use filter_error::Stop;
pub use quantity::{Aspect, AspectInfo, ForcedMass, Hold, InputKind, Quantity, Term};
