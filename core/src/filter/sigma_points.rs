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
use crate::integrate::RungeKutta;
use crate::linalg::{
    Matrix, Vector, add_all_columns, copy_vector, fit, fit_vector, lower_root_into, multiply_symmetric,
    multiply_transposed,
};

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

/// The mean of a Gaussian and its sigma points, 2n of them.
#[derive(Clone, Debug)]
struct Points {
    /// The points on one side, as distances from the mean: the columns of `c L`.
    distances: Matrix,
    /// χ, each a column: the centre, all on one side, all on the other.
    states: Matrix,
}

impl Default for Points {
    fn default() -> Self {
        Self { distances: Matrix::zeros(0, 0), states: Matrix::zeros(0, 0) }
    }
}

impl Points {
    /// Those of a belief.
    fn draw(&mut self, belief: &Gaussian, rule: Rule) -> Result<(), FilterError> {
        let Self { distances, states } = self;
        let n = belief.size();
        let (spread, _, _) = rule.constants(n);
        lower_root_into(distances, &belief.cov)?;
        *distances *= spread.sqrt();

        fit(states, n, 2 * n + 1);
        let centre = belief.mean.as_slice();
        let (first, others) = states.as_mut_slice().split_at_mut(n);
        let (one_side, other_side) = others.split_at_mut(n * n);
        first.copy_from_slice(centre);
        let sides = one_side.chunks_exact_mut(n).zip(other_side.chunks_exact_mut(n));
        for ((plus, minus), distance) in sides.zip(distances.as_slice().chunks_exact(n)) {
            for i in 0..n {
                (plus[i], minus[i]) = (centre[i] + distance[i], centre[i] - distance[i]);
            }
        }
        Ok(())
    }

    /// Moves all points by a step; components that are held keep their distances to the last bit.
    fn advance(&mut self, model: &Model, step: Step, method: &mut RungeKutta, images: &mut Images) {
        let Self { distances, states } = self;
        step.advance(model, states, method);
        images.take(states);
        if model.eta() == 0.0 {
            let (n, held) = (model.size(), model.motion()..);
            let (one_side, other_side) = images.deviations.as_mut_slice().split_at_mut(n * n);
            let sides = one_side.chunks_exact_mut(n).zip(other_side.chunks_exact_mut(n));
            for ((plus, minus), distance) in sides.zip(distances.as_slice().chunks_exact(n)) {
                plus[held.clone()].copy_from_slice(&distance[held.clone()]);
                minus[held.clone()].iter_mut().zip(&distance[held.clone()]).for_each(|(minus, d)| *minus = -d);
            }
        }
    }
}

/// The images of sigma points under some function: that of the centre, and the distances of all others from it, each a
/// column.
#[derive(Clone, Debug)]
struct Images {
    centre: Vector,
    deviations: Matrix,
    /// s
    shift: Vector,
    /// The distances of one side less those of the other.
    across: Matrix,
}

impl Default for Images {
    fn default() -> Self {
        let (none, nothing) = (|| Matrix::zeros(0, 0), || Vector::zeros(0));
        Self { centre: nothing(), deviations: none(), shift: nothing(), across: none() }
    }
}

impl Images {
    /// Takes the images of the centre and of all other points, each a column.
    fn take(&mut self, images: &Matrix) {
        let Self { centre, deviations, .. } = self;
        let m = images.nrows();
        fit_vector(centre, m);
        fit(deviations, m, images.ncols() - 1);
        let (first, others) = images.as_slice().split_at(m);
        centre.copy_from_slice(first);
        for (deviation, image) in deviations.as_mut_slice().chunks_exact_mut(m).zip(others.chunks_exact(m)) {
            for i in 0..m {
                deviation[i] = image[i] - first[i];
            }
        }
    }

    /// The unscented transform: `mean = g(χ₀) + s`, `cov = Σ W d dᵀ + o s sᵀ`, `s = Σ W d`; of the covariance the lower
    /// triangle.
    fn moments(&mut self, rule: Rule, mean: &mut Vector, cov: &mut Matrix) {
        let Self { centre, deviations, shift, .. } = self;
        let (m, points) = deviations.shape();
        let (_, weight, offset) = rule.constants(points / 2);
        fit_vector(shift, m);
        shift.fill(0.0);
        add_all_columns(shift, weight, deviations);
        copy_vector(mean, centre);
        *mean += &*shift;
        fit(cov, m, m);
        multiply_symmetric(cov, weight, deviations, deviations);
        for j in 0..m {
            let share = offset * shift[j];
            for i in j..m {
                cov[(i, j)] += shift[i] * share;
            }
        }
    }

    /// `Σ W (χ - y) dᵀ`, the covariance with the state that the points were drawn from.
    fn cross(&mut self, points: &Points, rule: Rule, cross: &mut Matrix) {
        self.subtract_sides();
        let (_, weight, _) = rule.constants(points.distances.nrows());
        multiply_transposed(cross, &points.distances, &self.across);
        *cross *= weight;
    }

