//! Kinds of filters, and those whose belief is a random sample, of your own, or of a system of your own.
//!
//! ```text
//! predict   y⁻ = g-step of y,  P⁻ = λ cov(g-step of y) + Q
//! update    e = z - h(y⁻),  S = H P⁻ Hᵀ + R,  K = P⁻ Hᵀ S⁻¹,  y = y⁻ + K e,  P = (I - K H) P⁻ (I - K H)ᵀ + K R Kᵀ
//! ```
//!
//! The engine predicts and updates a mean and a covariance. Any other method is a [`Belief`], and [`Filter`] is what these share.

mod belief;
pub mod kalman;
mod linear;
mod recursion;
mod sampled;
mod system;

use crate::engine::design::{Method, Rule};
use crate::registry::{keyed, registry};

pub use crate::engine::design::{Course, Propagation};
pub use crate::engine::model::{ForceOn, Input, Step};
pub use crate::engine::robust::{self, Robust};
pub use crate::engine::wrapper::Adaptation;
pub use crate::filter_error::FilterError;
pub use crate::linalg::{Matrix, Vector};
pub use crate::random::Normal;
pub use belief::{Belief, Correction, Gaussian, Noise, Observation, White};
pub use kalman::Expected;
pub use linear::{KalmanFilter, MeasurementModel, SystemError};
pub use recursion::Filter;
pub use sampled::{Ensemble, Particles};
pub use system::{States, System};

registry! {
    FilterKind by FilterKind,
    /// Every kind of the registry.
    ALL;
    /// Kalman filter: the parameters are known, so their standard deviations and `eta` are taken as zero.
    KF = KF;
    /// Extended Kalman filter: local linearisation.
    EKF = EKF;
    /// Iterated extended Kalman filter: the sensors are linearised where the update leads.
    IEKF = IEKF;
    /// Unscented Kalman filter: scaled sigma points.
    UKF = UKF;
    /// Unscented Kalman filter on the root of its covariance.
    SR_UKF = SR_UKF;
    /// Cubature Kalman filter.
    CKF = CKF;
    /// Ensemble Kalman filter.
    ENKF = sampled::ENKF;
    /// Bootstrap particle filter, regularised.
    PF = sampled::PF;
}

/// The description of a kind of filter.
#[derive(Debug)]
pub struct FilterInfo {
    /// The key in scenario files.
    pub key: &'static str,
    /// The usual abbreviation.
    pub name: &'static str,
    /// Its method in a few words.
    pub description: &'static str,
    /// Where it comes from.
    pub reference: &'static str,
    /// Whether the belief is a random sample, so that results have Monte Carlo error.
    pub is_sampled: bool,
    /// Whether the belief reports its own log likelihood and effective sample size; else the likelihood follows from NIS and S.
    pub has_own_likelihood: bool,
    /// The number of times that a filter with these settings evaluates `g(y, f)` of an n-component state in one prediction.
    pub evaluations: fn(&MethodSettings, usize) -> usize,
    /// The time of a prediction and an update of an n-component state, to within a factor of three \[ns\]: for portions of the work.
    pub time: fn(&MethodSettings, usize) -> f64,
    /// Whether the belief moves as the setting `propagation` says. By local linearisation that is exact on a linear plant.
    pub has_propagation: bool,
    /// How its belief moves and is measured.
    pub algorithm: Algorithm,
}

/// How a belief moves and is measured.
#[derive(Clone, Copy, Debug)]
pub enum Algorithm {
    /// It is a mean and a covariance, and all options of filters work: the method of one with these settings over n components.
    Gaussian(fn(&MethodSettings, usize) -> Method),
    /// It is a [`Belief`]: the one that a filter begins with, from mean and covariance, and from random numbers if it needs any.
    Belief(Begin),
}

/// The settings that a method of filtering reads, in addition to model, belief and noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MethodSettings {
    /// The propagation of the mean of a KF, EKF or IEKF.
    pub propagation: Propagation,
    /// Limits the linearisations of the sensors in one update of an IEKF.
    pub iterations: usize,
    /// The number of members of an EnKF, or of particles of a PF.
    pub ensemble_size: usize,
}

/// The time of a prediction and an update by linearisation \[ns\].
fn time_of_linearised(n: usize) -> f64 {
    let n = n as f64;
    // A matrix product takes n³ multiplications; the rest of a step takes about n².
    60.0 + 6.0 * n * n + n * n * n
}

/// Makes the belief that a filter begins with.
pub type Begin = fn(Gaussian, &MethodSettings, Normal) -> Result<Box<dyn Belief>, FilterError>;

