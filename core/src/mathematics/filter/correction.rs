//! The result of an update.

use super::{FilterError, Observation};
use crate::mathematics::linalg::{Ldl, Matrix, Vector};

/// The effect of one sample of the sensors on the belief, with n channels and m sensors. Sensors that were skipped have an innovation
/// of NaN and no gain.
#[derive(Clone, Debug)]
pub struct Correction {
    /// e = z - h(y⁻), m numbers in the sensors' units.
    pub innovation: Vector,
    /// S, the covariance of e, m × m.
    pub innovation_cov: Matrix,
    /// K, n × m. The column of a sensor is the change of each channel per unit of its innovation.
    pub gain: Matrix,
    /// Normalised innovation squared `eᵀ S⁻¹ e`.
    pub nis: f64,
    /// det S over the sensors that were not skipped; zero or infinite if it leaves the range of numbers.
    pub determinant: f64,
    /// For a particle filter, the logarithm of the mean likelihood of its particles. NaN for any other filter: there it
    /// follows from NIS and det S.
    pub log_likelihood: f64,
    /// Effective sample size of a particle filter before it resampled; NaN for any other.
    pub effective_samples: f64,
}

impl Correction {
    /// The correction of n channels by m sensors that all measured nothing.
    pub fn nothing(n: usize, m: usize) -> Self {
        let nan = f64::NAN;
        Self {
            innovation: Vector::repeat(m, nan),
            innovation_cov: Matrix::repeat(m, m, nan),
            gain: Matrix::zeros(n, m),
            nis: nan,
            determinant: nan,
            log_likelihood: nan,
            effective_samples: nan,
        }
    }

    /// Takes in e, S with its factor, and K of the sensors that measured; each number goes to the place of its sensor.
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

    /// Checks that the measurements of these sensors have a finite likelihood.
    ///
    /// # Errors
    /// [`FilterError::ImpossibleMeasurement`], and [`FilterError::NotFinite`] if the belief is the reason.
    pub(super) fn check(&self, sensors: &[usize]) -> Result<(), FilterError> {
        // A factor of S has a finite ln det S.
        if self.nis.is_finite() && !self.log_likelihood.is_infinite() {
            return Ok(());
        }
        let surprising = sensors.iter().all(|&sensor| self.innovation[sensor].is_finite());
        Err(if surprising { FilterError::ImpossibleMeasurement } else { FilterError::NotFinite })
    }
}
