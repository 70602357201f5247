//! Beliefs as a handful of points: UKF and CKF.
//!
//! ```text
//! χ₀ = y,  χ± = y ± c L e_i,  L Lᵀ = P
//! dᵢ = g(χᵢ) - g(χ₀),  s = Σ W dᵢ,  mean = g(χ₀) + s,  cov = Σ W dᵢ dᵢᵀ + o s sᵀ
//! ```
//!
//! Means and covariances are taken about the centre's image: in exact arithmetic that is the weighted sum of the
//! textbooks, in floating point it leaves a constant component exactly as it is.
//!
//! A prediction sums over pairs `d± = c (bᵢ ± aᵢ)` instead, which halves the work: components that are linear in the
//! distance from the mean, such as parameters, have no `b`. Since `2W c² = 1`, the `aᵢ` are the columns of a root.
//!
//! ```text
//! s = Σ bᵢ / c,  cov = Σ (aᵢ aᵢᵀ + bᵢ bᵢᵀ) + o s sᵀ
//! ```

use std::borrow::Cow;

use super::kalman::{self, Expected, View};
use super::{Belief, Correction, Noise, Observation};
use crate::mathematics::filter::{FilterError, Rule};
use crate::mathematics::kernel::gaussian::{Gaussian, Matrix, Vector, lower_root};
use crate::mathematics::kernel::model::Model;

/// A Gaussian that moves and is measured by sigma points, each moved by one Runge-Kutta step, and drawn again for the
/// measurement.
#[derive(Clone, Debug)]
pub struct SigmaPoints<const N: usize> {
    belief: Gaussian<N>,
    rule: Rule,
}

impl<const N: usize> SigmaPoints<N> {
    /// A belief with sigma points after the given rule.
    pub fn new(belief: Gaussian<N>, rule: Rule) -> Self {
        Self { belief, rule }
    }
}

impl<P: Model<N>, const N: usize> Belief<P, N> for SigmaPoints<N> {
    const PADDED: bool = false;

    #[inline]
    fn predict(&mut self, model: &P, force: f64, dt: f64, noise: &Noise<N>) -> Result<(), FilterError> {
        let Self { belief, rule } = self;
        let (spread, _, offset) = rule.constants(N);
        let distance = spread.sqrt();
        let mut root = lower_root(&belief.cov)?;
        // Points are rows, so that one component of all points is a column, contiguous in memory.
        let [mut high, mut low] = [Matrix::<N, N>::zeros(); 2];
        for j in 0..N {
            for i in 0..N {
                let step = root[(j, i)] * distance;
                high[(i, j)] = belief.mean[j] + step;
                low[(i, j)] = belief.mean[j] - step;
            }
        }
        let centre = model.runge_kutta_step(&belief.mean, force, dt);
        let high = model.runge_kutta_steps(&high, force, dt);
        let low = model.runge_kutta_steps(&low, force, dt);

        // Parameters that do not decay keep their rows of the root and their covariances with each other.
        let moving = if model.eta() == 0.0 { P::MOTION } else { N };
        let inverse = 1.0 / distance;
        let half = 0.5 * inverse;
        let mut curved = high;
        let mut shift = Vector::<N>::zeros();
        for j in 0..P::MOTION {
            for i in 0..N {
                curved[(i, j)] = (high[(i, j)] + low[(i, j)] - 2.0 * centre[j]) * half;
            }
            shift[j] = curved.column(j).sum() * inverse;
        }
        for j in 0..moving {
            for i in 0..N {
                root[(j, i)] = (high[(i, j)] - low[(i, j)]) * half;
            }
        }
        let mut cov = belief.cov;
        for j in 0..moving {
            let mut sums = Vector::<N>::zeros();
            for k in 0..N {
                for i in 0..N {
                    sums[i] += root[(i, k)] * root[(j, k)];
                }
            }
            for i in j..P::MOTION {
                sums[i] += dot(&curved, i, j) + offset * shift[i] * shift[j];
            }
            for i in j..N {
                cov[(i, j)] = sums[i];
            }
        }
        belief.mean = centre + shift;
        belief.cov = kalman::spread(cov, noise);
        Ok(())
    }

    #[inline]
    fn condition<const M: usize>(
        &mut self,
        model: &P,
        observation: &Observation<M>,
        correction: &mut Correction<N>,
    ) -> Result<(), FilterError> {
        let Self { belief, rule } = self;
        if let Some(components) = observation.components() {
            // For a linear function, sigma points give its exact moments; this computes the same with less work.
            return kalman::condition_on_components(belief, components, observation, correction);
        }
        let expected = expect(model, belief, *rule, observation)?;
        kalman::condition(belief, &expected, observation, correction)
    }

    #[inline]
    fn gaussian(&self) -> Cow<'_, Gaussian<N>> {
        Cow::Borrowed(&self.belief)
    }
}

/// The predicted measurements, from sigma points drawn again from the prediction.
fn expect<P: Model<N>, const N: usize, const M: usize>(
    model: &P,
    belief: &Gaussian<N>,
    rule: Rule,
    observation: &Observation<M>,
) -> Result<Expected<N, M>, FilterError> {
    let (spread, weight, offset) = rule.constants(N);
    let distances = lower_root(&belief.cov)? * spread.sqrt();
    let centre = observation.read(model, &belief.mean);
    let mut sum = Vector::<M>::zeros();
    let mut cov = Matrix::<M, M>::zeros();
    let mut cross = Matrix::<N, M>::zeros();
    for i in 0..N {
        let distance: Vector<N> = distances.column(i).into();
        let high = observation.read(model, &(belief.mean + distance)) - centre;
        let low = observation.read(model, &(belief.mean - distance)) - centre;
        sum += high + low;
        add_square(&mut cov, &high, 1.0);
        add_square(&mut cov, &low, 1.0);
        cross += distance * (high - low).transpose() * weight;
    }
    let shift = sum * weight;
    cov *= weight;
    add_square(&mut cov, &shift, offset);
    observation.add_noise(&mut cov);
    Ok(Expected { mean: centre + shift, cov, cross, view: View::Curved })
}

/// The product of two columns, in two sums that do not wait for each other.
#[inline]
fn dot<const N: usize>(x: &Matrix<N, N>, i: usize, j: usize) -> f64 {
    let mut sums = [0.0; 2];
    for k in 0..N {
        sums[k % 2] += x[(k, i)] * x[(k, j)];
    }
    sums[0] + sums[1]
}

/// Adds `b d dᵀ`, column by column so that the compiler can use vector instructions.
#[inline]
fn add_square<const N: usize>(sum: &mut Matrix<N, N>, d: &Vector<N>, b: f64) {
    for j in 0..N {
        for i in 0..N {
            sum[(i, j)] += b * d[i] * d[j];
        }
    }
}
