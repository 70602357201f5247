//! The columns of an accelerometer with three axes.

use super::unit::{Dimension, STANDARD_GRAVITY, unit};
use super::{Column, Table, times};

/// The columns of a file with the time and three accelerations: phyphox, Sensor Logger, Physics Toolbox, the lines of an Arduino.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreeAxes {
    /// The place of the time's column, and the seconds of its unit.
    pub time: (usize, f64),
    /// The places of the columns x, y and z, and their unit \[m/s²\].
    pub axes: ([usize; 3], f64),
}

/// Names of the time's column, the best first.
const TIMES: [&str; 9] =
    ["secondselapsed", "elapsed", "time", "t", "millis", "timestamp", "ms", "micros", "loggingtime"];

/// Names of an acceleration without its axis.
const ACCELERATIONS: [&str; 9] =
    ["acceleration", "linearacceleration", "accelerometer", "accel", "acc", "a", "gf", "g", ""];

impl ThreeAxes {
    /// The time and three axes among the columns of a file, by their names; without names, the only four columns, of which one
    /// rises and three have the size of gravity together.
    pub fn of(table: &Table) -> Option<Self> {
        let columns = &table.columns;
        let axes = named(columns).or_else(|| unnamed(columns))?;
        let mut others = (0..columns.len()).filter(|place| !axes.contains(place));
        let names: Vec<String> = columns.iter().map(|column| plain(&column.name)).collect();
        let named = TIMES.iter().find_map(|name| names.iter().position(|other| other == name));
        let time = named.or_else(|| others.find(|&place| nearly_rises(&columns[place].values)))?;
        Some(Self { time: (time, seconds(&columns[time])), axes: (axes, size(columns, axes)) })
    }

    /// Time \[s\] and three accelerations \[m/s²\] of each row. The time begins at zero: an epoch in nanoseconds has too many
    /// digits.
    pub fn readings(&self, table: &Table) -> Vec<[f64; 4]> {
        let Self { time: (time, second), axes: (axes, unit) } = *self;
        let column = |place: usize| &table.columns[place].values;
        let first = column(time).iter().copied().find(|t| t.is_finite()).unwrap_or(0.0);
        let reading = |row: usize| {
            let [x, y, z] = axes.map(|axis| unit * column(axis)[row]);
            [second * (column(time)[row] - first), x, y, z]
        };
        (0..table.rows()).map(reading).collect()
    }
}

/// A name without case, blanks and signs.
pub(super) fn plain(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// The columns whose names are one name with x, y and z behind it.
fn named(columns: &[Column]) -> Option<[usize; 3]> {
    let names: Vec<String> = columns.iter().map(|column| plain(&column.name)).collect();
    ACCELERATIONS.iter().find_map(|of| {
        let place = |axis: &str| names.iter().position(|name| *name == format!("{of}{axis}"));
        Some([place("x")?, place("y")?, place("z")?])
    })
}

/// Three of four columns without names: gravity is in them.
fn unnamed(columns: &[Column]) -> Option<[usize; 3]> {
    let nameless = columns.len() == 4 && columns.iter().all(|column| column.name.starts_with("column "));
    let time = (0..4).find(|&place| nameless && nearly_rises(&columns[place].values))?;
    let mut axes = (0..4).filter(|&place| place != time);
    let axes = [axes.next()?, axes.next()?, axes.next()?];
    has_gravity(columns, axes).then_some(axes)
}

/// Whether the mean of three columns has the length of gravity, in m/s² or g.
pub(super) fn has_gravity(columns: &[Column], axes: [usize; 3]) -> bool {
    let length = length(columns, axes);
    [STANDARD_GRAVITY, 1.0].into_iter().any(|unit| (0.85..1.15).contains(&(length / unit)))
}

/// The length of the mean of three accelerations.
fn length(columns: &[Column], axes: [usize; 3]) -> f64 {
    let mean = |place: usize| {
        let there = || columns[place].values.iter().filter(|x| x.is_finite());
        there().sum::<f64>() / there().count().max(1) as f64
    };
    axes.map(|axis| mean(axis) * mean(axis)).iter().sum::<f64>().sqrt()
}

/// The unit of three accelerations \[m/s²\]: the file's, or g or mm/s² where their mean has the length of gravity in it.
fn size(columns: &[Column], axes: [usize; 3]) -> f64 {
    let told = columns[axes[0]].unit.as_deref().and_then(unit);
    if let Some((Dimension::Acceleration, factor)) = told {
        return factor;
    }
    let is_gravity = |unit: &f64| (0.85..1.15).contains(&(unit * length(columns, axes) / STANDARD_GRAVITY));
    [STANDARD_GRAVITY, 1e-3].into_iter().find(is_gravity).unwrap_or(1.0)
}

/// The seconds of a time's unit: the file's, or that of plausible steps.
fn seconds(column: &Column) -> f64 {
    match column.unit.as_deref().and_then(unit) {
        Some((Dimension::Time, factor)) => factor,
        _ => times::second(column).0,
    }
}

/// Whether numbers rise, but for a few.
fn nearly_rises(values: &[f64]) -> bool {
    let rising = values.windows(2).filter(|pair| pair[1] > pair[0]).count();
    values.len() > 2 && rising * 100 >= 99 * (values.len() - 1)
}
