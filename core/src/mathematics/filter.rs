//! The reference filters: predict and update as in textbooks, for any plant, any size and any augmentation.
//!
//! ```text
//! predict   y⁻ = g-step of y,  P⁻ = λ cov(g-step of y) + Q
//! update    e = z - h(y⁻),  S = H P⁻ Hᵀ + R,  K = P⁻ Hᵀ S⁻¹,  y = y⁻ + K e,  P = (I - K H) P⁻ (I - K H)ᵀ + K R Kᵀ
//! ```
//!
//! [`Filter`], in `recursion.rs`, has the part that all filters share. A method of filtering is a [`Belief`] with its prediction and its
//! update. Each has a file of its own, which ends with the description of its kind; the registry below lists them.

pub(crate) mod adaptation;
mod considered;
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
mod measurements;
mod moments;
mod noise;
mod observation;
mod particles;
mod propagation;
mod recursion;
mod reported;
pub mod robust;
mod rule;
pub(crate) mod share;
mod sigma_points;
mod square_root;
mod step;
mod system;
mod weighing;
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
pub use kind::{Begin, FilterInfo, FilterKind, MethodSettings};
pub use linear::KalmanFilter;
pub use measurement_model::MeasurementModel;
pub use moments::Moments;
pub use noise::Noise;
pub use observation::Observation;
pub use particles::Particles;
pub use propagation::Propagation;
pub use recursion::Filter;
pub(crate) use recursion::Part;
pub use robust::Robust;
pub use rule::Rule;
pub use square_root::SquareRoot;
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
    SR_UKF = square_root::SR_UKF;
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

    /// Keeps a copy of the belief for [`Self::restore`], so that an update can be done again with other weights
    /// ([`robust`]). Returns whether there is one: random samples keep none, and a filter without one weighs nothing.
    fn store(&mut self) -> bool {
        false
    }

    /// Makes the belief the copy that was kept.
    fn restore(&mut self) {}

    /// Takes over a mean and a covariance, as a bank of filters that mix must. Returns whether it can: a random sample cannot.
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] and [`FilterError::NotFinite`] where the covariance has no root, and one is needed.
    fn replace(&mut self, _: &Gaussian) -> Result<bool, FilterError> {
        Ok(false)
    }

    /// Φ, n × n: the regression of the state that a step makes on the state now, `cov(next, now) = Φ P`. A smoother must know
    /// it. From sigma points of mean and covariance, unless the method has a better way.
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] and [`FilterError::NotFinite`] where the covariance has no root.
    fn transition(&mut self, model: &Model, step: Step) -> Result<Matrix, FilterError> {
        sigma_points::transition(&self.gaussian(), Rule::Unscented, model, step)
    }
}
