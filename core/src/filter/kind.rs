//! The kinds of filter.

use std::fmt;
use std::sync::LazyLock;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

/// All that is known of a kind of filter.
#[derive(Debug)]
pub struct FilterInfo {
    /// The key in scenario files.
    pub key: &'static str,
    /// The usual abbreviation.
    pub name: &'static str,
    /// What it does, in a few words.
    pub description: &'static str,
    /// Where it comes from.
    pub reference: &'static str,
    /// Whether the belief is a random sample, so that results have Monte Carlo error.
    pub is_sampled: bool,
}

/// A kind of filter, by what it is called.
#[derive(Clone, Copy)]
pub struct FilterKind(&'static FilterInfo);

/// The registry: a constant for each kind, and all of them.
macro_rules! registry {
    ($($(#[$doc:meta])* $name:ident = $info:expr;)*) => {
        impl FilterKind {
            $($(#[$doc])* pub const $name: Self = Self(&$info);)*

            /// Every kind of the registry.
            pub const ALL: [Self; [$(stringify!($name)),*].len()] = [$(Self::$name),*];
        }
    };
}
registry! {
    /// Kalman filter: the parameters are known, so their standard deviations and `eta` are taken as zero.
    KF = FilterInfo {
        key: "kf",
        name: "KF",
        description: "takes the parameters for known; optimal on a linear plant",
        reference: "Kalman (1960), A new approach to linear filtering and prediction problems",
        is_sampled: false,
    };
    /// Extended Kalman filter: local linearisation.
    EKF = FilterInfo {
        key: "ekf",
        name: "EKF",
        description: "linearises plant and sensors at the mean",
        reference: "Huang and Yuen (2023), Bayesian Real-Time System Identification",
        is_sampled: false,
    };
    /// Iterated extended Kalman filter: the sensors are linearised where the update leads.
    IEKF = FilterInfo {
        key: "iekf",
        name: "IEKF",
        description: "linearises the sensors again where the update leads, by Gauss-Newton",
        reference: "Bell and Cathey (1993), The iterated Kalman filter update as a Gauss-Newton method",
        is_sampled: false,
    };
    /// Unscented Kalman filter: scaled sigma points.
    UKF = FilterInfo {
        key: "ukf",
        name: "UKF",
        description: "moves 2n + 1 sigma points",
        reference: "Julier and Uhlmann (2004), Unscented filtering and nonlinear estimation",
        is_sampled: false,
    };
    /// Unscented Kalman filter on the root of its covariance.
    SR_UKF = FilterInfo {
        key: "sr_ukf",
        name: "SR-UKF",
        description: "a UKF on the root of its covariance, which no rounding makes indefinite",
        reference: "van der Merwe and Wan (2001), The square-root unscented Kalman filter for state and parameter-estimation",
        is_sampled: false,
    };
    /// Cubature Kalman filter.
    CKF = FilterInfo {
        key: "ckf",
        name: "CKF",
        description: "moves 2n cubature points",
        reference: "Arasaratnam and Haykin (2009), Cubature Kalman filters",
        is_sampled: false,
    };
    /// Ensemble Kalman filter.
    ENKF = FilterInfo {
        key: "enkf",
        name: "EnKF",
        description: "moves an ensemble and corrects each member",
        reference: "Evensen (2003), The ensemble Kalman filter: theoretical formulation and practical implementation",
        is_sampled: true,
    };
    /// Bootstrap particle filter, regularised.
    PF = FilterInfo {
        key: "pf",
        name: "PF",
        description: "moves weighted particles and resamples them systematically",
        reference: "Gordon, Salmond and Smith (1993), Novel approach to nonlinear/non-Gaussian Bayesian state estimation",
        is_sampled: true,
    };
}

impl FilterKind {
    /// A kind of your own. Files name kinds of the registry only.
    pub const fn new(info: &'static FilterInfo) -> Self {
        Self(info)
    }

    /// The kind of the registry with this key, if there is one.
    pub fn from_key(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.key() == key)
    }

    /// All that is known of it.
    pub const fn info(self) -> &'static FilterInfo {
        self.0
    }

    /// The usual abbreviation.
    pub const fn name(self) -> &'static str {
        self.0.name
    }

    /// The key in scenario files.
    pub const fn key(self) -> &'static str {
        self.0.key
    }

    /// What it does, in a few words.
    pub const fn description(self) -> &'static str {
        self.0.description
    }

    /// Where it comes from.
    pub const fn reference(self) -> &'static str {
        self.0.reference
    }

    /// Whether the belief is a random sample, so that results have Monte Carlo error.
    pub const fn is_sampled(self) -> bool {
        self.0.is_sampled
    }
}

impl Default for FilterKind {
    fn default() -> Self {
        Self::EKF
    }
}

impl PartialEq for FilterKind {
    fn eq(&self, other: &Self) -> bool {
        self.key() == other.key()
    }
}

impl Eq for FilterKind {}

impl fmt::Debug for FilterKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.key())
    }
}

impl Serialize for FilterKind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.key())
    }
}

impl<'de> Deserialize<'de> for FilterKind {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        static KEYS: LazyLock<Vec<&'static str>> =
            LazyLock::new(|| FilterKind::ALL.iter().map(|kind| kind.key()).collect());
        let key = String::deserialize(deserializer)?;
        Self::from_key(&key).ok_or_else(|| de::Error::unknown_variant(&key, &KEYS))
    }
}
