//! Reads the rows of a table.

use super::formats::Rows;
use super::limits::MOST_COLUMNS;
use super::number::Found;
use super::series::time_column;
use super::sniff::REMARKS;
use super::table::{Column, Lines, Table, TextCell, free_name};
use super::{Decimal, Dialect, ImportError};

/// The rows of a table, as they are read.
#[derive(Debug)]
pub(super) struct RowsReader {
    pub(super) columns: Vec<Column>,
    /// Whether the cell of a row belongs to a column.
    belongs: Vec<bool>,
    /// The first time and the step of rows without times.
    even: Option<(f64, f64)>,
    ends: fn(&str) -> bool,
    /// The line that begins another table.
    end: Option<usize>,
    lines: Lines,
    short: Odd,
    long: Odd,
    /// Numbers with thousands separators, and numbers that may have them, in a file without any in its first lines.
    grouped: Odd,
    doubtful: Odd,
}

/// Rows that are not as expected: the first line, and how many there are.
#[derive(Debug, Default)]
struct Odd {
    first: usize,
    count: usize,
}

impl Odd {
    fn note(&mut self, line: usize) {
        if self.count == 0 {
            self.first = line;
        }
        self.count += 1;
    }

    fn remark(&self, what: &str) -> Option<String> {
        match self.count {
            0 => None,
            1 => Some(format!("line {} has {what}", self.first)),
            count => Some(format!("{count} lines have {what}, the first is line {}", self.first)),
        }
    }
}

impl RowsReader {
    /// The columns of a table in a file of some length that begins with some lines: those of known rows, or those of
    /// its header.
    pub(super) fn new(
        dialect: Dialect,
        lines: &[&str],
        length: usize,
        known: Option<Rows>,
    ) -> Result<Self, ImportError> {
        let (cells, even, ends) = match known {
            Some(Rows { cells, even, ends, .. }) => (cells, even, ends),
            None => (Vec::new(), None, (|_| false) as fn(&str) -> bool),
        };
        let (belongs, header) = if cells.is_empty() {
            let width = width(&dialect, lines)?;
            (vec![true; width], dialect.header(lines, width))
        } else {
            (cells.iter().map(Option::is_some).collect(), cells.into_iter().flatten().collect())
        };
        // Columns are set aside for as many rows as the first lines let expect.
        let whole: usize = lines.iter().map(|line| line.len() + 1).sum();
        let mean = (whole.max(1) / lines.len().max(1)).max(1);
        let rows = (length / mean).min(length / belongs.len().max(1) + 1);
        let column =
            |(name, unit)| Column { name, unit, values: Vec::with_capacity(rows + rows / 50), ..Column::default() };
        let columns = unique(header).into_iter().map(column).collect();
        let (lines, short, long, grouped, doubtful) = Default::default();
        Ok(Self { columns, belongs, even, ends, end: None, lines, short, long, grouped, doubtful })
    }

    /// Reads a line.
    pub(super) fn line(&mut self, row: &str, line: usize, dialect: Dialect) {
        let Self { columns, belongs, even: _, ends, end, lines, short, long, grouped, doubtful } = self;
        let trimmed = row.trim();
        if trimmed.is_empty() || trimmed.starts_with(REMARKS) {
            return;
        }
        if ends(row) {
            *end = Some(line);
            return;
        }
        let mut cells = dialect.delimiter.cells(row);
        let mut missing = false;
        let mut kept = columns.iter_mut();
        for &belongs in belongs.iter() {
            let cell = cells.next();
            if belongs && let Some(column) = kept.next() {
                missing |= cell.is_none();
                let cell = cell.unwrap_or_default();
                if column.push(cell, dialect, line) {
                    grouped.note(line);
                } else if dialect.decimal == Decimal::Comma && cell.contains('.') {
                    doubtful.note(line);
                }
            }
        }
        if missing {
            short.note(line);
        }
        if cells.any(|cell| !cell.is_empty()) {
            long.note(line);
        }
        if let Some(column) = columns.first() {
            lines.push(column.values.len() - 1, line);
        }
    }

    /// Whether another table has begun.
    pub(super) fn has_ended(&self) -> bool {
        self.end.is_some()
    }

    /// The table.
    pub(super) fn finish(self, dialect: Dialect, form: String, line: usize) -> Result<Table, ImportError> {
        let Self { mut columns, even, end, lines, short, long, grouped, doubtful, .. } = self;
        if columns.iter().all(|column| column.values.iter().all(|value| value.is_nan())) {
            return Err(ImportError::NoNumbers { lines: line });
        }
        columns.iter_mut().for_each(|column| column.values.shrink_to_fit());
        let late = (grouped.count > 0 && doubtful.count > 0 && !dialect.thousands).then(|| {
            format!(
                "line {} has thousands apart, but line {} has a point that was taken for a decimal one, as the first lines \
                 have no thousands: state `thousands = true` in the dialect",
                grouped.first, doubtful.first
            )
        });
        let remarks = [
            short.remark("fewer cells than the others; what is missing counts as empty"),
            long.remark("more cells than the others; those at the end are left out"),
            end.map(|line| format!("line {line} begins another table; it is left out, with all below it")),
            late,
        ];
        if let Some((start, step)) = even {
            let rows = columns.first().map_or(0, |column| column.values.len());
            columns.insert(0, time_column((0..rows).map(|k| start + k as f64 * step).collect()));
        }
        Ok(Table { dialect, form, columns, remarks: remarks.into_iter().flatten().collect(), lines })
    }
}

