//! The meaning of a file's columns, as a scenario names it. The importer reads it: [`crate::import`].

use std::collections::BTreeMap;

use kalmanscope_filters::{ForcedMass, Quantity};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::document::{is_default, is_one};

/// The meaning of a file's columns, and how they become a record: the table `[record]` of a scenario.
///
/// ```text
/// columns ──unit, gain, offset, delay──▶ even times ──band──▶ from, to ──every──▶ interpolate ──▶ Record
/// ```
///
/// A scenario says whether the input is a force over mass or the ground's acceleration, and how it runs between samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub struct Mapping {
    /// The file's name. The command line looks for it beside the scenario.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub file: String,
    /// A hash of the file's bytes ([`crate::import::hash`]), to recognise the same file; may be empty.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub hash: String,
    /// The file's form, if it cannot be guessed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dialect: Option<Dialect>,
    /// The times of the samples.
    pub time: Time,
    /// The input; without one it is zero.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub input: Option<MappedColumn>,
    /// The forces over mass on single masses besides the input, as `force_on_3`.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub forces: BTreeMap<ForcedMass, MappedColumn>,
    /// Whether no input was recorded: the guess of the sensors' columns then takes no column as the input.
    #[serde(skip_serializing_if = "is_default")]
    pub no_input: bool,
    /// The sensors' columns.
    pub sensors: BTreeMap<Quantity, MappedColumn>,
    /// The beginning of the part that is used \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from: Option<f64>,
    /// The end of the part that is used \[s\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to: Option<f64>,
    /// The limits of a band-pass for input and sensors \[Hz\], or from 0 on of a low-pass: Butterworth, order 4, forward and backward.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub band: Option<[f64; 2]>,
    /// Keep one of this many samples, after a low-pass below the new Nyquist frequency.
    #[serde(skip_serializing_if = "is_one")]
    pub every: usize,
    /// Put this many steps in place of one: the input is interpolated as a band-limited signal, without measurements in between.
    #[serde(skip_serializing_if = "is_one")]
    pub interpolate: usize,
}

/// The times of the samples: a column, or a rate.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub struct Time {
    /// The column of times.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub column: Option<String>,
    /// The unit of the times, seconds if it is empty.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// Samples in a second, for a file without times \[Hz\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate: Option<f64>,
    /// Whether the samples are equally spaced, and only their times are not. Else times off by more than rounding are those of readings.
    #[serde(skip_serializing_if = "is_default")]
    pub even: bool,
    /// Time between estimates \[s\] where readings keep their times, and the time that Q is for; without it, that of the fastest clock.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dt: Option<f64>,
}

/// The use of a column: `gain · (cell - offset)`, in SI units where the column's unit is known.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct MappedColumn {
    /// The column's name.
    pub column: String,
    /// The unit of its cells; may be empty. A known one, such as mm, g or °, is converted to SI units.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// Multiplies the values. A negative one turns the sign.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub gain: f64,
    /// Subtracted from each cell, in the cells' unit.
    #[serde(default, skip_serializing_if = "is_default")]
    pub offset: Offset,
    /// The number of samples by which the column is late; a negative one is early.
    #[serde(default, skip_serializing_if = "is_default")]
    pub delay: i32,
    /// The number that stands in cells without a reading, such as -9999.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub missing: Option<f64>,
}

/// The offset of a column.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "expected a number, \"mean\" or { mean = [from, to] } in seconds")]
pub enum Offset {
    /// A number, in the cells' unit.
    Number(f64),
    /// The mean of all cells.
    Mean(MeanWord),
    /// The mean of a part.
    Part {
        /// From and to \[s\].
        mean: [f64; 2],
    },
}

/// The word `mean`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MeanWord {
    /// All cells.
    Mean,
}

/// An impossible setting of a mapping.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`record.{key}` is {value}, but must be {allowed}")]
pub struct MappingError {
    /// Its path below `record`.
    pub key: String,
    /// Its value.
    pub value: String,
    /// The allowed values.
    pub allowed: String,
}

/// The form of a text file with columns of numbers. [`load`](crate::import::load) finds it by looking at the first lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub struct Dialect {
    /// The encoding.
    pub encoding: Encoding,
    /// The delimiter between cells.
    pub delimiter: Delimiter,
    /// The decimal character.
    pub decimal: Decimal,
    /// The line with the columns' names, counted from 1; 0 if there is none.
    pub names: usize,
    /// The line with the columns' units, counted from 1; 0 if there is none.
    pub units: usize,
    /// The first line with numbers, counted from 1.
    pub data: usize,
    /// Whether a separator such as that in `1.234`, where commas are decimal, or in `1,234` is one of thousands.
    #[serde(skip_serializing_if = "is_default")]
    pub thousands: bool,
}

/// The encoding of a text file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Encoding {
    /// UTF-8, which includes ASCII.
    #[default]
    Utf8,
    /// Latin-1, one byte a character.
    Latin1,
    /// UTF-16, the lower byte first.
    Utf16Le,
    /// UTF-16, the higher byte first.
    Utf16Be,
}

/// The delimiter between the cells of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Delimiter {
    /// `,`
    #[default]
    Comma,
    /// `;`
    Semicolon,
    /// A tab.
    Tab,
    /// Blanks and tabs, any number of them.
    Blanks,
}

