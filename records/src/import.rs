//! Measured records from files: dialect, columns, meaning, conditioning.
//!
//! ```text
//! bytes ──dialect──▶ Table ──mapping──▶ Record
//! ```
//!
//! Each step reports what it found, and the caller can change it: [`Dialect`] comes from the first lines,
//! [`Mapping::guess`] from names, units and shapes.
//!
//! ```
//! use kalmanscope_records::import::{Mapping, build, read};
//! use kalmanscope_filters::{Hold, Quantity};
//! # fn main() -> Result<(), kalmanscope_records::import::ImportError> {
//! let text = "Zeit [ms];Kraft;Weg [mm]\n0;1,5;2\n10;1;2,5\n20;0;3\n";
//! let table = read(text.as_bytes(), None)?;
//! let (mapping, kind) = Mapping::guess(&table);
//! let imported = build(&table, &mapping, kind, Hold::First, &[])?;
//! assert_eq!(imported.record.dt(), 0.01);
//! assert_eq!(imported.record.measured_quantity(Quantity::DISPLACEMENT), Some(&[0.002, 0.0025, 0.003][..]));
//! # Ok(())
//! # }
//! ```

mod builder;
mod cell;
mod conditioning;
mod dialect;
mod formats;
mod guess;
mod header;
mod mend;
mod own_times;
mod reader;
mod shape;
mod sound;
mod table;
mod three_axes;
mod times;

pub use crate::hash::Hash;
pub use crate::mapping::{
    Decimal, Delimiter, Dialect, Encoding, MappedColumn, Mapping, MappingError, MeanWord, Offset, Time,
};
pub use crate::record::MOST;
pub use builder::{Imported, build, building};
pub use conditioning::Sentinel;
pub use guess::ColumnGuess;
pub use header::{Dimension, STANDARD_GRAVITY, unit};
pub use mend::turn;
pub use own_times::join;
pub use reader::{Loaded, load};
pub use sound::wav;
pub use table::{Column, Table, TextCell};
pub use three_axes::ThreeAxes;

use thiserror::Error;

use crate::RecordError;
use crate::task::{Progress, at_once};

/// The columns of a file, read in one go.
///
/// # Errors
/// [`ImportError`] where the file is empty, not text, or without numbers.
pub fn read(bytes: impl AsRef<[u8]>, dialect: Option<Dialect>) -> Result<Table> {
    at_once(reader::read(bytes.as_ref(), dialect, &Progress::default())).map(mend::mend)
}

/// The [`struct@Hash`] of a file's bytes, in one go.
pub fn hash(bytes: &[u8]) -> String {
    let mut hash = Hash::default();
    hash.add(bytes);
    hash.text()
}

/// The result of reading a file.
pub type Result<T, E = ImportError> = std::result::Result<T, E>;

/// The reason why a file is not a record.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ImportError {
    /// There is nothing in it.
    #[error("the file is empty")]
    Empty,
    /// It is not text.
    #[error("the file is not text with columns of numbers")]
    Binary,
    /// It is a file of another kind, or a damaged one, which a sentence names.
    #[error("{0}")]
    OtherKind(String),
    /// It is a sound that cannot be read.
    #[error("this sound cannot be read: {0}; save it as WAV with whole numbers or floats")]
    Sound(String),
    /// No column has numbers.
    #[error("there is no column of numbers in {0} line(s): separate them by commas, semicolons, tabs or blanks")]
    NoNumbers(usize),
    /// No series of the file is one of readings; of the first one the reason, and the number of all.
    #[error("{0}, like all {1} function(s) of this file: export the readings over time")]
    NoRecord(String, usize),
    /// There are too many columns: a line of the file, counted from 1, and the number of its cells.
    #[error("line {0} has {1} cells, but at most {most} columns can be read", most = MOST_COLUMNS)]
    TooManyColumns(usize, usize),
    /// A line does not end.
    #[error("line {0} is longer than 1 MB")]
    LongLine(usize),
    /// A column is missing: its name, and the columns of the file.
    #[error("there is no column `{0}`; the columns are {1}")]
    Column(String, String),
    /// A cell of a chosen column cannot be used: its line in the file, counted from 1, the column's name, and why.
    #[error("line {0}, column `{1}`: {2}")]
    Cell(usize, String, String),
    /// The time is not known; why a column that is named so is none.
    #[error("the file has no column of times{0}: state the sample rate")]
    NoTime(String),
    /// The times do not rise: a line of the file, counted from 1, what the times do there, and what helps.
    #[error("line {0}: the time in {1}: {2}")]
    NotRising(usize, String, String),
    /// There are too few samples.
    #[error("{0} row(s) of numbers remain, but at least {least} are needed", least = FEWEST)]
    TooShort(usize),
    /// There are too many samples.
    #[error("the record would have {0} samples, but at most {most} can be kept; choose a part or decimate", most = MOST)]
    TooLong(usize),
    /// Two clocks have no time in common: beginning and end of each \[s\].
    #[error("one clock is from {} to {} s, the other from {} to {} s: they have fewer than {FEWEST} samples in common", .0[0], .0[1], .1[0], .1[1])]
    Apart([f64; 2], [f64; 2]),
    /// No sensor has a column.
    #[error("no column is chosen for a sensor")]
    NoSensor,
    /// There is no motion in a sensor's readings.
    #[error("all readings of the {0} are the same: there is no motion for start values")]
    Still(String),
    /// A setting is impossible.
    #[error(transparent)]
    Setting(#[from] MappingError),
    /// The columns are not a record.
    #[error(transparent)]
    Record(#[from] RecordError),
}

const MOST_COLUMNS: usize = 1000;
const LONGEST_LINE: usize = 1_000_000;
const FEWEST: usize = 2;
