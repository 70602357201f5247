//! Numbers that were measured at one time, and their noise.

use super::FilterError;
use crate::mathematics::linalg::{Matrix, Vector, fit, fit_vector};

/// m measurements, those of the sensors that measured anything.
#[derive(Clone, Debug)]
pub(super) struct Measurements {
    /// The place of each measurement's sensor among all sensors.
    sensors: Vec<usize>,
    values: Vec<f64>,
    /// The diagonal of R.
    variances: Vec<f64>,
    /// R, if it is not diagonal.
    noise: Option<Matrix>,
}

impl Measurements {
    /// No measurements yet. With `are_correlated`, R may have entries off its diagonal.
    pub(super) fn new(are_correlated: bool) -> Self {
        let noise = are_correlated.then(|| Matrix::zeros(0, 0));
        Self { sensors: Vec::new(), values: Vec::new(), variances: Vec::new(), noise }
    }

    /// Removes all measurements.
    pub(super) fn clear(&mut self) {
        let Self { sensors, values, variances, noise: _ } = self;
        sensors.clear();
        values.clear();
        variances.clear();
    }

    /// Takes in a sample: a number for each sensor, NaN where it is missing, and the variance of each; of the sensors
    /// for which `reads` is true.
    ///
    /// # Errors
    /// [`FilterError::InfiniteMeasurement`]
    pub(super) fn take(
        &mut self,
        measured: &[f64],
        noise: &[f64],
        reads: impl Fn(usize) -> bool,
    ) -> Result<(), FilterError> {
        self.clear();
        let Self { sensors, values, variances, noise: _ } = self;
        for (sensor, (&value, &variance)) in measured.iter().zip(noise).enumerate() {
            if value.is_nan() || !reads(sensor) {
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

    /// Copies the rows and columns of the sensors that measured from the R of all sensors, if R is not diagonal.
    pub(super) fn take_noise(&mut self, all: &Matrix) {
        let Self { sensors, noise: Some(noise), .. } = self else { return };
        fit(noise, sensors.len(), sensors.len());
        for (j, &column) in sensors.iter().enumerate() {
            for (i, &row) in sensors.iter().enumerate() {
                noise[(i, j)] = all[(row, column)];
            }
        }
    }

    /// m
    pub(super) fn len(&self) -> usize {
        self.sensors.len()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.sensors.is_empty()
    }

    pub(super) fn sensors(&self) -> &[usize] {
        &self.sensors
    }

    pub(super) fn values(&self) -> &[f64] {
        &self.values
    }

    pub(super) fn variances(&self) -> &[f64] {
        &self.variances
    }

    /// Adds R to a covariance of the readings, m × m, and makes it symmetric to the last bit, from its lower triangle.
    pub(super) fn add_noise(&self, cov: &mut Matrix) {
        cov.fill_upper_triangle_with_lower_triangle();
        if let Some(noise) = &self.noise {
            *cov += noise;
            return;
        }
        for (row, variance) in self.variances.iter().enumerate() {
            cov[(row, row)] += variance;
        }
    }

    /// Replaces X by `X - K R`, both n × m.
    pub(super) fn subtract_noise(&self, x: &mut Matrix, gain: &Matrix) {
        if let Some(noise) = &self.noise {
            x.gemm(-1.0, gain, noise, 1.0);
            return;
        }
        let n = x.nrows();
        let columns = x.as_mut_slice().chunks_exact_mut(n).zip(gain.as_slice().chunks_exact(n));
        for ((x, gain), variance) in columns.zip(&self.variances) {
            x.iter_mut().zip(gain).for_each(|(x, gain)| *x -= variance * gain);
        }
    }

    /// Writes `e = z - h` to `innovation`, where h is `expected`.
    pub(super) fn innovation_into(&self, expected: &Vector, innovation: &mut Vector) {
        fit_vector(innovation, self.len());
        for ((e, z), h) in innovation.iter_mut().zip(&self.values).zip(expected.iter()) {
            *e = z - h;
        }
    }
}
