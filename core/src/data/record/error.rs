//! Errors of records.

use thiserror::Error;

use super::ClocksError;

/// The reason why columns or a file are not a record.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum RecordError {
    /// The time between samples is not positive and finite.
    #[error("dt = {0} s, but must be positive and finite")]
    Step(f64),
    /// Two columns are of the same quantity or channel.
    #[error("there are two columns `{0}`")]
    Repeated(String),
    /// A column is not as long as the input.
    #[error("column `{column}` has {found} values, but the input has {expected}")]
    Length {
        /// The column's name.
        column: String,
        /// The number of values.
        found: usize,
        /// The required number.
        expected: usize,
    },
    /// A value is not finite where it must be, or infinite.
    #[error("sample {sample}, column `{column}`: {value} is not {allowed}")]
    Value {
        /// The column's name.
        column: String,
        /// The sample, counted from 0.
        sample: usize,
        /// The value.
        value: f64,
        /// The values that are allowed.
        allowed: &'static str,
    },
    /// The text is not CSV, or cannot be read or written.
    #[error(transparent)]
    Csv(#[from] csv::Error),
    /// A column is missing.
    #[error("line 1: there is no column `{missing}`; the columns are {found}")]
    Column {
        /// The column's name.
        missing: String,
        /// The columns of the file.
        found: String,
    },
    /// A cell is not a number.
    #[error("line {line}, column `{column}`: `{value}` is not {allowed}")]
    Cell {
        /// The line of the file; the header is line 1.
        line: u64,
        /// The column's name.
        column: String,
        /// The cell's text.
        value: String,
        /// The values that are allowed.
        allowed: &'static str,
    },
    /// The samples are not equally spaced.
    #[error("line {line}: t = {found} s, but samples {dt} s apart would have t = {expected} s here")]
    Spacing {
        /// Line of the file.
        line: u64,
        /// The time in the file \[s\].
        found: f64,
        /// The expected time \[s\].
        expected: f64,
        /// The mean time between samples \[s\].
        dt: f64,
    },
    /// There are too few samples to determine the time between them.
    #[error("{0} sample(s), but at least 2 are needed")]
    TooShort(usize),
    /// The times that readings have do not fit.
    #[error(transparent)]
    Clocks(#[from] ClocksError),
    /// The times do not increase.
    #[error("t must rise, but goes from {first} s to {last} s")]
    NotRising {
        /// First time \[s\].
        first: f64,
        /// Last time \[s\].
        last: f64,
    },
}
