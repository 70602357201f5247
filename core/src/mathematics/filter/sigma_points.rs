//! Beliefs as a handful of points: UKF and CKF.
//!
//! ```text
//! χ₀ = y,  χ± = y ± c L e_i,  L Lᵀ = P
//! dᵢ = g(χᵢ) - g(χ₀),  s = Σ W dᵢ,  mean = g(χ₀) + s,  cov = Σ W dᵢ dᵢᵀ + o s sᵀ
//! ```
//!
//! Means and covariances are taken about the centre's image: in exact arithmetic that is the weighted sum of the
//! textbooks, in floating point it leaves a constant component exactly as it is.

use super::kind::time_of_linearised;
use super::{Belief, FilterError, FilterInfo, Gaussian, Moments, Rule, Step};
use crate::Model;
use crate::mathematics::linalg::Matrix;

/// Φ, n × n: the linear regression of the next state on the state, over the sigma points.
pub(super) fn transition(belief: &Gaussian, rule: Rule, model: &Model, step: Step) -> Result<Matrix, FilterError> {
    Moments::sigma_points(belief.clone(), rule).transition(model, step)
}

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
    begin: |initial, _, _| Ok(Box::new(Moments::sigma_points(initial, Rule::Unscented))),
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
    begin: |initial, _, _| Ok(Box::new(Moments::sigma_points(initial, Rule::Cubature))),
};
