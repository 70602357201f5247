//! Readings at the times that a file gives them, in place of even steps.

use std::collections::BTreeMap;

use super::decay::side_of;
use super::samples::mean;
use super::steps::Steps;
use super::times;
use super::{Mapping, Offset, Table};
use crate::Hold;
use crate::data::record::{Clocks, Timed};

/// The cells of some columns that have a number, with their times \[s\].
#[derive(Debug, Default)]
pub(super) struct OwnTimes {
    columns: BTreeMap<String, Timed>,
    /// The rows of each column that have no number.
    empty: BTreeMap<String, usize>,
    input: Option<Timed>,
    readings: Vec<Timed>,
}

impl OwnTimes {
    /// The columns of a table that a mapping names, and those with a truth, at the times of the rows \[s\].
    pub(super) fn of_rows(table: &Table, mapping: &Mapping, times: &[f64]) -> Self {
        let mut own = Self::default();
        let mapped = mapping.input.iter().chain(mapping.sensors.values());
        for (name, missing) in mapped.map(|mapped| (&mapped.column, mapped.missing)) {
            own.add(table, name, times, missing);
        }
        for column in table.columns.iter().filter(|column| column.name.starts_with("true_")) {
            own.add(table, &column.name, times, None);
        }
        own
    }

    /// Adds a column of a table, by its name.
    pub(super) fn add(&mut self, table: &Table, name: &str, times: &[f64], missing: Option<f64>) {
        let Some(place) = table.place(name) else { return };
        let is_there = |value: f64| !value.is_nan() && Some(value) != missing;
        let cells = times.iter().zip(&table.columns[place].values).filter(|(_, value)| is_there(**value));
        let (own, values): (Vec<f64>, Vec<f64>) = cells.unzip();
        self.empty.insert(name.to_owned(), times.len() - own.len());
        let times = own;
        self.columns.insert(name.to_owned(), Timed { times, values });
    }

    /// A column in the meaning that a mapping gives it: `factor · (cell - offset)`, that much earlier, with times in steps after the
    /// first one.
    fn scaled(&self, name: &str, factor: f64, offset: Offset, delay: i32, steps: Steps) -> Timed {
        let Steps { start, dt, count } = steps;
        let Some(Timed { times, values }) = self.columns.get(name) else { return Timed::default() };
        let between = |from: f64, to: f64| {
            let is_in = |(time, _): &(&f64, &f64)| (from..=to).contains(*time);
            mean(&times.iter().zip(values).filter(is_in).map(|(_, value)| *value).collect::<Vec<_>>())
        };
        let offset = match offset {
            Offset::Number(number) => number,
            Offset::Mean(_) => between(start - dt, start + dt * count as f64),
            Offset::Part { mean: [from, to] } => between(from, to),
        };
        let in_steps = |time: &f64| (time - start) / dt - f64::from(delay);
        let times = times.iter().map(in_steps).collect();
        Timed { times, values: values.iter().map(|value| factor * (value - offset)).collect() }
    }

    /// The input of a column at the steps; a sensor's comes with [`Self::sensor`].
    pub(super) fn input(&mut self, name: &str, by: (f64, Offset, i32), hold: Hold, steps: Steps) -> Option<Vec<f64>> {
        let timed = self.scaled(name, by.0, by.1, by.2, steps);
        if timed.times.is_empty() {
            return None;
        }
        let values = (0..steps.count).map(|k| timed.at(k as f64, hold)).collect();
        self.input = Some(timed);
        Some(values)
    }

    /// The rows of a column that have no number.
    pub(super) fn empty(&self, name: &str) -> usize {
        self.empty.get(name).copied().unwrap_or_default()
    }

    /// The readings of a column at the ends of the steps in which they fall; NaN at a step without one.
    pub(super) fn sensor(&mut self, name: &str, by: (f64, Offset, i32), steps: Steps) -> Vec<f64> {
        let Timed { mut times, mut values } = self.scaled(name, by.0, by.1, by.2, steps);
        let in_steps = Steps { start: 0.0, dt: 1.0, count: steps.count };
        let at_ends = in_steps.at_ends(&times, &values, side_of(&times, &values));
        // What is before the first step does not count, and what is after the last one is not part of the record.
        let from = times.partition_point(|time| *time <= -1.0);
        let to = times.partition_point(|time| *time <= steps.count as f64 - 1.0);
        (times, values) = (times[from..to.max(from)].to_vec(), values[from..to.max(from)].to_vec());
        self.readings.push(Timed { times, values });
        at_ends
    }

    /// The truth of a column at the steps, linear between its cells.
    pub(super) fn truth(&self, name: &str, steps: Steps) -> Vec<f64> {
        let timed = self.scaled(name, 1.0, Offset::default(), 0, steps);
        if timed.times.is_empty() {
            return vec![f64::NAN; steps.count];
        }
        (0..steps.count).map(|k| timed.at(k as f64, Hold::First)).collect()
    }

    /// The clocks of the record whose columns were asked for.
    pub(super) fn clocks(self) -> Clocks {
        let Self { input, readings, .. } = self;
        Clocks { input, readings }
    }
}

/// The times of a table's rows \[s\].
pub(super) fn times_of(table: &Table, column: &str, unit: &str) -> Vec<f64> {
    let place = table.place(column);
    place.map(|place| times::of(table, &table.columns[place], unit, &mut Vec::new()).into_owned()).unwrap_or_default()
}
