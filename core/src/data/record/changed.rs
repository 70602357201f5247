//! Records made of others: other readings or inputs, a part.

use std::sync::Arc;

use super::Record;
use crate::Hold;

impl Record {
    /// The same record with other measurements: `change` gets the place of a sensor, a sample of those that are kept and the
    /// reading, and returns the one in its place, in the same unit; NaN where it is missing.
    #[must_use]
    pub fn with_measured(mut self, change: impl Fn(usize, usize, f64) -> f64) -> Self {
        for (sensor, column) in self.measured.iter_mut().enumerate() {
            column.iter_mut().enumerate().for_each(|(k, value)| *value = change(sensor, k, *value));
        }
        if let Some(clocks) = &mut self.clocks {
            Arc::make_mut(clocks).change(change);
        }
        self
    }

    /// The same record where some measurements are missing. `is_missing` is asked with the place of a sensor and a sample.
    #[must_use]
    pub fn with_gaps(self, is_missing: impl Fn(usize, usize) -> bool) -> Self {
        self.with_measured(|sensor, k, value| if is_missing(sensor, k) { f64::NAN } else { value })
    }

    /// The same record with its first sample at this time \[s\].
    #[must_use]
    pub fn starting_at(self, start: f64) -> Self {
        Self { start, ..self }
    }

    /// The same record under an input that is this many times as large.
    #[must_use]
    pub fn with_input_times(mut self, factor: f64) -> Self {
        self.change_input(|value| factor * value);
        self
    }

    /// The same record under an input with another course between its values.
    pub(crate) fn with_hold(mut self, hold: Hold) -> Self {
        if let Some(input) = self.clocks.as_ref().and_then(|clocks| clocks.input.as_ref()) {
            self.input = (0..self.len()).map(|k| input.at(k as f64, hold)).collect();
        }
        Self { hold, ..self }
    }

    /// Changes every value of the input.
    pub(crate) fn change_input(&mut self, change: impl Fn(f64) -> f64) {
        self.input.iter_mut().for_each(|value| *value = change(*value));
        if let Some(clocks) = &mut self.clocks {
            Arc::make_mut(clocks).change_input(change);
        }
    }

    /// Changes every measurement of a sensor.
    pub(crate) fn change_measured(&mut self, sensor: usize, change: impl Fn(f64) -> f64) {
        self.measured[sensor].iter_mut().for_each(|value| *value = change(*value));
        if let Some(clocks) = &mut self.clocks {
            Arc::make_mut(clocks).change(|of, _, value| if of == sensor { change(value) } else { value });
        }
    }

    /// The measurements of a sensor at the samples, to be changed. Readings at times of their own stay.
    pub(crate) fn measured_mut(&mut self, sensor: usize) -> &mut [f64] {
        &mut self.measured[sensor]
    }

    /// Some samples of those that are kept, as a record of their own.
    #[must_use]
    pub fn part(&self, samples: std::ops::Range<usize>) -> Self {
        let start = self.time(samples.start);
        let cut = |column: &Vec<f64>| column[samples.clone()].to_vec();
        Self {
            start,
            forgotten: 0,
            input: cut(&self.input),
            measured: self.measured.iter().map(cut).collect(),
            truth: self.truth.iter().map(cut).collect(),
            sensors: self.sensors.clone(),
            truth_channels: self.truth_channels.clone(),
            clocks: self.clocks.as_ref().map(|clocks| Arc::new(clocks.part(samples.clone()))),
            ..*self
        }
    }
}
