//! The textbook: predict and update as the books have them, for any plant, any size and any augmentation.

mod adaptation;
mod kind;
mod linearised;
mod sigma_points;

use thiserror::Error;

pub use adaptation::Adaptation;
pub use kind::{FilterInfo, FilterKind};
pub use linearised::Propagation;
pub use sigma_points::Rule;

/// Why a filter cannot go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
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
    /// The innovation covariance S cannot be inverted: to the filter, some combination of the sensors cannot err, or what
    /// it can is lost to rounding.
    #[error("the innovation covariance S is singular: some combination of the sensors has no variance left")]
    SingularInnovation,
    /// The innovation covariance S has a negative variance in some direction.
    #[error("the innovation covariance S is not positive definite: rounding has made a variance negative")]
    IndefiniteInnovation,
    /// The measurement has no likelihood that is a number: it is too far from what the filter expects.
    #[error("a measurement is so far from what the filter expects that its likelihood is zero")]
    ImpossibleMeasurement,
    /// A measurement is infinite.
    #[error("a measurement is infinite")]
    InfiniteMeasurement,
    /// The force is infinite or undefined.
    #[error("the force is not a finite number")]
    UndefinedForce,
}
