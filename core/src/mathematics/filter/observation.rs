//! The measurements of one sample, and the result of an update by them.

use super::FilterError;
use crate::Model;
use crate::mathematics::engine::states::States;
use crate::mathematics::linalg::{Ldl, Matrix, Vector};
use crate::mathematics::model::{Moving, Reading};

/// The m measurements of one sample that are not missing.
#[derive(Clone, Debug)]
pub struct Observation {
    pub(super) readings: Vec<Option<Reading>>,
    /// The place of each measurement's sensor among all sensors.
    pub sensors: Vec<usize>,
    /// z, in the sensors' units.
    pub values: Vec<f64>,
    /// The diagonal of R, in the sensors' units squared.
    pub variances: Vec<f64>,
    /// The recorded force over mass at the sample \[m/s²\].
    pub force: f64,
}

impl Observation {
    pub(super) fn of(readings: Vec<Option<Reading>>) -> Self {
        Self { readings, sensors: Vec::new(), values: Vec::new(), variances: Vec::new(), force: 0.0 }
    }

    /// A number for each sensor, NaN where it is missing, and the variance of each.
    pub(super) fn take(&mut self, new_force: f64, measured: &[f64], noise: &[f64]) -> Result<(), FilterError> {
        let Self { readings, sensors, values, variances, force } = self;
        *force = new_force;
        sensors.clear();
        values.clear();
        variances.clear();
        for (sensor, (&value, &variance)) in measured.iter().zip(noise).enumerate() {
            if value.is_nan() || readings[sensor].is_none() {
                continue;
            }
            if value.is_infinite() {
                return Err(FilterError::InfiniteMeasurement);
            }
            sensors.push(sensor);
            values.push(value);
            variances.push(variance);
        }
        Ok(())
    }

    /// m, the number of measurements.
    pub fn len(&self) -> usize {
        self.sensors.len()
    }

    /// Whether nothing was measured.
    pub fn is_empty(&self) -> bool {
        self.sensors.is_empty()
    }

    fn readings(&self) -> impl Iterator<Item = &Reading> + Clone {
        self.sensors.iter().filter_map(|&sensor| self.readings[sensor].as_ref())
    }

    /// `h(y, f)`, the m numbers that the sensors would read in a state.
    pub fn read(&self, model: &Model, state: &[f64]) -> Vector {
        let has_rates = self.readings().any(Reading::is_of_rates);
        let rate = if has_rates { model.rate(state, self.force) } else { Vector::zeros(0) };
        let readings = self.readings().map(|reading| model.read_moving(reading, state, rate.as_slice(), self.force));
        Vector::from_iterator(self.len(), readings)
    }

    /// The numbers that the sensors would read in several states, each a column; m rows.
    pub(super) fn read_all(&self, engine: &mut States, states: &Matrix) -> Matrix {
        let mut values = Matrix::zeros(self.len(), states.ncols());
        engine.read(states.as_slice(), self.force, &self.readings(), values.as_mut_slice());
        values
    }

    /// `H = ∂h/∂y`, m × n, in a state.
    pub fn jacobian(&self, model: &Model, state: &[f64]) -> Matrix {
        let (mut rate, mut rates) = (Vector::zeros(0), Matrix::zeros(0, 0));
        if self.readings().any(Reading::is_of_rates) {
            (rate, rates) = (model.rate(state, self.force), model.jacobian(state, self.force));
        }
        let at = Moving { state, rate: rate.as_slice(), jacobian: &rates };
        let mut jacobian = Matrix::zeros(self.len(), model.size());
        for (row, reading) in self.readings().enumerate() {
            model.read_gradient_into(reading, at, self.force, |place, part| jacobian[(row, place)] += part);
        }
        jacobian
    }

    /// Adds R to a covariance of the readings, m × m, and makes it symmetric to the last bit, from its lower triangle.
    pub fn add_noise(&self, cov: &mut Matrix) {
        cov.fill_upper_triangle_with_lower_triangle();
        for (row, variance) in self.variances.iter().enumerate() {
            cov[(row, row)] += variance;
        }
    }

    /// The innovation `e = z - h`, where h is `expected`.
    pub fn innovation(&self, expected: &Vector) -> Vector {
        Vector::from_fn(self.len(), |row, _| self.values[row] - expected[row])
    }
}

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
        sensors: &[usize],
        innovation: &Vector,
        innovation_cov: &Matrix,
        factor: &Ldl,
        gain: &Matrix,
    ) {
        self.nis = factor.square(innovation);
        self.determinant = factor.determinant;
        for (i, &row) in sensors.iter().enumerate() {
            self.innovation[row] = innovation[i];
            self.gain.set_column(row, &gain.column(i));
            for (j, &column) in sensors.iter().enumerate() {
                self.innovation_cov[(row, column)] = innovation_cov[(i, j)];
            }
        }
    }

    /// Fails where their likelihood is not finite, with [`FilterError::NotFinite`] if the belief is the reason.
    pub(super) fn check(&self, sensors: &[usize]) -> Result<(), FilterError> {
        // A factor of S has a finite ln det S.
        if self.nis.is_finite() && !self.log_likelihood.is_infinite() {
            return Ok(());
        }
        let surprising = sensors.iter().all(|&sensor| self.innovation[sensor].is_finite());
        Err(if surprising { FilterError::ImpossibleMeasurement } else { FilterError::NotFinite })
    }
}