/// A kind of filter, identified by its key.
#[derive(Clone, Copy)]
pub struct FilterKind(&'static FilterInfo);

impl FilterKind {
    /// Your own kind, which files cannot name. A scenario with your own kind under a key of the registry is refused.
    pub const fn new(info: &'static FilterInfo) -> Self {
        Self(info)
    }

    /// The kind of the registry with this key, if there is one.
    pub fn from_key(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.key() == key)
    }

    /// Whether it is your own kind with a key of the registry: a file with this key would mean the registry's.
    pub fn is_impostor(self) -> bool {
        Self::from_key(self.key()).is_some_and(|known| known != self)
    }

    /// Its description.
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

    /// Its method in a few words.
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

    /// Whether the belief is a mean and a covariance, for which all options of filters work.
    pub const fn is_gaussian(self) -> bool {
        matches!(self.0.algorithm, Algorithm::Gaussian(_))
    }

    /// Whether the belief reports its own log likelihood and effective sample size.
    pub const fn has_own_likelihood(self) -> bool {
        self.0.has_own_likelihood
    }
}

impl Default for FilterKind {
    fn default() -> Self {
        Self::EKF
    }
}

impl PartialEq for FilterKind {
    /// Compares keys; your own kind differs from the registry's kind with the same key.
    fn eq(&self, other: &Self) -> bool {
        // The descriptions of the registry are statics.
        let is_own = |kind: &Self| !Self::ALL.iter().any(|known| std::ptr::eq(known.0, kind.0));
        std::ptr::eq(self.0, other.0) || (self.key() == other.key() && is_own(self) && is_own(other))
    }
}

impl Eq for FilterKind {}

keyed!(FilterKind, also read);

const LINEARISED: FilterInfo = FilterInfo {
    key: "ekf",
    name: "EKF",
    description: "linearises plant and sensors at the mean",
    reference: "Huang and Yuen (2023), Bayesian Real-Time System Identification",
    is_sampled: false,
    has_own_likelihood: false,
    // A Jacobian counts as n evaluations, one a column, as by differences.
    evaluations: |settings, n| if settings.propagation == Propagation::RungeKutta { 4 * (1 + n) } else { 1 + n },
    time: |_, n| time_of_linearised(n),
    has_propagation: true,
    algorithm: Algorithm::Gaussian(|settings, _| Method::Linearised(settings.propagation, 1)),
};

static EKF: FilterInfo = LINEARISED;

static KF: FilterInfo = FilterInfo {
    key: "kf",
    name: "KF",
    description: "assumes known parameters; optimal on a linear plant",
    reference: "Kalman (1960), A new approach to linear filtering and prediction problems",
    ..LINEARISED
};

static IEKF: FilterInfo = FilterInfo {
    key: "iekf",
    name: "IEKF",
    description: "linearises the sensors again at the updated mean, by Gauss-Newton",
    reference: "Bell and Cathey (1993), The iterated Kalman filter update as a Gauss-Newton method",
    time: |settings, n| settings.iterations.max(1) as f64 * time_of_linearised(n),
    algorithm: Algorithm::Gaussian(|settings, _| Method::Linearised(settings.propagation, settings.iterations)),
    ..LINEARISED
};

const SIGMA_POINTS: FilterInfo = FilterInfo {
    key: "ukf",
    name: "UKF",
    description: "moves 2n + 1 sigma points",
    reference: "Julier and Uhlmann (2004), Unscented filtering and nonlinear estimation",
    is_sampled: false,
    has_own_likelihood: false,
    evaluations: |_, n| 4 * (2 * n + 1),
    time: |_, n| 4.0 * time_of_linearised(n),
    has_propagation: false,
    algorithm: Algorithm::Gaussian(|_, _| Method::SigmaPoints(Rule::UNSCENTED)),
};

static UKF: FilterInfo = SIGMA_POINTS;

static CKF: FilterInfo = FilterInfo {
    key: "ckf",
    name: "CKF",
    description: "moves 2n cubature points",
    reference: "Arasaratnam and Haykin (2009), Cubature Kalman filters",
    evaluations: |_, n| 4 * 2 * n,
    algorithm: Algorithm::Gaussian(|_, n| Method::SigmaPoints(Rule::cubature(n))),
    ..SIGMA_POINTS
};

static SR_UKF: FilterInfo = FilterInfo {
    key: "sr_ukf",
    name: "SR-UKF",
    description: "a UKF on the square root of its covariance, which rounding cannot make indefinite",
    reference: "van der Merwe and Wan (2001), The square-root unscented Kalman filter for state and parameter-estimation",
    algorithm: Algorithm::Gaussian(|_, _| Method::SquareRoot(Rule::UNSCENTED)),
    ..SIGMA_POINTS
};
