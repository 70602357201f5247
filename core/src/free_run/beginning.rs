//! The motion at the beginning of a free run, fitted to the first readings by Gauss and Newton.

use std::ops::Range;

use super::Identified;
use super::course::Course;
use crate::Record;
use crate::linalg::{Matrix, Vector};
use crate::model::Reading;

/// The readings from which the motion at the beginning is fitted.
const BEGINNING: usize = 50;

/// Limits the iterations of the fit; for a linear plant the first is exact.
const ITERATIONS: usize = 8;

/// A fit under way.
pub(super) struct Beginning {
    /// The samples with the readings.
    pub(super) part: Range<usize>,
    /// A size of each sensor's readings, so that those of all sensors count alike.
    scales: Vec<f64>,
    /// The motion at the first sample so far.
    pub(super) motion: Vec<f64>,
    /// The number of readings.
    rows: usize,
    error: Vector,
    /// The changes of the error with each component of the motion, as far as this iteration has come.
    columns: Vec<Vector>,
    iterations: usize,
}

impl Beginning {
    /// The fit to the first samples of `part`, before its first iteration.
    pub(super) fn new(
        identified: &Identified,
        record: &Record,
        part: &Range<usize>,
        readings: &[Option<Reading>],
    ) -> Self {
        let part = beginning(record, part, readings);
        let scales = (0..readings.len()).map(|sensor| scale(&record.measured(sensor)[part.clone()])).collect();
        let motion = vec![0.0; identified.model.motion()];
        let there = |sensor: usize| part.clone().filter(move |&k| has(record, readings, k, sensor)).count();
        let rows = (0..readings.len()).map(there).sum();
        let mut fit = Self { part, scales, motion, rows, error: Vector::zeros(0), columns: Vec::new(), iterations: 0 };
        fit.error = fit.error_of(&fit.motion, identified, record, readings);
        fit
    }

    /// Makes a piece of an iteration. Returns whether the fit is done.
    pub(super) fn advance(&mut self, identified: &Identified, record: &Record, readings: &[Option<Reading>]) -> bool {
        // Without readings there is nothing to fit.
        if self.error.is_empty() || self.motion.is_empty() {
            return true;
        }
        let error_of = |motion: &[f64]| self.error_of(motion, identified, record, readings);
        let place = self.columns.len();
        if place < self.motion.len() {
            let step = 1e-6 * (1e-3 + self.motion[place].abs());
            let mut moved = self.motion.clone();
            moved[place] += step;
            let column = (&self.error - error_of(&moved)) / step;
            self.columns.push(column);
            return false;
        }
        let jacobian = Matrix::from_columns(&self.columns);
        // The decomposition has no answer to numbers that are not finite, or whose squares are not.
        if !jacobian.norm_squared().is_finite() || !self.error.norm_squared().is_finite() {
            return true;
        }
        // Directions that the readings do not show stay as they are.
        let svd = jacobian.svd(true, true);
        let least = 1e-9 * svd.singular_values.max();
        let Ok(change) = svd.solve(&self.error, least.max(f64::MIN_POSITIVE)) else { return true };
        let moved: Vec<f64> = self.motion.iter().zip(change.iter()).map(|(value, change)| value + change).collect();
        let after = error_of(&moved);
        // A motion that runs away has no error that is a number.
        if after.norm_squared().is_nan() || after.norm_squared() >= self.error.norm_squared() {
            return true;
        }
        let is_settled = after.norm_squared() > (1.0 - 1e-9) * self.error.norm_squared();
        (self.motion, self.error) = (moved, after);
        self.columns.clear();
        self.iterations += 1;
        is_settled || self.iterations >= ITERATIONS
    }

    /// The errors of all readings with a motion at the first sample, relative to the readings' size.
    fn error_of(
        &self,
        motion: &[f64],
        identified: &Identified,
        record: &Record,
        readings: &[Option<Reading>],
    ) -> Vector {
        let mut errors = Vec::with_capacity(self.rows);
        let mut course = Course::new(identified, motion);
        for k in self.part.clone() {
            let Some(state) = course.state() else { break };
            for (sensor, reading) in readings.iter().enumerate().filter(|(sensor, _)| has(record, readings, k, *sensor))
            {
                let error = record.measured(sensor)[k] - identified.read(reading.as_ref(), state, record, k);
                errors.push(if error.is_nan() { 0.0 } else { error / self.scales[sensor] });
            }
            course.advance(identified, record, k);
        }
        errors.resize(self.rows, 0.0);
        Vector::from_vec(errors)
    }
}

/// Whether a sensor has read something that the model knows at sample `k`.
fn has(record: &Record, readings: &[Option<Reading>], k: usize, sensor: usize) -> bool {
    readings[sensor].is_some() && !record.measured(sensor)[k].is_nan()
}

/// The first samples, which have [`BEGINNING`] readings, but not more than half of the part.
fn beginning(record: &Record, part: &Range<usize>, readings: &[Option<Reading>]) -> Range<usize> {
    let mut count = 0;
    let end = part.clone().find(|&k| {
        count += (0..readings.len()).filter(|&sensor| has(record, readings, k, sensor)).count();
        count >= BEGINNING
    });
    part.start..end.map_or(part.end, |end| end + 1).min(part.start + part.len() / 2)
}

/// The root mean square of the readings that are there, or 1.
fn scale(measured: &[f64]) -> f64 {
    let values = measured.iter().filter(|value| !value.is_nan());
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value * value, count + 1.0));
    let rms = libm::sqrt(sum / f64::max(count, 1.0));
    if rms > 0.0 { rms } else { 1.0 }
}
