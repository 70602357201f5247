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
mod ensemble;
pub(crate) mod jump;
pub mod kalman;
mod kind;
mod learning;
mod linear;
mod observation;
mod particles;
mod recursion;
pub mod robust;
mod system;
mod white;

use thiserror::Error;

use crate::mathematics::linalg::RootError;

pub use crate::mathematics::engine::design::{Course, Propagation};
pub use crate::mathematics::linalg::{Matrix, Vector};
pub use crate::mathematics::random::Normal;
pub use adaptation::Adaptation;
pub use belief::{Belief, Gaussian, Noise, Step};
pub use ensemble::Ensemble;
pub use kalman::Expected;
pub use kind::{Begin, FilterInfo, FilterKind, MethodSettings, Way};
pub use linear::{KalmanFilter, MeasurementModel};
pub use observation::{Correction, Observation};
pub use particles::Particles;
pub use recursion::Filter;
pub use robust::Robust;
pub use system::{Shape, SystemError};
pub use white::White;

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
    ENKF = ensemble::ENKF;
    /// Bootstrap particle filter, regularised.
    PF = particles::PF;
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
