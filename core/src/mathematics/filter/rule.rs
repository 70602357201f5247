//! Rules for sigma points.

use crate::mathematics::engine::design;

/// The places and weights of sigma points.
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
