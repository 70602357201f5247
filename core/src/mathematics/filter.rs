//! Kinds of filters, and those whose belief is a random sample, of your own, or of a system of your own.
//!
//! ```text
//! predict   y⁻ = g-step of y,  P⁻ = λ cov(g-step of y) + Q
//! update    e = z - h(y⁻),  S = H P⁻ Hᵀ + R,  K = P⁻ Hᵀ S⁻¹,  y = y⁻ + K e,  P = (I - K H) P⁻ (I - K H)ᵀ + K R Kᵀ
//! ```
//!
//! The engine predicts and updates a mean and a covariance. Any other method is a [`Belief`] with its prediction and its update, and
//! [`Filter`], in `recursion.rs`, has the part that these share. The file of a method ends with the description of its kind; the
//! registry below lists them.

pub(crate) mod adaptation;
pub(crate) mod correction;
mod ensemble;
mod error;
mod gaussian;
pub(crate) mod jump;
pub mod kalman;
mod kind;
mod learning;
mod linear;
mod linearised;
mod measurement_model;
mod noise;
mod observation;
mod particles;
mod propagation;
mod recursion;
pub mod robust;
mod rule;
mod sigma_points;
mod step;
mod system;
mod white;

use std::borrow::Cow;

use crate::mathematics::model::Model;

pub use crate::mathematics::linalg::{Matrix, Vector};
pub use crate::mathematics::random::Normal;
pub use adaptation::Adaptation;
pub use correction::Correction;
pub use ensemble::Ensemble;
pub use error::FilterError;
pub use gaussian::Gaussian;
pub use kalman::Expected;
pub use kind::{Begin, FilterInfo, FilterKind, MethodSettings, Way};
pub use linear::KalmanFilter;
pub use measurement_model::MeasurementModel;
pub use noise::Noise;
pub use observation::Observation;
pub use particles::Particles;
pub use propagation::Propagation;
pub use recursion::Filter;
pub use robust::Robust;
pub use rule::Rule;
pub use step::Step;
pub use system::{Shape, SystemError};
pub use white::{Course, White};

/// The registry: a constant for each kind, and the list of all of them. The file of its method describes a kind.
macro_rules! registry {
    ($($(#[$doc:meta])* $name:ident = $info:expr;)*) => {
        impl FilterKind {
            $($(#[$doc])* pub const $name: Self = Self::new(&$info);)*

            /// Every kind of the registry.
            pub const ALL: [Self; [$(stringify!($name)),*].len()] = [$(Self::$name),*];
        }
    };
}
registry! {
    /// Kalman filter: the parameters are known, so their standard deviations and `eta` are taken as zero.
    KF = linearised::KF;
    /// Extended Kalman filter: local linearisation.
    EKF = linearised::EKF;
    /// Iterated extended Kalman filter: the sensors are linearised where the update leads.
    IEKF = linearised::IEKF;
    /// Unscented Kalman filter: scaled sigma points.
    UKF = sigma_points::UKF;
    /// Unscented Kalman filter on the root of its covariance.
    SR_UKF = sigma_points::SR_UKF;
    /// Cubature Kalman filter.
    CKF = sigma_points::CKF;
    /// Ensemble Kalman filter.
    ENKF = ensemble::ENKF;
    /// Bootstrap particle filter, regularised.
    PF = particles::PF;
}

/// A method of filtering: how a filter holds its belief over the n components of a model's state.
pub trait Belief: Send {
    /// Carries the belief over one step and adds noise: `P ← λ P + Q`.
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] and [`FilterError::NotFinite`] where the covariance or Q has no root.
    fn predict(&mut self, model: &Model, step: Step, noise: &Noise) -> Result<(), FilterError>;

    /// Conditions the belief on one measurement or more, and writes the update to `correction`.
    ///
    /// # Errors
    /// Any [`FilterError`].
    fn condition(
        &mut self,
        model: &Model,
        observation: &Observation,
        correction: &mut Correction,
    ) -> Result<(), FilterError>;

    /// Replaces a component of the state by an independent one, of mean zero and this variance: a [`White`] force at
    /// the next sample. See [`Gaussian::renew`].
    ///
    /// # Errors
    /// Any [`FilterError`].
    fn renew(&mut self, place: usize, variance: f64) -> Result<(), FilterError>;

    /// Mean and covariance.
    fn gaussian(&self) -> Cow<'_, Gaussian>;
}
