//! Beliefs as a handful of points: UKF and CKF.
//!
//! ```text
//! χ₀ = y,  χ± = y ± c L e_i,  L Lᵀ = P
//! dᵢ = g(χᵢ) - g(χ₀),  s = Σ W dᵢ,  mean = g(χ₀) + s,  cov = Σ W dᵢ dᵢᵀ + o s sᵀ
//! ```
//!
//! Means and covariances are taken about the centre's image: in exact arithmetic that is the weighted sum of the
//! textbooks, in floating point it leaves a component that does not vary exactly where it is.

use std::borrow::Cow;

use super::kalman::{self, Expected};
use super::{Belief, Correction, FilterError, FilterInfo, Gaussian, Noise, Observation, Step};
use crate::Model;
use crate::linalg::{Matrix, Vector, lower_root};

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
}

/// The mean of a Gaussian and its n sigma points on one side, as distances from it: the columns of `c L`.
struct Points<'a> {
    centre: &'a Vector,
    distances: Matrix,
}

impl<'a> Points<'a> {
    fn draw(belief: &'a Gaussian, rule: Rule) -> Result<Self, FilterError> {
        let (spread, _, _) = rule.constants(belief.size());
        Ok(Self { centre: &belief.mean, distances: lower_root(&belief.cov)? * spread.sqrt() })
    }

    /// χ, each a column: the centre, all on one side, all on the other.
    fn states(&self) -> Matrix {
        let Self { centre, distances } = self;
        let n = centre.len();
        Matrix::from_fn(n, 2 * n + 1, |i, j| match j {
            0 => centre[i],
            j if j <= n => centre[i] + distances[(i, j - 1)],
            j => centre[i] - distances[(i, j - n - 1)],
        })
    }

    /// The images of all points under a step; components that are held keep their distances to the last bit.
    fn moved(&self, model: &Model, step: Step) -> Images {
        let mut states = self.states();
        step.advance(model, &mut states);
        let mut images = Images::of(states);
        if model.eta() == 0.0 {
            let n = self.centre.len();
            for i in model.motion()..n {
                for j in 0..n {
                    images.deviations[(i, j)] = self.distances[(i, j)];
                    images.deviations[(i, j + n)] = -self.distances[(i, j)];
                }
            }
        }
        images
    }
}

/// The images of sigma points under some function: that of the centre, and the distances of all others from it, each a
/// column.
struct Images {
    centre: Vector,
    deviations: Matrix,
}

impl Images {
    /// Those of the centre and of all other points.
    fn of(images: Matrix) -> Self {
        let centre = images.column(0).into_owned();
        let mut deviations = images.remove_column(0);
        for mut image in deviations.column_iter_mut() {
            image -= &centre;
        }
        Self { centre, deviations }
    }

    /// The unscented transform: `mean = g(χ₀) + s`, `cov = Σ W d dᵀ + o s sᵀ`, `s = Σ W d`.
    fn moments(&self, rule: Rule) -> (Vector, Matrix) {
        let Self { centre, deviations } = self;
        let (_, weight, offset) = rule.constants(deviations.ncols() / 2);
        let shift = deviations.column_sum() * weight;
        let mut cov = Matrix::zeros(centre.len(), centre.len());
        cov.gemm(weight, deviations, &deviations.transpose(), 0.0);
        cov.ger(offset, &shift, &shift, 1.0);
        (centre + shift, cov)
    }

    /// `Σ W (χ - y) dᵀ`, the covariance with the state that the points were drawn from.
    fn cross(&self, points: &Points<'_>, rule: Rule) -> Matrix {
        let n = points.centre.len();
        let (_, weight, _) = rule.constants(n);
        let across = self.deviations.columns(0, n) - self.deviations.columns(n, n);
        &points.distances * across.transpose() * weight
    }
}

/// The covariance of a Gaussian's state with what a step makes of it.
pub(super) fn cross(belief: &Gaussian, rule: Rule, model: &Model, step: Step) -> Result<Matrix, FilterError> {
    let points = Points::draw(belief, rule)?;
    Ok(points.moved(model, step).cross(&points, rule))
}

/// A Gaussian that moves and is measured by sigma points, each moved by one Runge-Kutta step, and drawn afresh for the
/// measurement.
#[derive(Clone, Debug)]
pub struct SigmaPoints {
    belief: Gaussian,
    rule: Rule,
}

impl SigmaPoints {
    /// A belief with sigma points after the given rule.
    pub fn new(belief: Gaussian, rule: Rule) -> Self {
        Self { belief, rule }
    }
}

impl Belief for SigmaPoints {
    fn predict(&mut self, model: &Model, step: Step, noise: &Noise) -> Result<(), FilterError> {
        let Self { belief, rule } = self;
        let (mean, mut cov) = Points::draw(belief, *rule)?.moved(model, step).moments(*rule);
        noise.spread(&mut cov);
        *belief = Gaussian { mean, cov };
        Ok(())
    }

    fn condition(
        &mut self,
        model: &Model,
        observation: &Observation,
        correction: &mut Correction,
    ) -> Result<(), FilterError> {
        let Self { belief, rule } = self;
        let expected = if observation.is_linear() {
            // Sigma points through a linear function give its exact moments, which H gives for less.
            let at = belief.mean.as_slice();
            Expected::linear(belief, observation.read(model, at), observation.jacobian(model, at), observation)
        } else {
            let points = Points::draw(belief, *rule)?;
            let readings = Images::of(observation.read_all(model, &points.states()));
            let (mean, mut cov) = readings.moments(*rule);
            observation.add_noise(&mut cov);
            Expected { mean, cov, cross: readings.cross(&points, *rule), jacobian: None }
        };
        kalman::condition(belief, &expected, observation, correction)
    }

    fn gaussian(&self) -> Cow<'_, Gaussian> {
        Cow::Borrowed(&self.belief)
    }

    /// `Σ W (χᵢ - y) g(χᵢ)ᵀ`
    fn cross(&self, model: &Model, step: Step) -> Result<Matrix, FilterError> {
        cross(&self.belief, self.rule, model, step)
    }
}

pub(super) static UKF: FilterInfo = FilterInfo {
    key: "ukf",
    name: "UKF",
    description: "moves 2n + 1 sigma points",
    reference: "Julier and Uhlmann (2004), Unscented filtering and nonlinear estimation",
    is_sampled: false,
    evaluations: |_, n| 4 * (2 * n + 1),
    begin: |initial, _, _| Ok(Box::new(SigmaPoints::new(initial, Rule::Unscented))),
};

pub(super) static CKF: FilterInfo = FilterInfo {
    key: "ckf",
    name: "CKF",
    description: "moves 2n cubature points",
    reference: "Arasaratnam and Haykin (2009), Cubature Kalman filters",
    is_sampled: false,
    evaluations: |_, n| 4 * 2 * n,
    begin: |initial, _, _| Ok(Box::new(SigmaPoints::new(initial, Rule::Cubature))),
};
