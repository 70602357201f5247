//! The update of a Gaussian belief, whichever way the measurement was expected.

use super::{Correction, FilterError, Observation};
use crate::gaussian::{Factor, Gaussian, Matrix, Vector, lower_root, symmetric};
use crate::model::Output;

/// What a belief says of M measurements before they are seen.
pub(super) struct Expected<const N: usize, const M: usize> {
    pub(super) mean: Vector<M>,
    /// S, noise included.
    pub(super) cov: Matrix<M, M>,
    /// Covariance of state and measurement.
    pub(super) cross: Matrix<N, M>,
    /// H, where the measurements are linear in the state or taken to be.
    pub(super) jacobian: Option<Matrix<M, N>>,
}

/// Conditions a Gaussian belief on a measurement.
///
/// ```text
/// e = z - h(y⁻),  S = H P⁻ Hᵀ + R,  K = P⁻ Hᵀ S⁻¹,  y = y⁻ + K e
/// ```
///
/// # Errors
/// [`FilterError::SingularInnovation`], [`FilterError::IndefiniteInnovation`], [`FilterError::IndefiniteCovariance`],
/// [`FilterError::NotFinite`].
///
/// Source: Kalman (1960), A new approach to linear filtering and prediction problems.
#[inline]
pub(super) fn condition<const N: usize, const M: usize>(
    belief: &mut Gaussian<N>,
    expected: &Expected<N, M>,
    observation: &Observation<M>,
    correction: &mut Correction<N>,
) -> Result<(), FilterError> {
    let Expected { mean, cov: innovation_cov, cross, jacobian } = expected;
    let innovation = observation.values - mean;
    let factor = factor(innovation_cov)?;
    let gain = factor.divide(cross);

    belief.mean += gain * innovation;
    belief.cov = match jacobian {
        Some(jacobian) => joseph(&belief.cov, &gain, cross, jacobian, observation),
        None => symmetric(&(belief.cov - gain * innovation_cov * gain.transpose())),
    };
    check(belief)?;
    report(observation, &innovation, innovation_cov, &factor, &gain, correction);
    Ok(())
}

/// Whether a belief can be one.
///
/// # Errors
/// [`FilterError::NotFinite`] and [`FilterError::IndefiniteCovariance`].
#[inline]
pub(super) fn check<const N: usize>(belief: &Gaussian<N>) -> Result<(), FilterError> {
    if !belief.is_finite() {
        return Err(FilterError::NotFinite);
    }
    if belief.cov.diagonal().min() < 0.0 {
        return Err(FilterError::IndefiniteCovariance);
    }
    Ok(())
}

/// The factor of S.
///
/// # Errors
/// [`FilterError::NotFinite`], [`FilterError::SingularInnovation`] and [`FilterError::IndefiniteInnovation`].
#[inline]
pub(super) fn factor<const M: usize>(innovation_cov: &Matrix<M, M>) -> Result<Factor<M>, FilterError> {
    Factor::new(innovation_cov).ok_or_else(|| why_no_factor(innovation_cov))
}

#[cold]
fn why_no_factor<const M: usize>(innovation_cov: &Matrix<M, M>) -> FilterError {
    match lower_root(innovation_cov) {
        Ok(_) => FilterError::SingularInnovation,
        Err(FilterError::IndefiniteCovariance) => FilterError::IndefiniteInnovation,
        Err(error) => error,
    }
}

/// Writes down what a measurement told, each sensor in its place.
#[inline]
pub(super) fn report<const N: usize, const M: usize>(
    observation: &Observation<M>,
    innovation: &Vector<M>,
    innovation_cov: &Matrix<M, M>,
    factor: &Factor<M>,
    gain: &Matrix<N, M>,
    correction: &mut Correction<N>,
) {
    let nis = factor.square(innovation);
    correction.nis = nis;
    correction.log_likelihood = -0.5 * (nis + factor.ln_determinant() + M as f64 * LN_2_PI);
    for (i, row) in observation.active.iter().enumerate() {
        correction.innovation[row.sensor] = innovation[i];
        correction.gain[row.sensor] = gain.column(i).into();
        for (j, column) in observation.active.iter().enumerate() {
            correction.innovation_cov[row.sensor][column.sensor] = innovation_cov[(i, j)];
        }
    }
}

/// ln 2π
const LN_2_PI: f64 = 1.837_877_066_409_345_5;

/// `(I - K H) P (I - K H)ᵀ + K R Kᵀ`, which keeps P positive semidefinite where sensors are far more precise than the
/// belief; written as two updates of the sensors' rank:
///
/// ```text
/// M = P - K (P Hᵀ)ᵀ,  P⁺ = M - (M Hᵀ - K R) Kᵀ
/// ```
///
/// Source: Bucy and Joseph (1968), *Filtering for Stochastic Processes with Applications to Guidance*.
#[inline]
fn joseph<const N: usize, const M: usize>(
    cov: &Matrix<N, N>,
    gain: &Matrix<N, M>,
    cross: &Matrix<N, M>,
    jacobian: &Matrix<M, N>,
    observation: &Observation<M>,
) -> Matrix<N, N> {
    let kept = cov - gain * cross.transpose();
    let mut excess = seen_by(&kept, jacobian, observation);
    for (k, sensor) in observation.active.iter().enumerate() {
        for i in 0..N {
            excess[(i, k)] -= gain[(i, k)] * sensor.variance;
        }
    }
    symmetric(&(kept - excess * gain.transpose()))
}

/// `X Hᵀ`, which for sensors that read a component of the state only picks columns.
#[inline]
pub(super) fn seen_by<const N: usize, const M: usize, const R: usize>(
    x: &Matrix<R, N>,
    jacobian: &Matrix<M, N>,
    observation: &Observation<M>,
) -> Matrix<R, M> {
    let mut result = Matrix::<R, M>::zeros();
    for (row, sensor) in observation.active.iter().enumerate() {
        match sensor.output {
            Output::State(i) => result.set_column(row, &x.column(i)),
            Output::Rate(_) => result.set_column(row, &(x * jacobian.row(row).transpose())),
        }
    }
    result
}

/// `P ← λ P + Q`; a variance that is zero but for rounding may have come out on the wrong side.
#[inline]
pub(super) fn spread<const N: usize>(cov: &mut Matrix<N, N>, fading: f64, process: &Matrix<N, N>) {
    *cov = *cov * fading + process;
    if cov.diagonal().min() < 0.0 {
        for i in 0..N {
            cov[(i, i)] = cov[(i, i)].max(0.0);
        }
    }
}
