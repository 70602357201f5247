//! The kinds of filter.

use serde::{Deserialize, Serialize};

/// The kinds of filter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FilterKind {
    /// Kalman filter: the parameters are known, so their standard deviations and `eta` are taken as zero.
    Kf,
    /// Extended Kalman filter: local linearisation.
    #[default]
    Ekf,
    /// Iterated extended Kalman filter: the sensors are linearised where the update leads.
    Iekf,
    /// Unscented Kalman filter: scaled sigma points.
    Ukf,
    /// Unscented Kalman filter on the root of its covariance.
    SrUkf,
    /// Cubature Kalman filter.
    Ckf,
    /// Ensemble Kalman filter.
    Enkf,
    /// Bootstrap particle filter, regularised.
    Pf,
}

impl FilterKind {
    /// Every kind.
    pub const ALL: [Self; 8] =
        [Self::Kf, Self::Ekf, Self::Iekf, Self::Ukf, Self::SrUkf, Self::Ckf, Self::Enkf, Self::Pf];

    /// The usual abbreviation.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Kf => "KF",
            Self::Ekf => "EKF",
            Self::Iekf => "IEKF",
            Self::Ukf => "UKF",
            Self::SrUkf => "SR-UKF",
            Self::Ckf => "CKF",
            Self::Enkf => "EnKF",
            Self::Pf => "PF",
        }
    }

    /// Whether the belief is a random sample, so that results have Monte Carlo error.
    pub const fn is_sampled(self) -> bool {
        matches!(self, Self::Enkf | Self::Pf)
    }
}
