//! The update of a Gaussian belief, for linearised and sigma-point predictions of the measurement alike.

use super::correction::{Correction, Last};
use super::measurements::Measurements;
use super::{FilterError, Gaussian, Observation};
use crate::mathematics::linalg::{
    Ldl, Matrix, RootError, Vector, add_product, copy, fit, lower_root, multiply, multiply_sparse,
};

/// The prediction of m measurements from a belief.
#[derive(Clone, Debug)]
pub struct Expected {
    /// h(y⁻), m numbers.
    pub mean: Vector,
    /// S, noise included, m × m.
    pub cov: Matrix,
    /// The covariance of state and measurement, `P⁻ Hᵀ` where there is an H; n × m.
    pub cross: Matrix,
    /// H, m × n, if the measurement is linear in the state or linearised.
    pub jacobian: Option<Matrix>,
}

impl Default for Expected {
    /// The prediction of zero measurements.
    fn default() -> Self {
        Self { mean: Vector::zeros(0), cov: Matrix::zeros(0, 0), cross: Matrix::zeros(0, 0), jacobian: None }
    }
}

impl Expected {
    /// `S = H P⁻ Hᵀ + R` and `P⁻ Hᵀ`, for readings with this mean and this H.
    pub fn linear(belief: &Gaussian, mean: Vector, jacobian: Matrix, observation: &Observation) -> Self {
        let mut expected = Self { mean, jacobian: Some(jacobian), ..Self::default() };
        expected.follow(belief, observation.measurements());
        expected
    }

    /// Computes S and `P⁻ Hᵀ` from H.
    pub(super) fn follow(&mut self, belief: &Gaussian, measurements: &Measurements) {
        let Self { mean: _, cov, cross, jacobian: Some(jacobian) } = self else { return };
        multiply_sparse(cross, &belief.cov, jacobian);
        let m = jacobian.nrows();
        fit(cov, m, m);
        cov.as_mut_slice().fill(0.0);
        for (k, factors) in jacobian.as_slice().chunks_exact(m).enumerate() {
            for (i, &factor) in factors.iter().enumerate().filter(|(_, factor)| **factor != 0.0) {
                (0..m).for_each(|j| cov[(i, j)] += factor * cross[(k, j)]);
            }
        }
        measurements.add_noise(cov);
    }
}

/// Conditions a Gaussian belief on measurements, given the expected readings, and writes the update to `correction`.
///
/// ```text
/// e = z - h(y⁻),  S = H P⁻ Hᵀ + R,  K = P⁻ Hᵀ S⁻¹,  y = y⁻ + K e
/// P = (I - K H) P⁻ (I - K H)ᵀ + K R Kᵀ,  or P⁻ - K S Kᵀ where there is no H
/// ```
///
/// # Errors
/// [`FilterError::SingularInnovation`], [`FilterError::IndefiniteInnovation`], [`FilterError::IndefiniteCovariance`],
/// [`FilterError::NotFinite`].
///
/// Source: Kalman (1960), A new approach to linear filtering and prediction problems.
pub fn condition(
    belief: &mut Gaussian,
    expected: &Expected,
    observation: &Observation,
    correction: &mut Correction,
) -> Result<(), FilterError> {
    condition_on(belief, expected, observation.measurements(), correction)
}

/// [`condition`] on plain numbers, without the meaning of their sensors.
pub(super) fn condition_on(
    belief: &mut Gaussian,
    expected: &Expected,
    measurements: &Measurements,
    correction: &mut Correction,
) -> Result<(), FilterError> {
    let Expected { mean, cov: expected_cov, cross, jacobian } = expected;
    let Last { innovation, innovation_cov, gain, jacobian: last_jacobian, has_jacobian, factor, excess } =
        &mut correction.last;
    measurements.innovation_into(mean, innovation);
    copy(innovation_cov, expected_cov);
    refactor(factor, innovation_cov)?;
    copy(gain, cross);
    factor.divide_in_place(gain);

    add_product(belief.mean.as_mut_slice(), gain, innovation.as_slice());
    *has_jacobian = jacobian.is_some();
    if let Some(jacobian) = jacobian {
        copy(last_jacobian, jacobian);
        joseph(&mut belief.cov, gain, cross, jacobian, measurements, excess);
    } else {
        multiply(excess, gain, innovation_cov);
        subtract_product(&mut belief.cov, excess, gain);
    }
    belief.cov.fill_upper_triangle_with_lower_triangle();
    belief.check()?;
    correction.report_last(measurements.sensors());
    Ok(())
}

/// Replaces P by `(I - K H) P (I - K H)ᵀ + K R Kᵀ`, which stays positive semidefinite even if sensors are far more
/// precise than the belief; written as two updates of the sensors' rank:
///
/// ```text
/// M = P - K (P Hᵀ)ᵀ,  P⁺ = M - (M Hᵀ - K R) Kᵀ
/// ```
///
/// Source: Bucy and Joseph (1968), *Filtering for Stochastic Processes with Applications to Guidance*.
fn joseph(
    cov: &mut Matrix,
    gain: &Matrix,
    cross: &Matrix,
    jacobian: &Matrix,
    measurements: &Measurements,
    excess: &mut Matrix,
) {
    subtract_product(cov, gain, cross);
    multiply_sparse(excess, cov, jacobian);
    measurements.subtract_noise(excess, gain);
    subtract_product(cov, excess, gain);
}

/// Replaces X by `X - A Bᵀ`, one column of A after the other.
fn subtract_product(x: &mut Matrix, a: &Matrix, b: &Matrix) {
    let n = x.nrows();
    for (a, b) in a.as_slice().chunks_exact(n).zip(b.as_slice().chunks_exact(n)) {
        for (column, b) in x.as_mut_slice().chunks_exact_mut(n).zip(b) {
            for (x, a) in column.iter_mut().zip(a) {
                *x -= a * b;
            }
        }
    }
}

/// The factor of S.
///
/// # Errors
/// [`FilterError::NotFinite`], [`FilterError::SingularInnovation`] and [`FilterError::IndefiniteInnovation`].
pub fn factor(innovation_cov: &Matrix) -> Result<Ldl, FilterError> {
    let mut factor = Ldl::default();
    refactor(&mut factor, innovation_cov)?;
    Ok(factor)
}

/// [`factor`], written over `factor`.
pub(super) fn refactor(factor: &mut Ldl, innovation_cov: &Matrix) -> Result<(), FilterError> {
    if factor.refactor(innovation_cov) {
        return Ok(());
    }
    Err(match lower_root(innovation_cov) {
        Ok(_) => FilterError::SingularInnovation,
        Err(RootError::Indefinite) => FilterError::IndefiniteInnovation,
        Err(RootError::NotFinite) => FilterError::NotFinite,
    })
}
