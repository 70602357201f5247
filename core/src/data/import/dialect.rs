//! The form of a text file with columns of numbers.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::cell::Delimiter;
use super::encoding::Encoding;
use super::number::Decimal;
use crate::data::document::is_default;

/// The form of a text file with columns of numbers. [`Reader::new`](super::Reader::new) finds it by looking at the first lines.
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

impl fmt::Display for Dialect {
    /// Writes the dialect in one line.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { encoding, delimiter, decimal, names, units, data, thousands } = self;
        write!(f, "{}, {} between cells, decimal ", encoding.name(), delimiter.name())?;
        f.write_str(match decimal {
            Decimal::Point => "points",
            Decimal::Comma => "commas",
        })?;
        if *thousands {
            f.write_str(", thousands apart")?;
        }
        match names {
            0 => f.write_str(", no names")?,
            line => write!(f, ", names in line {line}")?,
        }
        if *units > 0 {
            write!(f, ", units in line {units}")?;
        }
        write!(f, ", numbers from line {data} on")
    }
}
