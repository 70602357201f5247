//! First-order linearisation at the mean.
//!
//! Source: Huang and Yuen (2023), *Bayesian Real-Time System Identification*; Gelb, ed. (1974), *Applied Optimal
//! Estimation*, section 6.1.

use super::{Active, Expected};
use crate::gaussian::{Gaussian, Matrix, Vector};
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
    let mut half = *cov;
    for j in 0..N {
        for i in 0..motion {
            half[(i, j)] = (0..N).map(|k| transition[(i, k)] * cov[(k, j)]).sum();
        }
        for i in motion..N {
            half[(i, j)] *= transition[(i, i)];
        }
    }
    let mut result = Matrix::<N, N>::zeros();
    for j in 0..N {
        for i in j..N {
            let entry = if j < motion {
                (0..N).map(|k| half[(i, k)] * transition[(j, k)]).sum()
            } else {
                half[(i, j)] * transition[(j, j)]
            };
            result[(i, j)] = entry;
            result[(j, i)] = entry;
        }
    }
    result
}

/// `h(y⁻)`, `S = H P⁻ Hᵀ + R` and `P⁻ Hᵀ`.
pub(super) fn expect<P: Model<N>, const N: usize, const M: usize>(
    model: &P,
    belief: &Gaussian<N>,
    active: &[Active; M],
    force: f64,
) -> Expected<N, M> {
    let Gaussian { mean: state, cov } = belief;
    let mut mean = Vector::<M>::zeros();
    let mut jacobian = Matrix::<M, N>::zeros();
    for (row, sensor) in active.iter().enumerate() {
        match sensor.output {
            Output::State(i) => {
                mean[row] = state[i];
                jacobian[(row, i)] = 1.0;
            }
            Output::Rate(i) => {
                mean[row] = model.rate(state, force)[i];
                jacobian.set_row(row, &model.jacobian(state).row(i));
            }
        }
    }
    let cross = seen_by(cov, &jacobian, active);
    let mut innovation_cov = seen_by(&cross.transpose(), &jacobian, active);
    for (row, sensor) in active.iter().enumerate() {
        innovation_cov[(row, row)] += sensor.variance;
    }
    Expected { mean, cov: innovation_cov, cross, jacobian: Some(jacobian) }
}

/// `X Hᵀ`, which for sensors that read a component of the state only picks columns.
#[inline]
pub(super) fn seen_by<const N: usize, const M: usize, const R: usize>(
    x: &Matrix<R, N>,
    jacobian: &Matrix<M, N>,
    active: &[Active; M],
) -> Matrix<R, M> {
    let mut result = Matrix::<R, M>::zeros();
    for (row, sensor) in active.iter().enumerate() {
        match sensor.output {
            Output::State(i) => result.set_column(row, &x.column(i)),
            Output::Rate(_) => result.set_column(row, &(x * jacobian.row(row).transpose())),
        }
    }
    result
}