/// The character between the whole part of a number and its fraction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Decimal {
    /// `1.5`
    #[default]
    Point,
    /// `1,5`
    Comma,
}

impl Mapping {
    /// What the columns mean, in one sentence.
    pub fn in_words(&self) -> String {
        let time = match (&self.time.column, self.time.rate) {
            (Some(column), _) => format!("time in `{column}`"),
            (None, Some(rate)) => format!("{rate} samples per second"),
            (None, None) => "no time".to_owned(),
        };
        let input = self.input.iter().map(|input| format!("input in `{}`", input.column));
        let forces = self.forces.iter().map(|(on, column)| format!("{} in `{}`", on.name(), column.column));
        let sensors = self.sensors.iter().map(|(q, column)| format!("{} in `{}`", q.name(), column.column));
        std::iter::once(time).chain(input).chain(forces).chain(sensors).collect::<Vec<_>>().join(", ")
    }

    /// The columns of input, forces and sensors.
    pub fn columns(&self) -> impl Iterator<Item = &MappedColumn> {
        self.input.iter().chain(self.forces.values()).chain(self.sensors.values())
    }

    /// Checks every number.
    ///
    /// # Errors
    /// [`MappingError`] for the first impossible one.
    pub fn validate(&self) -> Result<(), MappingError> {
        let Self { file: _, hash: _, dialect: _, time, input, forces, no_input, sensors, .. } = self;
        let Self { from, to, band, every, interpolate, .. } = self;
        let require = |ok: bool, key: &str, value: String, allowed: &str| {
            if ok { Ok(()) } else { Err(MappingError { key: key.to_owned(), value, allowed: allowed.to_owned() }) }
        };
        for (key, number) in [("time.rate", time.rate), ("time.dt", time.dt)] {
            let number = number.unwrap_or(1.0);
            require(number.is_finite() && number > 0.0, key, number.to_string(), "positive and finite")?;
        }
        let is_one = !no_input || input.is_none();
        require(is_one, "no_input", no_input.to_string(), "false where there is an input")?;
        let named = sensors.iter().map(|(quantity, column)| (format!("sensors.{}", quantity.key()), column));
        let forces = forces.iter().map(|(on, column)| (format!("forces.{}", on.key()), column));
        for (key, column) in input.iter().map(|column| ("input".to_owned(), column)).chain(forces).chain(named) {
            let MappedColumn { column: _, unit: _, gain, offset, delay, missing } = column;
            let is_gain = gain.is_finite() && *gain != 0.0;
            require(is_gain, &format!("{key}.gain"), gain.to_string(), "finite and not 0")?;
            let (ok, value) = match offset {
                Offset::Number(number) => (number.is_finite(), number.to_string()),
                Offset::Mean(_) => (true, String::new()),
                Offset::Part { mean: [from, to] } => (from < to, format!("{{ mean = [{from}, {to}] }}")),
            };
            require(ok, &format!("{key}.offset"), value, "a finite number, \"mean\" or the mean of a part")?;
            let missing = missing.unwrap_or_default();
            require(missing.is_finite(), &format!("{key}.missing"), missing.to_string(), "a finite number")?;
            let allowed = format!("from -{MOST_DELAY} to {MOST_DELAY}");
            require(delay.unsigned_abs() <= MOST_DELAY, &format!("{key}.delay"), delay.to_string(), &allowed)?;
        }
        for (key, time) in [("from", from), ("to", to)] {
            require(time.is_none_or(f64::is_finite), key, time.unwrap_or_default().to_string(), "a finite number")?;
        }
        if let (Some(from), Some(to)) = (from, to) {
            require(from < to, "to", to.to_string(), "after `from`")?;
        }
        if let Some([low, high]) = band {
            let ok = *low >= 0.0 && low < high && high.is_finite();
            require(ok, "band", format!("[{low}, {high}]"), "two rising frequencies from 0 on [Hz]")?;
        }
        let allowed = format!("from 1 to {MOST_EVERY}");
        require((1..=MOST_EVERY).contains(every), "every", every.to_string(), &allowed)?;
        let allowed = format!("from 1 to {MOST_STEPS}");
        require((1..=MOST_STEPS).contains(interpolate), "interpolate", interpolate.to_string(), &allowed)
    }
}

impl Default for Mapping {
    fn default() -> Self {
        let (file, hash, dialect, time, input, forces, no_input, sensors, from, to, band) = Default::default();
        Self { file, hash, dialect, time, input, forces, no_input, sensors, from, to, band, every: 1, interpolate: 1 }
    }
}

impl Default for Offset {
    fn default() -> Self {
        Self::Number(0.0)
    }
}

impl Offset {
    /// The mean of all cells.
    pub const MEAN: Self = Self::Mean(MeanWord::Mean);
}

impl MappedColumn {
    /// A column without conversion.
    pub fn new(column: impl Into<String>) -> Self {
        let (unit, gain, offset, delay, missing) = (String::new(), one(), Offset::default(), 0, None);
        Self { column: column.into(), unit, gain, offset, delay, missing }
    }
}

const MOST_DELAY: u32 = 100_000;
const MOST_STEPS: usize = 8;
const MOST_EVERY: usize = 10_000;

const fn one() -> f64 {
    1.0
}