/// The number of columns in a dialect.
fn width(dialect: &Dialect, lines: &[&str]) -> Result<usize, ImportError> {
    let first = lines.get(dialect.data.saturating_sub(1)).copied().unwrap_or_default();
    let mut width = dialect.delimiter.cells(first).count();
    // A delimiter that ends each line begins no column.
    let ends = |line: &&&str| dialect.delimiter.cells(line).nth(width - 1).is_none_or(str::is_empty);
    let data = lines.iter().skip(dialect.data.saturating_sub(1)).filter(|line| !line.trim().is_empty());
    if width > 1 && data.take(100).all(|line| ends(&line)) && named(dialect, lines, width) < width {
        width -= 1;
    }
    if width > MOST_COLUMNS {
        return Err(ImportError::TooManyColumns { line: dialect.data, found: width });
    }
    Ok(width)
}

/// The same headers with a number behind each name that there was before.
fn unique(mut header: Vec<(String, Option<String>)>) -> Vec<(String, Option<String>)> {
    for place in 1..header.len() {
        let (before, rest) = header.split_at_mut(place);
        rest[0].0 = free_name(&rest[0].0, |name| before.iter().any(|(other, _)| other == name));
    }
    header
}

/// The number of named columns.
fn named(dialect: &Dialect, lines: &[&str], width: usize) -> usize {
    if dialect.names == 0 {
        return 0;
    }
    let header = dialect.header(lines, width);
    let unnamed = |place: &usize| header[*place].0 == format!("column {}", place + 1);
    (0..width).rev().find(|place| !unnamed(place)).map_or(0, |place| place + 1)
}

impl Column {
    /// Takes the number in a cell. Returns whether it has thousands separators.
    fn push(&mut self, cell: &str, dialect: Dialect, line: usize) -> bool {
        let found = dialect.decimal.read(cell, dialect.thousands);
        let quoted = || {
            /// Limits the characters that a message quotes.
            const QUOTED: usize = 40;
            TextCell { line, text: cell.chars().take(QUOTED).collect() }
        };
        match found {
            Found::Number(_) | Found::Grouped(_) | Found::Missing => {}
            Found::Clock { is_dated, .. } => {
                self.is_time_of_day |= !is_dated;
                self.is_dated |= is_dated;
            }
            Found::Word => {
                self.word.get_or_insert_with(quoted);
                self.words += 1;
            }
            Found::Text => {
                self.text.get_or_insert_with(quoted);
            }
        }
        self.values.push(found.value());
        matches!(found, Found::Grouped(_))
    }
}

#[cfg(test)]
mod tests {
    use super::super::read;

    #[test]
    fn a_trailing_delimiter_begins_no_column() {
        let table = read(&b"\"V1\",\"V2\",\n0.1,0.2,\n0.3,0.4,\n"[..], None).unwrap();
        assert_eq!(table.columns.len(), 2);
        assert_eq!(table.columns[1].name, "V2");
        assert_eq!(table.columns[1].values, [0.2, 0.4]);
        let empty = read(&b"a,b,c\n0.1,0.2,\n0.3,0.4,\n"[..], None).unwrap();
        assert_eq!(empty.columns.len(), 3, "a column that is empty so far has a name");
    }

    #[test]
    fn names_that_stand_twice_are_numbered() {
        let table = read(&b"x,x,t,x\n1,2,3,4\n5,6,7,8\n"[..], None).unwrap();
        let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(names, ["x", "x (2)", "t", "x (3)"]);
    }

    #[test]
    fn ragged_rows_and_text_are_noted_with_their_lines() {
        let table = read(&b"t,x\n0,1\n1\n\n# note\n2,3,4\n3,oops\n4,5\n"[..], None).unwrap();
        assert_eq!(table.rows(), 5);
        assert_eq!(table.remarks.len(), 2);
        assert!(table.remarks[0].starts_with("line 3 has fewer cells"), "{:?}", table.remarks);
        assert!(table.remarks[1].starts_with("line 6 has more cells"), "{:?}", table.remarks);
        let text = table.columns[1].text.clone().unwrap();
        assert_eq!((text.line, text.text.as_str()), (7, "oops"));
        assert_eq!(table.line(4), 8);
        assert!(table.columns[1].values[1].is_nan());
    }
}
