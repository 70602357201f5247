//! Columns of numbers, as a file has them.

use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

use super::Dialect;
use super::unit::name_and_unit;

/// The columns of a file. A document of it has all but the numbers, which are too many for a text.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// The file's form.
    pub dialect: Dialect,
    /// The file's form in one line: the format, if its header says what its numbers are, and the dialect.
    pub form: String,
    /// The columns, all of the same length.
    pub columns: Vec<Column>,
    /// Sentences about rows that were not as expected.
    pub remarks: Vec<String>,
    pub(super) lines: Lines,
}

/// A column of a file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Column {
    /// The name in the header, or `column 1` and so on.
    pub name: String,
    /// The unit in the header.
    pub unit: Option<String>,
    /// The numbers, in the file's unit; NaN where a cell is empty or has other text.
    #[serde(skip)]
    pub values: Vec<f64>,
    /// The first cell with text that is not a number.
    pub text: Option<TextCell>,
    /// The first cell with a word that says that its reading failed, such as `OVLD`. It counts as missing.
    pub word: Option<TextCell>,
    /// The number of cells with such a word.
    pub words: usize,
    /// Whether a cell is a time of day without a date.
    pub is_time_of_day: bool,
    /// Whether a cell is a date with a time of day.
    pub is_dated: bool,
}

/// A cell with text that is not a number.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TextCell {
    /// Line of the file, counted from 1.
    pub line: usize,
    /// The text.
    pub text: String,
}

impl Column {
    /// A column of numbers, with the name and unit of its header; `unit` is the one that the file gives separately.
    pub fn of_header(header: &str, unit: Option<&str>, values: Vec<f64>) -> Self {
        let (name, own) = name_and_unit(header);
        Self { name, unit: unit.map(str::to_owned).or(own), values, ..Self::default() }
    }
}

impl Table {
    /// A table of columns of the same length that are no text; `form` says what file they come from.
    pub fn of_columns(form: &str, columns: Vec<Column>, remarks: Vec<String>) -> Self {
        let mut lines = Lines::default();
        lines.push(0, 1);
        Self { dialect: Dialect::default(), form: form.to_owned(), columns, remarks, lines }
    }

    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// The line of a row in the file, counted from 1.
    pub fn line(&self, row: usize) -> usize {
        self.lines.of(row)
    }

    /// The place of a column, by its name as it is, or without regard to case.
    pub fn place(&self, name: &str) -> Option<usize> {
        let exact = self.columns.iter().position(|column| column.name == name);
        exact.or_else(|| self.columns.iter().position(|column| column.name.eq_ignore_ascii_case(name)))
    }

    /// The numbers as CSV, with the units in the header; cells without a number are empty.
    pub fn csv(&self) -> String {
        let mut text = self.csv_header();
        self.csv_rows(0..self.rows(), &mut text);
        text
    }

    /// The first line of [`Self::csv`].
    pub fn csv_header(&self) -> String {
        let name = |column: &Column| {
            let name = match column.unit.as_deref() {
                Some(unit) if !unit.is_empty() => format!("{} [{unit}]", column.name),
                _ => column.name.clone(),
            };
            if name.contains([',', '"']) { format!("\"{}\"", name.replace('"', "\"\"")) } else { name }
        };
        self.columns.iter().map(name).collect::<Vec<_>>().join(",") + "\n"
    }

    /// Appends some rows of [`Self::csv`] to a text.
    pub fn csv_rows(&self, rows: std::ops::Range<usize>, text: &mut String) {
        for row in rows {
            for (place, column) in self.columns.iter().enumerate() {
                let comma = if place > 0 { "," } else { "" };
                // A text takes whatever is written.
                let _ = match column.values[row] {
                    value if value.is_finite() => write!(text, "{comma}{value}"),
                    _ => write!(text, "{comma}"),
                };
            }
            text.push('\n');
        }
    }

    /// Whether every cell of a column is empty or text.
    pub fn is_without_numbers(&self, place: usize) -> bool {
        self.columns[place].values.iter().all(|value| value.is_nan())
    }
}

/// A name with a number behind it if it is taken.
pub(super) fn free_name(name: &str, is_taken: impl Fn(&str) -> bool) -> String {
    let numbered = (2..).map(|number| format!("{name} ({number})"));
    std::iter::once(name.to_owned()).chain(numbered).find(|name| !is_taken(name)).unwrap_or_default()
}

/// The lines of rows: blocks of rows without a line between them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Lines {
    /// The first row of each block, and its line.
    blocks: Vec<(usize, usize)>,
    /// The line of all rows behind the last one that has a line, if there are any.
    last: Option<usize>,
}

impl Lines {
    pub(super) fn push(&mut self, row: usize, line: usize) {
        if self.blocks.last().is_none_or(|&(first, start)| start + (row - first) != line) {
            self.blocks.push((row, line));
        }
    }

    /// Gives all rows from the one at `rows` on the line of the row before it.
    pub(super) fn end(&mut self, rows: usize) {
        self.last = rows.checked_sub(1).map(|row| self.of(row));
    }

    fn of(&self, row: usize) -> usize {
        let block = self.blocks.partition_point(|&(first, _)| first <= row).checked_sub(1);
        let line = block.map_or(0, |block| self.blocks[block].1 + (row - self.blocks[block].0));
        self.last.map_or(line, |last| line.min(last))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_known_for_each_row() {
        let mut lines = Lines::default();
        for (row, line) in [2, 3, 4, 7, 8, 20].into_iter().enumerate() {
            lines.push(row, line);
        }
        assert_eq!(lines.blocks.len(), 3);
        assert_eq!((0..6).map(|row| lines.of(row)).collect::<Vec<_>>(), [2, 3, 4, 7, 8, 20]);
        assert_eq!(lines.of(100), 20 + 95);
        lines.end(6);
        assert_eq!((lines.of(5), lines.of(100)), (20, 20));
    }
}
