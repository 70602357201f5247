//! One line of a limited length: cells between marks, or a JSON object.

use kalmanscope_core::document::{self, Document};
use std::io::{self, BufRead};

use thiserror::Error;

/// The reason why a line cannot be read.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BadLine {
    /// It is too long.
    #[error("it is longer than {} bytes", LONGEST)]
    TooLong,
    /// It is no UTF-8.
    #[error("it is not text")]
    NoText,
    /// It begins as an object and is none.
    #[error("it is no JSON object: {0}")]
    NoJson(String),
    /// A value is no number.
    #[error("`{key}` is {value}, but must be a number")]
    NoNumber {
        /// The column's name.
        key: String,
        /// The value.
        value: String,
    },
    /// It has not as many cells as the header.
    #[error("it has {found} cells, but the header has {expected}")]
    Cells {
        /// The number of its cells.
        found: usize,
        /// The number of those of the header.
        expected: usize,
    },
    /// There is no time.
    #[error("there is no column for the time, `t`; a header such as `{0}` must come first")]
    NoTime(String),
    /// The times have no unit and cannot be seconds.
    #[error(
        "the step of `{column}` is {step}, {steps:.0} steps of the scenario: are the times {unit}? They count as seconds; name their \
         column `{column}_{unit}`"
    )]
    Unit {
        /// The column of times.
        column: String,
        /// The step to this line.
        step: f64,
        /// The same in steps of the scenario.
        steps: f64,
        /// The likely unit.
        unit: &'static str,
    },
    /// Neither input nor sensors are among its columns.
    #[error("none of its columns is known; there are {0}")]
    NothingKnown(String),
}

pub(crate) enum StreamLine<'a> {
    /// It is empty, or a comment.
    Nothing,
    /// The entries of a JSON object.
    Object(Vec<(String, Document)>),
    /// Its cells, and the mark between them.
    Cells(Vec<&'a str>, char),
}

impl<'a> StreamLine<'a> {
    /// Reads cells between semicolons, tabs, commas or blanks, or a JSON object. Of a line without a header the mark is the first of
    /// these that it has.
    pub(crate) fn of(bytes: &'a [u8], mark: Option<char>) -> Result<Self, BadLine> {
        if bytes.len() > LONGEST {
            return Err(BadLine::TooLong);
        }
        // Programs of Windows begin a text with the mark of its byte order.
        let text = std::str::from_utf8(bytes).map_err(|_| BadLine::NoText)?.trim_start_matches('\u{feff}');
        // A tab at either end is an empty cell.
        let text = text.trim_matches(['\r', '\n', ' ']);
        match text.trim_start().chars().next() {
            None | Some('#') => Ok(Self::Nothing),
            Some('{') => match document::from_json(text) {
                Ok(Document::Object(entries)) => Ok(Self::Object(entries.into_iter().collect())),
                Ok(_) => Err(BadLine::NoJson("it ends too soon".to_owned())),
                Err(error) => Err(BadLine::NoJson(error.to_string())),
            },
            Some(_) => {
                // The comma comes last: between semicolons or tabs it may be a decimal comma.
                let mark = mark.or_else(|| [';', '\t', ','].into_iter().find(|mark| text.contains(*mark)));
                let mark = mark.unwrap_or(' ');
                let cells: Vec<&str> =
                    if mark == ' ' { text.split_whitespace().collect() } else { text.split(mark).collect() };
                Ok(Self::Cells(cells.into_iter().map(|cell| cell.trim().trim_matches('"')).collect(), mark))
            }
        }
    }
}

/// The number in a cell. A decimal comma may stand wherever commas do not divide cells.
pub(crate) fn number(cell: &str, mark: char) -> Option<f64> {
    let with_comma = || (mark != ',').then(|| cell.replacen(',', ".", 1).parse().ok()).flatten();
    cell.parse().ok().or_else(with_comma)
}

/// The number of an entry of an object; NaN for `null`.
pub(crate) fn number_of(value: &Document) -> Option<f64> {
    match value {
        Document::Null => Some(f64::NAN),
        other => other.as_f64(),
    }
}

/// Limits a line \[bytes\]; the rest of a longer one is skipped.
pub const LONGEST: usize = 65_536;

/// Reads a line without its end, of one byte more than [`LONGEST`] at most. Returns whether there was one.
///
/// # Errors
/// Those of the source.
pub fn read_line(input: &mut dyn BufRead, line: &mut Vec<u8>) -> io::Result<bool> {
    // Not `read_until`, which would take a stream without line ends into memory whole.
    line.clear();
    let mut some = false;
    loop {
        let buffer = match input.fill_buf() {
            // A signal, such as that of a resized terminal, is no end of the source.
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            buffer => buffer?,
        };
        if buffer.is_empty() {
            return Ok(some);
        }
        some = true;
        let end = buffer.iter().position(|byte| *byte == b'\n');
        let part = &buffer[..end.unwrap_or(buffer.len())];
        // One byte more than allowed is kept: by it the line is refused as too long, and not read as a shorter one.
        let room = (LONGEST + 1).saturating_sub(line.len());
        line.extend_from_slice(&part[..part.len().min(room)]);
        let read = end.map_or(buffer.len(), |end| end + 1);
        input.consume(read);
        if end.is_some() {
            return Ok(true);
        }
    }
}
