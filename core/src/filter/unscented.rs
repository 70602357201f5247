//! Scaled sigma points.
//!
//! ```text
//! χ₀ = y,  χ± = y ± c L e_i,  L Lᵀ = P,  c² = α² (n + κ)
//! ```
//!
//! with α = 1, β = 2, κ = 3 - n. Means and covariances are taken about the centre's image: in exact arithmetic that is
//! the weighted sum of the textbooks, in floating point it leaves a component that does not vary exactly where it is, and
//! with these constants it is a sum of squares, so that no covariance turns negative:
//!
//! ```text
//! dᵢ = g(χᵢ) - g(χ₀),  s = Σ W dᵢ,  mean = g(χ₀) + s,  cov = Σ W dᵢ dᵢᵀ + (W₀ᶜ + 2nW - 2) s sᵀ = Σ W dᵢ dᵢᵀ + s sᵀ
//! ```
//!
//! A prediction sums over pairs `d± = b ± a` instead, which halves the work: what is linear in its distance from the mean,
//! as parameters are, has no `b`.
//!
//! ```text
//! s = Σ 2W b,  cov = Σ 2W (a aᵀ + b bᵀ) + s sᵀ
//! ```
//!
//! Source: Julier and Uhlmann (2004), Unscented filtering and nonlinear estimation; van der Merwe (2004), section 3.2.

use super::{Active, Expected, View};
use crate::FilterError;
use crate::gaussian::{Gaussian, Matrix, Vector, lower_root};
use crate::model::{Model, Output};

/// α² (n + κ) with α = 1 and κ = 3 - n: sigma points are √3 standard deviations away.
const SPREAD: f64 = 3.0;
/// Weight of each sigma point but the centre.
const WEIGHT: f64 = 1.0 / (2.0 * SPREAD);
/// Weight of each pair of them.
const PAIR: f64 = 1.0 / SPREAD;

/// The distances of the sigma points from the mean: the rows of `√3 Lᵀ`.
#[inline]
fn distances<const N: usize>(cov: &Matrix<N, N>) -> Result<Matrix<N, N>, FilterError> {
    Ok(lower_root(cov)?.transpose() * SPREAD.sqrt())
}

/// Mean and covariance of the belief after one Runge-Kutta step of each sigma point.
pub(super) fn predict<P: Model<N>, const N: usize>(
    model: &P,
    belief: &mut Gaussian<N>,
    force: f64,
    dt: f64,
) -> Result<(), FilterError> {
    let distances = distances(&belief.cov)?;
    let (mut high, mut low) = (distances, distances);
    for j in 0..N {
        for i in 0..N {
            high[(i, j)] = belief.mean[j] + distances[(i, j)];
            low[(i, j)] = belief.mean[j] - distances[(i, j)];
        }
    }
    let centre = model.runge_kutta_step(&belief.mean, force, dt);
    let high = model.runge_kutta_steps(&high, force, dt);
    let low = model.runge_kutta_steps(&low, force, dt);

    let linear = (high - low) * 0.5;
    let mut curved = (high + low) * 0.5;
    let mut offset = Vector::<N>::zeros();
    for j in 0..P::MOTION {
        for i in 0..N {
            curved[(i, j)] -= centre[j];
        }
        offset[j] = curved.column(j).sum() * PAIR;
    }
    for j in 0..N {
        for i in j..N {
            let mut squares = dot(&linear, i, j);
            if i < P::MOTION {
                squares += dot(&curved, i, j);
            }
            let entry = squares * PAIR + offset[i] * offset[j];
            belief.cov[(i, j)] = entry;
            belief.cov[(j, i)] = entry;
        }
    }
    belief.mean = centre + offset;
    Ok(())
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

/// What the sensors will read, from sigma points drawn afresh from the prediction.
pub(super) fn expect<P: Model<N>, const N: usize, const M: usize>(
    model: &P,
    belief: &Gaussian<N>,
    active: &[Active; M],
    force: f64,
) -> Result<Expected<N, M>, FilterError> {
    let distances = distances(&belief.cov)?;
    let read = |state: &Vector<N>| {
        let rate = model.rate(state, force);
        Vector::<M>::from_fn(|row, _| match active[row].output {
            Output::State(i) => state[i],
            Output::Rate(i) => rate[i],
        })
    };
    let centre = read(&belief.mean);
    let mut sum = Vector::<M>::zeros();
    let mut cov = Matrix::<M, M>::zeros();
    let mut cross = Matrix::<N, M>::zeros();
    for i in 0..N {
        let distance: Vector<N> = distances.row(i).transpose();
        let high = read(&(belief.mean + distance)) - centre;
        let low = read(&(belief.mean - distance)) - centre;
        sum += high + low;
        add_square(&mut cov, &high);
        add_square(&mut cov, &low);
        cross += distance * (high - low).transpose() * WEIGHT;
    }
    let offset = sum * WEIGHT;
    cov *= WEIGHT;
    add_square(&mut cov, &offset);
    for (row, sensor) in active.iter().enumerate() {
        cov[(row, row)] += sensor.variance;
    }
    Ok(Expected { mean: centre + offset, cov, cross, view: View::Curved })
}

/// Adds `d dᵀ`, column by column so that the compiler can use vector instructions.
#[inline]
fn add_square<const N: usize>(sum: &mut Matrix<N, N>, d: &Vector<N>) {
    for j in 0..N {
        for i in 0..N {
            sum[(i, j)] += d[i] * d[j];
        }
    }
}
