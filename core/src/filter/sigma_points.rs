//! Beliefs as a handful of points: UKF and CKF.
//!
//! ```text
//! χ₀ = y,  χ± = y ± c L e_i,  L Lᵀ = P
//! dᵢ = g(χᵢ) - g(χ₀),  s = Σ W dᵢ,  mean = g(χ₀) + s,  cov = Σ W dᵢ dᵢᵀ + o s sᵀ
//! ```
//!
//! Means and covariances are taken about the centre's image: in exact arithmetic that is the weighted sum of the
//! textbooks, in floating point it leaves a component that does not vary exactly where it is.

use super::{Belief, FilterError, FilterInfo, Gaussian, Moments, Step};
use crate::Model;
use crate::engine::design;
use crate::linalg::Matrix;

/// Where sigma points are and what they weigh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// The scaled unscented transform with α = 1, β = 2, κ = 3 - n: points √3 standard deviations away. With these
    /// constants the covariance is a sum of squares, `o = W₀ᶜ + 2nW - 2 = 1`, and never turns negative.
    ///
    /// Source: Julier and Uhlmann (2004), Unscented filtering and nonlinear estimation; van der Merwe (2004), section 3.2.
    Unscented,
    /// The third-degree spherical-radial cubature rule: 2n points √n standard deviations away, none in the centre,
    /// `o = -1`.
    ///
    /// Source: Arasaratnam and Haykin (2009), Cubature Kalman filters.
    Cubature,
}

impl Rule {
    /// c², the weight W of each point but the centre, and o, the part of `s sᵀ` in the covariance.
    #[inline(always)]
    pub(crate) fn constants(self, n: usize) -> (f64, f64, f64) {
        let (spread, offset) = match self {
            Self::Unscented => (3.0, 1.0),
            Self::Cubature => (n as f64, -1.0),
        };
        (spread, 1.0 / (2.0 * spread), offset)
    }

    /// The rule for n components, as the engine has it.
    pub(crate) fn of_size(self, n: usize) -> design::Rule {
        let (spread, _, offset) = self.constants(n);
        design::Rule { spread, offset }
    }
}

/// Φ, n × n: the regression on the state of a Gaussian of what a step makes of it.
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
    begin: |initial, _, _| Ok(Box::new(Moments::sigma_points(initial, Rule::Cubature))),
};
