//! Records made of others: other readings or inputs, a part, and what a longer one adds.

use std::sync::Arc;

use kalmanscope_filters::Hold;
use kalmanscope_filters::lists::{mapped, numbers};

use super::{Clocks, Record, Timed};

fn begins(all: &[f64], first: &[f64], compared: usize) -> bool {
    let from = first.len().saturating_sub(compared);
    all.len() >= first.len() && first[from..].iter().zip(&all[from..]).all(|(a, b)| a.to_bits() == b.to_bits())
}

fn append(column: &mut Vec<f64>, longer: &[f64]) {
    column.extend_from_slice(&longer[column.len()..]);
}

impl Timed {
    fn begins_with(&self, first: &Self, compared: usize) -> bool {
        begins(&self.times, &first.times, compared) && begins(&self.values, &first.values, compared)
    }

    fn append(&mut self, longer: &Self) {
        append(&mut self.times, &longer.times);
        append(&mut self.values, &longer.values);
    }
}

impl Clocks {
    /// A record without an input may begin one with an input, as long as that is zero.
    fn begin_with(&self, first: &Self, samples: usize, compared: usize) -> bool {
        let is_zero = |input: &Timed| {
            let until = input.times.partition_point(|time| *time <= samples as f64 - 1.0);
            input.values[..until].iter().all(|value| *value == 0.0)
        };
        let input = match (&self.input, &first.input) {
            (Some(all), Some(first)) => all.begins_with(first, compared),
            (Some(all), None) => is_zero(all),
            (all, _) => all.is_none() && first.input.is_none(),
        };
        let begins = |(all, first): (&Timed, &Timed)| all.begins_with(first, compared);
        input && self.readings.len() == first.readings.len() && self.readings.iter().zip(&first.readings).all(begins)
    }

    fn append(&mut self, longer: &Self) {
        match (&mut self.input, &longer.input) {
            (Some(input), Some(longer)) => input.append(longer),
            (input, longer) => input.clone_from(longer),
        }
        self.readings.iter_mut().zip(&longer.readings).for_each(|(timed, longer)| timed.append(longer));
    }
}

impl Record {
    /// Whether this record begins with all samples of another one, of the same quantities at the same times.
    pub fn begins_with(&self, other: &Self) -> bool {
        self.has_first(other, usize::MAX)
    }

    /// Compares the last 1,000 samples: a live record grows many times a second, and all are too slow.
    pub fn goes_on_from(&self, other: &Self) -> bool {
        self.has_first(other, 1000)
    }

    fn has_first(&self, other: &Self, compared: usize) -> bool {
        let of =
            |record: &Self| (record.dt.to_bits(), record.start.to_bits(), record.forgotten, record.kind, record.hold);
        let begins = |(all, first): (&Vec<f64>, &Vec<f64>)| begins(all, first, compared);
        let clocks = match (self.clocks(), other.clocks()) {
            (Some(all), Some(first)) => all.begin_with(first, other.len(), compared),
            (all, first) => all.is_none() && first.is_none(),
        };
        of(self) == of(other)
            && self.sensors == other.sensors
            && self.truth_channels == other.truth_channels
            && self.forced == other.forced
            && clocks
            && self.columns().zip(other.columns()).all(begins)
    }

    pub(super) fn append(&mut self, longer: &Self) {
        self.columns_mut().zip(longer.columns()).for_each(|(column, longer)| append(column, longer));
        match (&mut self.clocks, &longer.clocks) {
            (Some(clocks), Some(longer)) => Arc::make_mut(clocks).append(longer),
            (clocks, longer) => clocks.clone_from(longer),
        }
    }

    /// The same record with other measurements: `change` gets the place of a sensor, a kept sample and the reading, NaN if it is missing.
    #[must_use]
    pub fn with_measured(mut self, change: impl Fn(usize, usize, f64) -> f64) -> Self {
        self.change_measured(change);
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

    /// The same record, whose input has this course between samples.
    pub fn with_hold(mut self, hold: Hold) -> Self {
        if let Some(input) = self.clocks.as_ref().and_then(|clocks| clocks.input.as_ref()) {
            self.input = numbers(self.len(), &|k| input.at(k as f64, hold));
        }
        Self { hold, ..self }
    }

    /// Replaces each value of the input.
    pub fn change_input(&mut self, change: impl Fn(f64) -> f64) {
        self.input.iter_mut().for_each(|value| *value = change(*value));
        if let Some(clocks) = &mut self.clocks {
            Arc::make_mut(clocks).change_input(change);
        }
    }

    /// As [`Self::with_measured`].
    pub fn change_measured(&mut self, change: impl Fn(usize, usize, f64) -> f64) {
        for (sensor, column) in self.measured.iter_mut().enumerate() {
            column.iter_mut().enumerate().for_each(|(k, value)| *value = change(sensor, k, *value));
        }
        if let Some(clocks) = &mut self.clocks {
            Arc::make_mut(clocks).change(change);
        }
    }

    /// The readings of a sensor.
    pub fn measured_mut(&mut self, sensor: usize) -> &mut [f64] {
        &mut self.measured[sensor]
    }

    /// Some samples of those that are kept, as another record.
    #[must_use]
    pub fn part(&self, samples: std::ops::Range<usize>) -> Self {
        let start = self.time(samples.start);
        let cut = |column: &Vec<f64>| column[samples.clone()].to_vec();
        Self {
            start,
            forgotten: 0,
            input: cut(&self.input),
            measured: mapped(&self.measured, &cut),
            truth: mapped(&self.truth, &cut),
            forces: mapped(&self.forces, &cut),
            forced: self.forced.clone(),
            sensors: self.sensors.clone(),
            truth_channels: self.truth_channels.clone(),
            clocks: self.clocks.as_ref().map(|clocks| Arc::new(clocks.part(samples.clone()))),
            ..*self
        }
    }
}
