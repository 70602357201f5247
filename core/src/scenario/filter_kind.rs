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

    /// The key in scenario files.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Kf => "kf",
            Self::Ekf => "ekf",
            Self::Iekf => "iekf",
            Self::Ukf => "ukf",
            Self::SrUkf => "sr_ukf",
            Self::Ckf => "ckf",
            Self::Enkf => "enkf",
            Self::Pf => "pf",
        }
    }

    /// What it does, in a few words.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Kf => "takes the parameters for known; optimal on a linear plant",
            Self::Ekf => "linearises plant and sensors at the mean",
            Self::Iekf => "linearises the sensors again where the update leads, by Gauss-Newton",
            Self::Ukf => "moves 2n + 1 sigma points",
            Self::SrUkf => "a UKF on the root of its covariance, which no rounding makes indefinite",
            Self::Ckf => "moves 2n cubature points",
            Self::Enkf => "moves an ensemble and corrects each member",
            Self::Pf => "moves weighted particles and resamples them systematically",
        }
    }

    /// Where it comes from.
    pub const fn reference(self) -> &'static str {
        match self {
            Self::Kf => "Kalman (1960), A new approach to linear filtering and prediction problems",
            Self::Ekf => "Huang and Yuen (2023), Bayesian Real-Time System Identification",
            Self::Iekf => "Bell and Cathey (1993), The iterated Kalman filter update as a Gauss-Newton method",
            Self::Ukf => "Julier and Uhlmann (2004), Unscented filtering and nonlinear estimation",
            Self::SrUkf => {
                "van der Merwe and Wan (2001), The square-root unscented Kalman filter for state and parameter-estimation"
            }
            Self::Ckf => "Arasaratnam and Haykin (2009), Cubature Kalman filters",
            Self::Enkf => {
                "Evensen (2003), The ensemble Kalman filter: theoretical formulation and practical implementation"
            }
            Self::Pf => {
                "Gordon, Salmond and Smith (1993), Novel approach to nonlinear/non-Gaussian Bayesian state estimation"
            }
        }
    }

    /// Whether the belief is a random sample, so that results have Monte Carlo error.
    pub const fn is_sampled(self) -> bool {
        matches!(self, Self::Enkf | Self::Pf)
    }
}
