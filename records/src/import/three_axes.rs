//! The columns of an accelerometer with three axes.

use kalmanscope_filters::lists::mapped;

use super::guess::{is_named_time, seldom_falls};
use super::header::{Dimension, STANDARD_GRAVITY, unit};
use super::shape::{gravity, is_counter, plain};
use super::{Column, Table, times};

/// The columns of a file with the time and three accelerations: phyphox, Sensor Logger, Physics Toolbox, the lines of an Arduino.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreeAxes {
    /// The place of the time's column, and the seconds of its unit.
    pub time: (usize, f64),
    /// The places of the columns x, y and z, and their unit \[m/s²\].
    pub axes: ([usize; 3], f64),
}

const ACCELERATIONS: [&str; 9] =
    ["acceleration", "linearacceleration", "accelerometer", "accel", "acc", "a", "gf", "g", ""];

impl ThreeAxes {
    /// Time and axes by the names of columns; without names, of four columns of which one rises and three have the size of gravity.
    pub fn of(table: &Table) -> Option<Self> {
        let columns = &table.columns;
        let axes = named(columns).or_else(|| unnamed(columns))?;
        let others = || (0..columns.len()).filter(|place| !axes.contains(place));
        let elapsed = others().find(|&place| plain(&columns[place].name) == "secondselapsed");
        let named = elapsed.or_else(|| others().find(|&place| is_named_time(&columns[place])));
        let time = named.or_else(|| others().find(|&place| seldom_falls(&columns[place].values)))?;
        let unit_of = |place: usize| columns[place].unit.as_deref().and_then(unit);
        let second = match unit_of(time) {
            Some((Dimension::Time, second)) => second,
            // Rows with numbers are no times.
            _ if is_counter(&columns[time].values, false) && !is_named_time(&columns[time]) => 1.0 / table.rate?,
            _ => times::second(&columns[time]).0,
        };
        let size = match unit_of(axes[0]) {
            Some((Dimension::Acceleration, size)) => size,
            _ => gravity(columns, axes, [STANDARD_GRAVITY, 1e-3]).unwrap_or(1.0),
        };
        Some(Self { time: (time, second), axes: (axes, size) })
    }

    /// Time \[s\] and three accelerations \[m/s²\] of each row. It begins at zero: an epoch in ns has too many digits.
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

fn named(columns: &[Column]) -> Option<[usize; 3]> {
    let names: Vec<String> = mapped(columns, &|column| plain(&column.name));
    let mut all = ACCELERATIONS.iter().flat_map(|of| ["xyz", "012"].map(|axes| (of, axes)));
    all.find_map(|(of, axes)| {
        let mut places = axes.chars().map(|axis| names.iter().position(|name| *name == format!("{of}{axis}")));
        Some([places.next()??, places.next()??, places.next()??])
    })
}

/// Of four columns without names, three that have gravity.
fn unnamed(columns: &[Column]) -> Option<[usize; 3]> {
    let nameless = columns.len() == 4 && columns.iter().all(|column| column.name.starts_with("column "));
    let time = (0..4).find(|&place| nameless && seldom_falls(&columns[place].values))?;
    let axes = <[usize; 3]>::try_from((0..4).filter(|&place| place != time).collect::<Vec<_>>()).ok()?;
    gravity(columns, axes, [STANDARD_GRAVITY, 1.0]).map(|_| axes)
}
