//! Why a filter cannot continue, and where it stopped.

use thiserror::Error;

/// Why a filter cannot continue.
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
    /// The innovation covariance S cannot be inverted: no error is expected in some combination of sensors, or rounding removes it.
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

/// Why and where a filter stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stop {
    /// The number, counted from the run's beginning, of the first sample without an estimate.
    pub sample: usize,
    /// The error.
    pub reason: FilterError,
}

pub(crate) fn of_root(is_finite: bool, indefinite: FilterError) -> FilterError {
    if is_finite { indefinite } else { FilterError::NotFinite }
}
