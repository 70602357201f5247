//! Beliefs as a handful of points: UKF, SR-UKF and CKF.
//!
//! ```text
//! χ₀ = y,  χ± = y ± c L e_i,  L Lᵀ = P
//! dᵢ = g(χᵢ) - g(χ₀),  s = Σ W dᵢ,  mean = g(χ₀) + s,  cov = Σ W dᵢ dᵢᵀ + o s sᵀ
//! ```
//!
//! Means and covariances are taken about the centre's image: in exact arithmetic that is the weighted sum of the
//! textbooks, in floating point it leaves a constant component exactly as it is.

use super::kind::time_of_linearised;
use super::{FilterInfo, Rule, Way};
use crate::mathematics::engine::design::Method;

pub(super) static UKF: FilterInfo = FilterInfo {
    key: "ukf",
    name: "UKF",
    description: "moves 2n + 1 sigma points",
    reference: "Julier and Uhlmann (2004), Unscented filtering and nonlinear estimation",
    is_sampled: false,
    has_own_likelihood: false,
    evaluations: |_, n| 4 * (2 * n + 1),
    time: |_, n| 4.0 * time_of_linearised(n),
    has_propagation: false,
    way: Way::Gaussian(|_, n| Method::SigmaPoints(Rule::Unscented.of_size(n))),
};

pub(super) static CKF: FilterInfo = FilterInfo {
    key: "ckf",
    name: "CKF",
    description: "moves 2n cubature points",
    reference: "Arasaratnam and Haykin (2009), Cubature Kalman filters",
    is_sampled: false,
    has_own_likelihood: false,
    evaluations: |_, n| 4 * 2 * n,
    time: |_, n| 4.0 * time_of_linearised(n),
    has_propagation: false,
    way: Way::Gaussian(|_, n| Method::SigmaPoints(Rule::Cubature.of_size(n))),
};

pub(super) static SR_UKF: FilterInfo = FilterInfo {
    key: "sr_ukf",
    name: "SR-UKF",
    description: "a UKF on the root of its covariance, which no rounding makes indefinite",
    reference: "van der Merwe and Wan (2001), The square-root unscented Kalman filter for state and parameter-estimation",
    is_sampled: false,
    has_own_likelihood: false,
    evaluations: |_, n| 4 * (2 * n + 1),
    time: |_, n| 4.0 * time_of_linearised(n),
    has_propagation: false,
    way: Way::Gaussian(|_, n| Method::SquareRoot(Rule::Unscented.of_size(n))),
};
