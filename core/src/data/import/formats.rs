//! Formats with a header that says what their numbers are. They are tried before a dialect is looked for.
//!
//! A format is a row of [`FORMATS`]: it recognises a file by its first lines, and says how its lines are laid out. Either they are
//! rows of a table with known columns, or series of numbers one after the other, each wrapped over lines.

mod cosmos;
mod lvm;
mod peer;
mod rigol;
mod slist;
mod tektronix;
mod toa5;
mod uff58;

use super::series::Next;
use super::{Decimal, Delimiter, Dialect};

/// The layout of the numbers below a header.
#[derive(Debug)]
pub(super) enum Layout {
    /// A table.
    Rows(Rows),
    /// Series of numbers; the function reads their headers.
    Series(Next),
}

/// A table with known columns.
#[derive(Debug)]
pub(super) struct Rows {
    /// The delimiter, the decimal character, and the first line of numbers.
    pub(super) dialect: Dialect,
    /// The name and unit of each cell of a row. `None` if a cell belongs to no column. Empty if lines of the dialect
    /// have names and units.
    pub(super) cells: Vec<Option<(String, Option<String>)>>,
    /// The first time and the step \[s\] of rows without times.
    pub(super) even: Option<(f64, f64)>,
    /// Whether a line begins another table, which is not read.
    pub(super) ends: fn(&str) -> bool,
}

impl Rows {
    /// A table with commas between cells and decimal points. `data` is the first line of numbers, counted from 1.
    fn new(data: usize) -> Self {
        let dialect = Dialect { delimiter: Delimiter::Comma, decimal: Decimal::Point, data, ..Dialect::default() };
        Self { dialect, cells: Vec::new(), even: None, ends: |_| false }
    }
}

/// A format.
struct Format {
    name: &'static str,
    /// The layout of a file that begins with these lines, if it has this format.
    find: fn(&[&str]) -> Option<Layout>,
}

const FORMATS: [Format; 8] = [
    Format { name: "PEER (AT2)", find: peer::find },
    Format { name: "strong motion (CSMIP, COSMOS)", find: cosmos::find },
    Format { name: "SLIST", find: slist::find },
    Format { name: "universal file, data set 58", find: uff58::find },
    Format { name: "LabVIEW measurement", find: lvm::find },
    Format { name: "Campbell TOA5", find: toa5::find },
    Format { name: "Rigol", find: rigol::find },
    Format { name: "Tektronix", find: tektronix::find },
];

/// The name and layout of the format of a file that begins with these lines, if it is a known one.
pub(super) fn find(lines: &[&str]) -> Option<(&'static str, Layout)> {
    FORMATS.iter().find_map(|format| Some((format.name, (format.find)(lines)?)))
}

/// The first number behind a word, without regard to case: 0.005 in `DT= .0050 SEC` behind `DT=`.
fn number_after(line: &str, word: &str) -> Option<f64> {
    let place = line.to_ascii_lowercase().find(&word.to_ascii_lowercase())? + word.len();
    let rest = line.get(place..)?.trim_start();
    let end = rest.find(|c: char| !(c.is_ascii_digit() || "+-.eE".contains(c))).unwrap_or(rest.len());
    rest[..end].trim_end_matches(['e', 'E', '.']).parse().ok()
}

/// The text behind a word up to one of some characters, without the blanks around it.
fn text_after<'a>(line: &'a str, word: &str, ends: &[char]) -> Option<&'a str> {
    let place = line.to_ascii_lowercase().find(&word.to_ascii_lowercase())? + word.len();
    let text = line.get(place..)?.split(ends).next()?.trim();
    (!text.is_empty()).then_some(text)
}

/// The width of the fields of a Fortran format such as `(8f10.5)`.
fn field_width(line: &str) -> Option<usize> {
    let inner = line.rsplit_once('(')?.1.trim_start_matches(|c: char| c.is_ascii_digit());
    let width = inner.strip_prefix(|c: char| "fFeEgGiI".contains(c))?;
    let end = width.find(|c: char| !c.is_ascii_digit()).unwrap_or(width.len());
    width[..end].parse().ok().filter(|width| (1..=80).contains(width))
}

#[cfg(test)]
mod tests {
    use super::super::{Table, read};
    use super::*;

    /// The table of a file in some format, and the names of its columns.
    #[track_caller]
    pub(super) fn table_of(text: &str) -> (Table, Vec<String>) {
        let table = read(text.as_bytes(), None).unwrap();
        let names = table.columns.iter().map(|column| column.name.clone()).collect();
        (table, names)
    }

    #[test]
    fn words_and_numbers_of_headers_are_found() {
        assert_eq!(number_after("NPTS=  7807, DT=   .0050 SEC,", "dt="), Some(0.005));
        assert_eq!(number_after("at 0.010 sec.", "at"), Some(0.01));
        assert_eq!(number_after("DT", "dt"), None);
        assert_eq!(text_after("units=cm/sec2(04),Format=(1E15.6)", "units=", &['(', ',']), Some("cm/sec2"));
        assert_eq!([field_width("in cm/sec2. (8f10.5)"), field_width("Format=(1E15.6)")], [Some(10), Some(15)]);
        assert_eq!([field_width("(10I8)"), field_width("(x)"), field_width("f10")], [Some(8), None, None]);
    }

    #[test]
    fn usual_tables_have_no_format() {
        for text in
            ["t,x\n0,1\n1,2\n", "X,CH1\n0,1\n", "Record Length\n1\n", "NPTS and DT of this file:\n1 2\n", "-1\n2\n3\n"]
        {
            let lines: Vec<&str> = text.lines().collect();
            assert!(find(&lines).is_none(), "{text}");
        }
    }
}
