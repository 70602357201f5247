//! The update of a Gaussian belief, in whichever way the measurement was expected.

use super::{FilterError, Gaussian, Observation};
use crate::linalg::{Ldl, Matrix, RootError, Vector, lower_root};

/// What a belief says of m measurements before they are seen.
#[derive(Clone, Debug)]
pub struct Expected {
    /// h(y⁻), m numbers.
    pub mean: Vector,
    /// S, noise included, m × m.
    pub cov: Matrix,
    /// The covariance of state and measurement, `P⁻ Hᵀ` where there is an H; n × m.
    pub cross: Matrix,
    /// H, m × n, where the measurement is linear in the state or taken to be.
    pub jacobian: Option<Matrix>,
}

impl Expected {
    /// `S = H P⁻ Hᵀ + R` and `P⁻ Hᵀ`, where the readings have this mean and this H.
    pub fn linear(belief: &Gaussian, mean: Vector, jacobian: Matrix, observation: &Observation) -> Self {
        let cross = &belief.cov * jacobian.transpose();
        let mut cov = &jacobian * &cross;
        observation.add_noise(&mut cov);
        Self { mean, cov, cross, jacobian: Some(jacobian) }
    }
}

/// What one sample of the sensors told, n channels and m sensors. Sensors that were skipped have an innovation of NaN and no
/// gain.
#[derive(Clone, Debug)]
pub struct Correction {
    /// e = z - h(y⁻), m numbers in the sensors' units.
    pub innovation: Vector,
    /// S, the covariance of e, m × m.
    pub innovation_cov: Matrix,
    /// K, n × m: in the column of each sensor what a unit of innovation adds to each channel.
    pub gain: Matrix,
    /// Normalised innovation squared `eᵀ S⁻¹ e`.
    pub nis: f64,
    /// det S over the sensors that were not skipped; zero or infinite where it leaves the range of numbers.
    pub determinant: f64,
    /// Of a particle filter, the logarithm of the mean likelihood of its particles; NaN for any other, where it follows
    /// from NIS and det S.
    pub log_likelihood: f64,
    /// Effective sample size of a particle filter before it resampled; NaN for any other.
    pub effective_samples: f64,
}

impl Default for Correction {
    /// The correction by no sensor at all.
    fn default() -> Self {
        Self::nothing(0, 0)
    }
}

impl Correction {
    /// The correction of n channels by m sensors that all measured nothing.
    pub fn nothing(n: usize, m: usize) -> Self {
        Self {
            innovation: Vector::repeat(m, f64::NAN),
            innovation_cov: Matrix::repeat(m, m, f64::NAN),
            gain: Matrix::zeros(n, m),
            nis: f64::NAN,
            determinant: f64::NAN,
            log_likelihood: f64::NAN,
            effective_samples: f64::NAN,
        }
    }

    /// Makes it [`Self::nothing`], in the same memory where the sizes are the same.
    pub(super) fn clear(&mut self, n: usize, m: usize) {
        if self.gain.shape() != (n, m) {
            *self = Self::nothing(n, m);
            return;
        }
        let Self { innovation, innovation_cov, gain, nis, determinant, log_likelihood, effective_samples } = self;
        innovation.fill(f64::NAN);
        innovation_cov.fill(f64::NAN);
        gain.fill(0.0);
        for number in [nis, determinant, log_likelihood, effective_samples] {
            *number = f64::NAN;
        }
    }

    /// Writes down e, S with its factor, and K, of which there are those of the sensors that measured, each in its place.
    pub fn report(
        &mut self,
        observation: &Observation,
        innovation: &Vector,
        innovation_cov: &Matrix,
        factor: &Ldl,
        gain: &Matrix,
    ) {
        self.nis = factor.square(innovation);
        self.determinant = factor.determinant();
        for (i, &row) in observation.sensors().iter().enumerate() {
            self.innovation[row] = innovation[i];
            self.gain.set_column(row, &gain.column(i));
            for (j, &column) in observation.sensors().iter().enumerate() {
                self.innovation_cov[(row, column)] = innovation_cov[(i, j)];
            }
        }
    }
}

/// Conditions a Gaussian belief on measurements, of which it expects this much, and reports in `correction` how.
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
    let Expected { mean, cov: innovation_cov, cross, jacobian } = expected;
    let innovation = observation.innovation(mean);
    let factor = factor(innovation_cov)?;
    let gain = factor.divide(cross);

    belief.mean.gemv(1.0, &gain, &innovation, 1.0);
    match jacobian {
        Some(jacobian) => joseph(&mut belief.cov, &gain, cross, jacobian, observation.variances()),
        None => subtract_product(&mut belief.cov, &(&gain * innovation_cov), &gain),
    }
    belief.cov.fill_upper_triangle_with_lower_triangle();
    belief.check()?;
    correction.report(observation, &innovation, innovation_cov, &factor, &gain);
    Ok(())
}

/// Makes of P the covariance `(I - K H) P (I - K H)ᵀ + K R Kᵀ`, which stays positive semidefinite where sensors are far
/// more precise than the belief; written as two updates of the sensors' rank:
///
/// ```text
/// M = P - K (P Hᵀ)ᵀ,  P⁺ = M - (M Hᵀ - K R) Kᵀ
/// ```
///
/// Source: Bucy and Joseph (1968), *Filtering for Stochastic Processes with Applications to Guidance*.
fn joseph(cov: &mut Matrix, gain: &Matrix, cross: &Matrix, jacobian: &Matrix, variances: &[f64]) {
    subtract_product(cov, gain, cross);
    let mut excess = &*cov * jacobian.transpose();
    for (k, &variance) in variances.iter().enumerate() {
        excess.column_mut(k).axpy(-variance, &gain.column(k), 1.0);
    }
    subtract_product(cov, &excess, gain);
}

/// Makes of X the matrix `X - A Bᵀ`, one column of A after the other.
fn subtract_product(x: &mut Matrix, a: &Matrix, b: &Matrix) {
    for k in 0..a.ncols() {
        x.ger(-1.0, &a.column(k), &b.column(k), 1.0);
    }
}

/// The factor of S.
///
/// # Errors
/// [`FilterError::NotFinite`], [`FilterError::SingularInnovation`] and [`FilterError::IndefiniteInnovation`].
pub fn factor(innovation_cov: &Matrix) -> Result<Ldl, FilterError> {
    Ldl::new(innovation_cov).ok_or_else(|| match lower_root(innovation_cov) {
        Ok(_) => FilterError::SingularInnovation,
        Err(RootError::Indefinite) => FilterError::IndefiniteInnovation,
        Err(RootError::NotFinite) => FilterError::NotFinite,
    })
}
