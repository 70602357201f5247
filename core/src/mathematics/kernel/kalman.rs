//! The update of a Gaussian belief, for linearised and sigma-point predictions of the measurement alike.

use super::observation::{Active, Observation};
use super::{Correction, FilterError, Noise};
use crate::mathematics::kernel::gaussian::{Factor, Gaussian, Matrix, Vector, lower_root, minus_product, mirrored};

/// The prediction of M measurements from a belief.
pub(super) struct Expected<const N: usize, const M: usize> {
    pub(super) mean: Vector<M>,
    /// S, noise included.
    pub(super) cov: Matrix<M, M>,
    /// Covariance of state and measurement.
    pub(super) cross: Matrix<N, M>,
    pub(super) view: View<N, M>,
}

/// The dependence of measurements on the state.
pub(super) enum View<const N: usize, const M: usize> {
    /// Linear, or linearised: H.
    Linear(Matrix<M, N>),
    /// Not linear.
    Curved,
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
    let Expected { mean, cov: innovation_cov, cross, view } = expected;
    let innovation = observation.values - mean;
    let factor = factor(innovation_cov, observation.count())?;
    let gain = factor.divide(cross);

    belief.mean += gain * innovation;
    belief.cov = match view {
        View::Linear(jacobian) => joseph(&belief.cov, &gain, cross, observation, |x| x * jacobian.transpose()),
        View::Curved => mirrored(minus_product(belief.cov, &(gain * innovation_cov), &gain)),
    };
    check(belief)?;
    report(observation.measured(), &innovation, innovation_cov, &factor, &gain, correction);
    Ok(())
}

/// [`condition`] on sensors that read components of the state: H selects entries, so that no product with H is needed.
/// One function, so that the expected readings need not be stored in between.
///
/// # Errors
/// Those of [`condition`].
#[inline(never)]
pub(super) fn condition_on_components<const N: usize, const M: usize>(
    belief: &mut Gaussian<N>,
    components: [usize; M],
    observation: &Observation<M>,
    correction: &mut Correction<N>,
) -> Result<(), FilterError> {
    let mut cross = Matrix::<N, M>::zeros();
    let mut seen = Matrix::<M, M>::zeros();
    let mut innovation = observation.values;
    let components = &components[..observation.count()];
    for (row, &i) in components.iter().enumerate() {
        innovation[row] -= belief.mean[i];
        // Reads a row, not the equal column: single reads need not wait for writes of pairs.
        for k in 0..N {
            cross[(k, row)] = belief.cov[(i, k)];
        }
        for (column, &j) in components.iter().enumerate() {
            seen[(row, column)] = belief.cov[(i, j)];
        }
    }
    let mut innovation_cov = seen;
    observation.add_noise(&mut innovation_cov);
    let factor = factor(&innovation_cov, observation.count())?;
    let gain = factor.divide(&cross);

    belief.mean += gain * innovation;
    // Computes the selected columns of `P - K (P Hᵀ)ᵀ` again: that is faster than fetching them.
    belief.cov = joseph(&belief.cov, &gain, &cross, observation, |_| minus_product(cross, &gain, &seen));
    check(belief)?;
    report(observation.measured(), &innovation, &innovation_cov, &factor, &gain, correction);
    Ok(())
}

/// Checks that the numbers of a belief are valid.
///
/// # Errors
/// [`FilterError::NotFinite`] and [`FilterError::IndefiniteCovariance`].
#[inline]
pub(super) fn check<const N: usize>(belief: &Gaussian<N>) -> Result<(), FilterError> {
    if !belief.is_finite() {
        return Err(FilterError::NotFinite);
    }
    if belief.has_negative_variance() {
        return Err(FilterError::IndefiniteCovariance);
    }
    Ok(())
}

/// The factor of S. Its first `count` rows belong to measurements.
///
/// # Errors
/// [`FilterError::NotFinite`], [`FilterError::SingularInnovation`] and [`FilterError::IndefiniteInnovation`].
#[inline]
pub(super) fn factor<const M: usize>(innovation_cov: &Matrix<M, M>, count: usize) -> Result<Factor<M>, FilterError> {
    Factor::padded(innovation_cov, count).ok_or_else(|| why_no_factor(innovation_cov))
}

#[cold]
fn why_no_factor<const M: usize>(innovation_cov: &Matrix<M, M>) -> FilterError {
    match lower_root(innovation_cov) {
        Ok(_) => FilterError::SingularInnovation,
        Err(FilterError::IndefiniteCovariance) => FilterError::IndefiniteInnovation,
        Err(error) => error,
    }
}

/// Writes the result of an update to `correction`, each sensor in its place.
#[inline]
pub(super) fn report<const N: usize, const M: usize>(
    measured: &[Active],
    innovation: &Vector<M>,
    innovation_cov: &Matrix<M, M>,
    factor: &Factor<M>,
    gain: &Matrix<N, M>,
    correction: &mut Correction<N>,
) {
    correction.nis = factor.square(innovation);
    correction.determinant = factor.determinant();
    for (i, row) in measured.iter().enumerate() {
        correction.innovation[row.sensor] = innovation[i];
        correction.gain[row.sensor] = gain.column(i).into();
        for (j, column) in measured.iter().enumerate() {
            correction.innovation_cov[row.sensor][column.sensor] = innovation_cov[(i, j)];
        }
    }
}

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
    observation: &Observation<M>,
    seen: impl Fn(&Matrix<N, N>) -> Matrix<N, M>,
) -> Matrix<N, N> {
    let kept = minus_product(*cov, gain, cross);
    let mut excess = seen(&kept);
    for (k, sensor) in observation.active.iter().enumerate() {
        for i in 0..N {
            excess[(i, k)] -= gain[(i, k)] * sensor.variance;
        }
    }
    mirrored(minus_product(kept, &excess, gain))
}

/// `λ P + Q` of a covariance with at least its lower triangle; a variance that rounding made negative becomes zero.
#[inline(always)]
pub(super) fn spread<const N: usize>(mut cov: Matrix<N, N>, noise: &Noise<N>) -> Matrix<N, N> {
    for j in 0..N {
        for i in j..N {
            cov[(i, j)] = cov[(i, j)] * noise.fading + noise.process[(i, j)];
        }
        if cov[(j, j)] < 0.0 {
            cov[(j, j)] = 0.0;
        }
    }
    mirrored(cov)
}
