//! The update of a Gaussian belief, for linearised and sigma-point predictions of the measurement alike.

use super::{Correction, FilterError, Gaussian, Observation};
use crate::linalg::{Ldl, Matrix, Vector, lower_root, symmetric};

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

impl Expected {
    /// `S = H P⁻ Hᵀ + R` and `P⁻ Hᵀ`, for readings with this mean and this H.
    pub fn linear(belief: &Gaussian, mean: Vector, jacobian: Matrix, observation: &Observation) -> Self {
        Self::with_noise(belief, mean, jacobian, &Matrix::from_diagonal(&observation.variances.to_vec().into()))
    }

    pub(super) fn with_noise(belief: &Gaussian, mean: Vector, jacobian: Matrix, noise: &Matrix) -> Self {
        let cross = &belief.cov * jacobian.transpose();
        let cov = symmetric(&jacobian * &cross) + noise;
        Self { mean, cov, cross, jacobian: Some(jacobian) }
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
    let innovation = observation.innovation(&expected.mean);
    let noise = Matrix::from_diagonal(&observation.variances.to_vec().into());
    let (factor, gain) = update(belief, expected, &innovation, &noise)?;
    correction.report(&observation.sensors, &innovation, &expected.cov, &factor, &gain);
    Ok(())
}

/// `noise` is R, m × m. Returns the factor of S, and K.
pub(super) fn update(
    belief: &mut Gaussian,
    Expected { cov, cross, jacobian, .. }: &Expected,
    innovation: &Vector,
    noise: &Matrix,
) -> Result<(Ldl, Matrix), FilterError> {
    let factor = factor(cov)?;
    let gain = factor.divide(cross);
    belief.mean += &gain * innovation;
    belief.cov = symmetric(match jacobian {
        Some(jacobian) => {
            let kept = Matrix::identity(belief.size(), belief.size()) - &gain * jacobian;
            &kept * &belief.cov * kept.transpose() + &gain * noise * gain.transpose()
        }
        None => &belief.cov - &gain * cov * gain.transpose(),
    });
    belief.check()?;
    Ok((factor, gain))
}

/// The factor of S.
///
/// # Errors
/// [`FilterError::NotFinite`], [`FilterError::SingularInnovation`] and [`FilterError::IndefiniteInnovation`].
pub fn factor(innovation_cov: &Matrix) -> Result<Ldl, FilterError> {
    Ldl::new(innovation_cov).ok_or_else(|| match lower_root(innovation_cov) {
        Ok(_) => FilterError::SingularInnovation,
        Err(FilterError::IndefiniteCovariance) => FilterError::IndefiniteInnovation,
        Err(error) => error,
    })
}
