//! Errors of imports.

use thiserror::Error;

use super::limits::{FEWEST, MOST, MOST_COLUMNS};
use crate::RecordError;

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
    /// It is a MATLAB file.
    #[error("this is a MATLAB file; save its columns as text: writematrix(data, \"record.csv\")")]
    Matlab,
    /// It is an HDF5 file.
    #[error(
        "this is an HDF5 file, as MATLAB writes it with -v7.3; save its columns as text: writematrix(data, \"record.csv\")"
    )]
    Hdf5,
    /// It is a Parquet file.
    #[error("this is a Parquet file; save its columns as CSV")]
    Parquet,
    /// It is a spreadsheet.
    #[error("this is a spreadsheet; save the sheet as CSV")]
    Spreadsheet,
    /// It is a sound that cannot be read.
    #[error("this sound cannot be read: {reason}; save it as WAV with whole numbers or floats")]
    Sound {
        /// The reason.
        reason: String,
    },
    /// No column has numbers.
    #[error("there is no column of numbers in {lines} line(s)")]
    NoNumbers {
        /// The number of lines that were looked at.
        lines: usize,
    },
    /// There are too many columns.
    #[error("line {line} has {found} cells, but at most {} columns can be read", MOST_COLUMNS)]
    TooManyColumns {
        /// Line of the file, counted from 1.
        line: usize,
        /// The number of its cells.
        found: usize,
    },
    /// A line does not end.
    #[error("line {line} is longer than 1 MB")]
    LongLine {
        /// Line of the file, counted from 1.
        line: usize,
    },
    /// A column is missing.
    #[error("there is no column `{missing}`; the columns are {found}")]
    Column {
        /// The column's name.
        missing: String,
        /// The columns of the file.
        found: String,
    },
    /// A cell of a chosen column is not a number.
    #[error("line {line}, column `{column}`: `{text}` is not a number")]
    Text {
        /// Line of the file, counted from 1.
        line: usize,
        /// The column's name.
        column: String,
        /// The cell's text.
        text: String,
    },
    /// A number of a chosen column is infinite.
    #[error("line {line}, column `{column}`: the number is infinite")]
    Infinite {
        /// Line of the file, counted from 1.
        line: usize,
        /// The column's name.
        column: String,
    },
    /// The time is not known.
    #[error("the file has no column of times: state the sample rate")]
    NoTime,
    /// A time is missing.
    #[error("line {line}, column `{column}`: a time is missing")]
    MissingTime {
        /// Line of the file, counted from 1.
        line: usize,
        /// The column's name.
        column: String,
    },
    /// The times do not rise.
    #[error("line {line}: the time {} from {before} s to {found} s", if found < before { "goes back" } else { "stands still" })]
    NotRising {
        /// Line of the file, counted from 1.
        line: usize,
        /// The time before \[s\].
        before: f64,
        /// The time in this line \[s\].
        found: f64,
    },
    /// There are too few samples.
    #[error("{0} row(s) of numbers remain, but at least {least} are needed", least = FEWEST)]
    TooShort(usize),
    /// There are too many samples.
    #[error("the record would have {found} samples, but at most {most} can be kept; choose a part or decimate", most = MOST)]
    TooLong {
        /// The number of samples.
        found: usize,
    },
    /// Two files have no time in common.
    #[error("one file is from {} to {} s, the other from {} to {} s: they have fewer than {FEWEST} samples in common", first[0], first[1], second[0], second[1])]
    Apart {
        /// Beginning and end of the first file \[s\].
        first: [f64; 2],
        /// Those of the second one, in the first one's clock \[s\].
        second: [f64; 2],
    },
    /// No sensor has a column.
    #[error("no column is chosen for a sensor")]
    NoSensor,
    /// There is no motion in a sensor's readings.
    #[error("all readings of the {sensor} are the same: there is no motion to make start values of")]
    Still {
        /// The sensor's name.
        sensor: String,
    },
    /// A setting is impossible.
    #[error("`record.{key}` is {value}, but must be {allowed}")]
    Setting {
        /// The key's path below `record`.
        key: String,
        /// The value.
        value: String,
        /// The values that are allowed.
        allowed: String,
    },
    /// The columns are not a record.
    #[error(transparent)]
    Record(#[from] RecordError),
}
