//! First-order linearisation at the mean.
//!
//! Source: Huang and Yuen (2023), *Bayesian Real-Time System Identification*; Gelb, ed. (1974), *Applied Optimal
//! Estimation*, section 6.1.

use super::{Active, Expected, View};
use crate::gaussian::{Gaussian, Matrix, Vector, mirrored};
use crate::model::{Model, Output};

/// `y⁻ = y + dt φ₁(A dt) g(y, f)` and `Φ P Φᵀ`.
pub(super) fn predict<P: Model<N>, const N: usize>(model: &P, belief: &mut Gaussian<N>, force: f64, dt: f64) {
    let (mean, transition) = model.linearised_step(&belief.mean, force, dt);
    belief.mean = mean;
    belief.cov = propagate(P::MOTION, &transition, &belief.cov);
}

/// `Φ P Φᵀ`, symmetric to the last bit, where the first `motion` rows of Φ are full and the rest is diagonal.
#[inline]
fn propagate<const N: usize>(motion: usize, transition: &Matrix<N, N>, cov: &Matrix<N, N>) -> Matrix<N, N> {
    // The first rows of Φ P.
    let mut half = Matrix::<N, N>::zeros();
    for j in 0..N {
        for i in 0..motion {
            half[(i, j)] = transition[(i, 0)] * cov[(0, j)];
        }
        for k in 1..N {
            for i in 0..motion {
                half[(i, j)] += transition[(i, k)] * cov[(k, j)];
            }
        }
    }
    let mut result = Matrix::<N, N>::zeros();
    for j in 0..motion {
        for i in 0..motion {
            result[(i, j)] = half[(i, 0)] * transition[(j, 0)];
        }
        for k in 1..N {
            for i in 0..motion {
                result[(i, j)] += half[(i, k)] * transition[(j, k)];
            }
        }
        // P is symmetric: these rows of P Φᵀ are columns of Φ P.
        for i in motion..N {
            result[(i, j)] = half[(j, i)] * transition[(i, i)];
        }
    }
    for j in motion..N {
        for i in j..N {
            result[(i, j)] = cov[(i, j)] * (transition[(i, i)] * transition[(j, j)]);
        }
    }
    mirrored(result)
}

/// `y⁻`, `S` and `P⁻ Hᵀ` of sensors that read components of the state: H picks, it does not multiply.
#[inline]
pub(super) fn expect_components<const N: usize, const M: usize>(
    belief: &Gaussian<N>,
    components: [usize; M],
    active: &[Active; M],
) -> Expected<N, M> {
    let mut cross = Matrix::<N, M>::zeros();
    let mut mean = Vector::<M>::zeros();
    for (row, &i) in components.iter().enumerate() {
        mean[row] = belief.mean[i];
        // A row, not the same column: reading it number by number does not wait for pairs to be written.
        for k in 0..N {
            cross[(k, row)] = belief.cov[(i, k)];
        }
    }
    let mut seen = Matrix::<M, M>::zeros();
    for (row, &i) in components.iter().enumerate() {
        for column in 0..M {
            seen[(row, column)] = cross[(i, column)];
        }
    }
    let mut cov = seen;
    for (row, sensor) in active.iter().enumerate() {
        cov[(row, row)] += sensor.variance;
    }
    Expected { mean, cov, cross, view: View::Components(seen) }
}

/// `h(y⁻)`, `S = H P⁻ Hᵀ + R` and `P⁻ Hᵀ`.
pub(super) fn expect<P: Model<N>, const N: usize, const M: usize>(
    model: &P,
    belief: &Gaussian<N>,
    active: &[Active; M],
    force: f64,
) -> Expected<N, M> {
    let Gaussian { mean: state, cov } = belief;
    let rate = model.rate(state, force);
    let rate_jacobian = model.jacobian(state);
    let mut mean = Vector::<M>::zeros();
    let mut jacobian = Matrix::<M, N>::zeros();
    for (row, sensor) in active.iter().enumerate() {
        match sensor.output {
            Output::State(i) => {
                mean[row] = state[i];
                jacobian[(row, i)] = 1.0;
            }
            Output::Rate(i) => {
                mean[row] = rate[i];
                jacobian.set_row(row, &rate_jacobian.row(i));
            }
        }
    }
    let cross = cov * jacobian.transpose();
    let mut innovation_cov = jacobian * cross;
    for (row, sensor) in active.iter().enumerate() {
        innovation_cov[(row, row)] += sensor.variance;
    }
    Expected { mean, cov: innovation_cov, cross, view: View::Linear(jacobian) }
}
