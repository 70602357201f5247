//! The measurements of one sample.

use super::FilterError;
use crate::Model;
use crate::mathematics::engine::states::States;
use crate::mathematics::linalg::{Matrix, Vector, fit};
use crate::mathematics::model::{Moving, Reading};

/// The m measurements of one sample that are not missing.
#[derive(Clone, Debug)]
pub struct Observation {
    /// The readings of all sensors, with and without a measurement.
    readings: Vec<Option<Reading>>,
    /// The place of each measurement's sensor among all sensors.
    sensors: Vec<usize>,
    values: Vec<f64>,
    /// The diagonal of R.
    variances: Vec<f64>,
    force: f64,
}

impl Observation {
    /// No measurement yet, of sensors with these readings.
    pub(super) fn of(readings: Vec<Option<Reading>>) -> Self {
        Self { readings, sensors: Vec::new(), values: Vec::new(), variances: Vec::new(), force: 0.0 }
    }

    /// Takes in a sample: a number for each sensor, NaN where it is missing, and the variance of each.
    ///
    /// # Errors
    /// [`FilterError::InfiniteMeasurement`]
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

    /// The place of each measurement's sensor among all sensors.
    pub fn sensors(&self) -> &[usize] {
        &self.sensors
    }

    /// The number of all sensors, including those without a measurement.
    pub fn all_sensors(&self) -> usize {
        self.readings.len()
    }

    /// z, in the sensors' units.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The diagonal of R, in the sensors' units squared.
    pub fn variances(&self) -> &[f64] {
        &self.variances
    }

    /// The recorded force over mass at the sample \[m/s²\].
    pub fn force(&self) -> f64 {
        self.force
    }

    fn readings(&self) -> impl Iterator<Item = &Reading> + Clone {
        self.sensors().iter().filter_map(|&sensor| self.readings[sensor].as_ref())
    }

    /// Whether every sensor is linear in the state, whatever the plant.
    pub fn is_linear(&self) -> bool {
        self.readings().all(Reading::is_of_components)
    }

    /// `h(y, f)`, the m numbers that the sensors would read in a state.
    pub fn read(&self, model: &Model, state: &[f64]) -> Vector {
        let mut values = Vector::zeros(self.len());
        self.read_into(model, state, &mut Vec::new(), values.as_mut_slice());
        values
    }

    /// The numbers that the sensors would read in several states, each a column; m rows.
    pub(super) fn read_all(&self, engine: &mut States, states: &Matrix) -> Matrix {
        let mut values = Matrix::zeros(self.len(), states.ncols());
        engine.read(states.as_slice(), self.force, &self.readings(), values.as_mut_slice());
        values
    }

    /// [`Self::read`] of several states, each a column, written over `values`; `rate` is scratch memory.
    pub fn read_all_into(&self, model: &Model, states: &Matrix, rate: &mut Vec<f64>, values: &mut Matrix) {
        fit(values, self.len(), states.ncols());
        let columns = values.as_mut_slice().chunks_exact_mut(self.len());
        for (state, values) in states.as_slice().chunks_exact(model.size()).zip(columns) {
            self.read_into(model, state, rate, values);
        }
    }

    /// [`Self::read`], written over `values`; `rate` is scratch memory.
    pub fn read_into(&self, model: &Model, state: &[f64], rate: &mut Vec<f64>, values: &mut [f64]) {
        if self.readings().any(Reading::is_of_rates) {
            rate.resize(model.size(), 0.0);
            model.rate_into(state, self.force, rate);
        }
        for (value, reading) in values.iter_mut().zip(self.readings()) {
            *value = model.read_moving(reading, state, rate, self.force);
        }
    }

    /// `H = ∂h/∂y`, m × n, in a state.
    pub fn jacobian(&self, model: &Model, state: &[f64]) -> Matrix {
        let mut jacobian = Matrix::zeros(0, 0);
        self.jacobian_into(model, state, &mut Vec::new(), &mut Matrix::zeros(0, 0), &mut jacobian);
        jacobian
    }

    /// [`Self::jacobian`], written over `jacobian`; `rows` and `rates` are scratch memory.
    pub fn jacobian_into(
        &self,
        model: &Model,
        state: &[f64],
        rows: &mut Vec<f64>,
        rates: &mut Matrix,
        jacobian: &mut Matrix,
    ) {
        let mut rate = Vec::new();
        if self.readings().any(Reading::is_of_rates) {
            model.jacobian_into(state, self.force, rows, rates);
            rate.resize(model.size(), 0.0);
            model.rate_into(state, self.force, &mut rate);
        }
        let at = Moving { state, rate: &rate, jacobian: rates };
        fit(jacobian, self.len(), model.size());
        jacobian.as_mut_slice().fill(0.0);
        for (row, reading) in self.readings().enumerate() {
            model.read_gradient_into(reading, at, self.force, |place, part| jacobian[(row, place)] += part);
        }
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
