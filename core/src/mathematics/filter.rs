//! Kinds of filters, and those whose belief is a random sample, of your own, or of a system of your own.
//!
//! ```text
//! predict   y⁻ = g-step of y,  P⁻ = λ cov(g-step of y) + Q
//! update    e = z - h(y⁻),  S = H P⁻ Hᵀ + R,  K = P⁻ Hᵀ S⁻¹,  y = y⁻ + K e,  P = (I - K H) P⁻ (I - K H)ᵀ + K R Kᵀ
//! ```
//!
//! The engine predicts and updates a mean and a covariance. Any other method is a [`Belief`] with its prediction and its update, and
//! [`Filter`], in `recursion.rs`, has the part that these share. `kind.rs`, and the files of methods that are
//! beliefs, describe the kinds; the registry below lists them.

pub(crate) mod adaptation;
mod belief;
pub(crate) mod jump;
pub mod kalman;
mod kind;
mod linear;
mod observation;
mod recursion;
pub mod robust;
mod sampled;

use thiserror::Error;

use crate::mathematics::linalg::RootError;
use crate::mathematics::registry::registry;

pub use crate::mathematics::engine::design::{Course, Propagation};
pub use crate::mathematics::linalg::{Matrix, Vector};
pub use crate::mathematics::random::Normal;
pub use adaptation::Adaptation;
pub use belief::{Belief, Gaussian, Noise, Step, White};
pub use kalman::Expected;
pub use kind::{Begin, FilterInfo, FilterKind, MethodSettings, Way};
pub use linear::{KalmanFilter, MeasurementModel, Shape, SystemError};
pub use observation::{Correction, Observation};
pub use recursion::Filter;
pub use robust::Robust;
pub use sampled::{Ensemble, Particles};

registry! {
    FilterKind by FilterKind::new,
    /// Every kind of the registry.
    ALL;
    /// Kalman filter: the parameters are known, so their standard deviations and `eta` are taken as zero.
    KF = kind::KF;
    /// Extended Kalman filter: local linearisation.
    EKF = kind::EKF;
    /// Iterated extended Kalman filter: the sensors are linearised where the update leads.
    IEKF = kind::IEKF;
    /// Unscented Kalman filter: scaled sigma points.
    UKF = kind::UKF;
    /// Unscented Kalman filter on the root of its covariance.
    SR_UKF = kind::SR_UKF;
    /// Cubature Kalman filter.
    CKF = kind::CKF;
    /// Ensemble Kalman filter.
    ENKF = sampled::ENKF;
    /// Bootstrap particle filter, regularised.
    PF = sampled::PF;
}

/// Why a filter cannot go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum FilterError {
    /// A standard deviation of the settings has no finite square, or an initial mean no finite value.
    #[error("a number of the filter's settings is too large to begin with: its square is not finite")]
    TooLarge,
    /// A number of the belief has overflowed or is undefined.
    #[error("the estimate is no longer a finite number: the filter has diverged")]
    NotFinite,
    /// The covariance has a negative variance in some direction.
    #[error("the covariance is no longer positive semidefinite: rounding has made a variance negative")]
    IndefiniteCovariance,
    /// The innovation covariance S cannot be inverted: the filter expects no error in some combination of the sensors,
    /// or rounding removes the expected error.
    #[error("the innovation covariance S is singular: some combination of the sensors has no variance left")]
    SingularInnovation,
    /// The innovation covariance S has a negative variance in some direction.
    #[error("the innovation covariance S is not positive definite: rounding has made a variance negative")]
    IndefiniteInnovation,
    /// The likelihood of the measurement is not finite: it is too far from the filter's prediction.
    #[error("a measurement is so far from what the filter expects that its likelihood is zero")]
    ImpossibleMeasurement,
    /// A measurement is infinite.
    #[error("a measurement is infinite")]
    InfiniteMeasurement,
    /// The force is infinite or undefined.
    #[error("the force is not a finite number")]
    UndefinedForce,
}

impl From<RootError> for FilterError {
    fn from(error: RootError) -> Self {
        match error {
            RootError::NotFinite => Self::NotFinite,
            RootError::Indefinite => Self::IndefiniteCovariance,
        }
    }
}