    /// Subtracts the distances of one side from those of the other.
    fn subtract_sides(&mut self) {
        let Self { deviations, across, .. } = self;
        let (m, points) = deviations.shape();
        fit(across, m, points / 2);
        let (one_side, other_side) = deviations.as_slice().split_at(m * points / 2);
        for ((across, plus), minus) in across.as_mut_slice().iter_mut().zip(one_side).zip(other_side) {
            *across = plus - minus;
        }
    }
}

/// Φ, n × n: the regression on the state of a Gaussian of what a step makes of it, `Σ W d (χ - y)ᵀ P⁻¹`.
///
/// ```text
/// Φ (c L) = (d₊ - d₋) / 2
/// ```
///
/// A direction of no variance has no part in it.
pub(super) fn transition(belief: &Gaussian, rule: Rule, model: &Model, step: Step) -> Result<Matrix, FilterError> {
    let (mut points, mut images) = (Points::default(), Images::default());
    points.draw(belief, rule)?;
    points.advance(model, step, &mut RungeKutta::default(), &mut images);
    images.subtract_sides();
    let mut transition = images.across * 0.5;
    // From the right by the triangle's inverse, the last column first.
    let distances = &points.distances;
    for j in (0..belief.size()).rev() {
        let (mut column, after) = transition.columns_range_pair_mut(j, j + 1..);
        for (k, later) in after.column_iter().enumerate() {
            column.axpy(-distances[(j + 1 + k, j)], &later, 1.0);
        }
        let pivot = distances[(j, j)];
        column.scale_mut(if pivot == 0.0 { 0.0 } else { 1.0 / pivot });
    }
    Ok(transition)
}

/// A Gaussian that moves and is measured by sigma points, each moved by one Runge-Kutta step, and drawn afresh for the
/// measurement.
#[derive(Clone, Debug)]
pub struct SigmaPoints {
    belief: Gaussian,
    rule: Rule,
    points: Points,
    images: Images,
    method: RungeKutta,
    readings: Matrix,
    expected: Expected,
    work: kalman::Work,
}

impl SigmaPoints {
    /// A belief with sigma points after the given rule.
    pub fn new(belief: Gaussian, rule: Rule) -> Self {
        Self {
            belief,
            rule,
            points: Points::default(),
            images: Images::default(),
            method: RungeKutta::default(),
            readings: Matrix::zeros(0, 0),
            expected: Expected::default(),
            work: kalman::Work::default(),
        }
    }
}

impl Belief for SigmaPoints {
    fn predict(&mut self, model: &Model, step: Step, noise: &Noise) -> Result<(), FilterError> {
        let Self { belief, rule, points, images, method, .. } = self;
        points.draw(belief, *rule)?;
        points.advance(model, step, method, images);
        images.moments(*rule, &mut belief.mean, &mut belief.cov);
        noise.spread(&mut belief.cov);
        Ok(())
    }

    fn condition(
        &mut self,
        model: &Model,
        observation: &Observation,
        correction: &mut Correction,
    ) -> Result<(), FilterError> {
        let Self { belief, rule, points, images, method: _, readings, expected, work } = self;
        if observation.is_linear() {
            // Sigma points through a linear function give its exact moments, which H gives for less.
            expected.linearise(belief, model, &belief.mean, observation, work);
        } else {
            points.draw(belief, *rule)?;
            observation.read_all_into(model, &points.states, &mut work.rates, readings);
            images.take(readings);
            images.moments(*rule, &mut expected.mean, &mut expected.cov);
            observation.add_noise(&mut expected.cov);
            images.cross(points, *rule, &mut expected.cross);
            expected.jacobian = None;
        }
        kalman::condition(belief, expected, observation, correction)
    }

    fn renew(&mut self, place: usize, variance: f64) -> Result<(), FilterError> {
        self.belief.renew(place, variance);
        Ok(())
    }

    fn gaussian(&self) -> Cow<'_, Gaussian> {
        Cow::Borrowed(&self.belief)
    }

    fn transition(&self, model: &Model, step: Step) -> Result<Matrix, FilterError> {
        transition(&self.belief, self.rule, model, step)
    }
}

pub(super) static UKF: FilterInfo = FilterInfo {
    key: "ukf",
    name: "UKF",
    description: "moves 2n + 1 sigma points",
    reference: "Julier and Uhlmann (2004), Unscented filtering and nonlinear estimation",
    is_sampled: false,
    has_own_likelihood: false,
    evaluations: |_, n| 4 * (2 * n + 1),
    begin: |initial, _, _| Ok(Box::new(SigmaPoints::new(initial, Rule::Unscented))),
};

pub(super) static CKF: FilterInfo = FilterInfo {
    key: "ckf",
    name: "CKF",
    description: "moves 2n cubature points",
    reference: "Arasaratnam and Haykin (2009), Cubature Kalman filters",
    is_sampled: false,
    has_own_likelihood: false,
    evaluations: |_, n| 4 * 2 * n,
    begin: |initial, _, _| Ok(Box::new(SigmaPoints::new(initial, Rule::Cubature))),
};
