//! Reads a file with columns of numbers, a slice after the other.

use super::formats::{self, Layout, Rows};
use super::number::Found;
use super::series::{SeriesReader, time_column};
use super::table::{Column, Lines, Table, TextCell, free_name};
use super::{Decimal, Dialect, Encoding, ImportError, dialect};

/// Limits the bytes that are looked at to find the dialect.
const LOOK: usize = 65_536;

/// Limits the columns of a file.
pub(super) const MOST_COLUMNS: usize = 1000;

/// The number of lines between two looks at the clock.
const SLICE: usize = 256;

/// Limits the bytes of one line.
const LONGEST_LINE: usize = 1_000_000;

/// A file that is being read.
///
/// The core has no clock: the caller decides when the time of a slice is up.
///
/// ```
/// use kalmanscope_core::import::Reader;
/// # fn main() -> Result<(), kalmanscope_core::import::ImportError> {
/// let mut reader = Reader::new(b"t;x\n0,0;1,5\n0,1;2\n".to_vec(), None)?;
/// while !reader.advance(&mut || true)? {}
/// let table = reader.finish()?;
/// assert_eq!(table.columns[1].values, [1.5, 2.0]);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Reader {
    bytes: Vec<u8>,
    place: usize,
    line: usize,
    dialect: Dialect,
    /// The name of the format, if the header says what the numbers are.
    format: Option<&'static str>,
    body: Body,
    text: String,
}

/// The parts that have been read.
#[derive(Debug)]
enum Body {
    Rows(RowsReader),
    Series(SeriesReader),
}

/// The rows of a table.
#[derive(Debug)]
struct RowsReader {
    columns: Vec<Column>,
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
    /// Numbers with thousands apart, and numbers that may have them, in a file whose first lines have none.
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

impl Reader {
    /// A file's bytes, to be read in the dialect given, or else in the one that is found.
    ///
    /// # Errors
    /// [`ImportError`] where the file is empty, not text, or without numbers.
    pub fn new(bytes: Vec<u8>, dialect: Option<Dialect>) -> Result<Self, ImportError> {
        if bytes.iter().all(u8::is_ascii_whitespace) {
            return Err(ImportError::Empty);
        }
        if bytes.starts_with(b"MATLAB 5.0 MAT-file") {
            return Err(ImportError::Matlab);
        }
        if bytes.starts_with(b"MATLAB 7.3 MAT-file") || bytes.starts_with(b"\x89HDF") {
            return Err(ImportError::Hdf5);
        }
        if bytes.starts_with(b"PAR1") {
            return Err(ImportError::Parquet);
        }
        if bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"\xD0\xCF\x11\xE0") {
            return Err(ImportError::Spreadsheet);
        }
        let head = &bytes[..bytes.len().min(LOOK)];
        let encoding = match dialect {
            Some(dialect) => dialect.encoding,
            None => Encoding::sniff(head).ok_or(ImportError::Binary)?,
        };
        let head = match encoding.line_length(head) {
            Some(_) => head,
            // The first line alone is longer.
            None => &bytes[..bytes.len().min(LONGEST_LINE + 1)],
        };
        if encoding.line_length(head).is_none() && head.len() > LONGEST_LINE {
            return Err(ImportError::LongLine { line: 1 });
        }
        let start = encoding.mark(&bytes);
        let mut text = String::new();
        encoding.decode(&head[start..], &mut text);
        // The last line may be cut.
        let whole =
            if head.len() < bytes.len() { text.rfind('\n').map_or(text.len(), |end| end + 1) } else { text.len() };
        let lines: Vec<&str> = text[..whole].lines().collect();
        let layout = if dialect.is_none() { formats::find(&lines) } else { None };
        let (format, layout) = layout.map_or((None, None), |(name, layout)| (Some(name), Some(layout)));
        let (dialect, body) = match layout {
            Some(Layout::Series(next)) => {
                (Dialect { encoding, ..Dialect::default() }, Body::Series(SeriesReader::new(next)))
            }
            Some(Layout::Rows(rows)) => {
                let dialect = Dialect { encoding, ..rows.dialect };
                (dialect, Body::Rows(RowsReader::new(dialect, &lines, bytes.len(), Some(rows))?))
            }
            None => {
                let found = dialect.or_else(|| Dialect::sniff(encoding, &lines));
                let dialect = found.ok_or(ImportError::NoNumbers { lines: lines.len() })?;
                (dialect, Body::Rows(RowsReader::new(dialect, &lines, bytes.len(), None)?))
            }
        };
        Ok(Self { bytes, place: start, line: 0, dialect, format, body, text })
    }

    /// The dialect in which the file is read.
    pub fn dialect(&self) -> Dialect {
        self.dialect
    }

    /// The share of the file that has been read, from 0 to 1.
    pub fn progress(&self) -> f64 {
        self.place as f64 / self.bytes.len().max(1) as f64
    }

    /// Reads on until `while_time` returns false, which is called about every hundred microseconds. Returns whether
    /// the file has been read to its end.
    ///
    /// # Errors
    /// [`ImportError::LongLine`] where a line has no end.
    pub fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> Result<bool, ImportError> {
        while self.place < self.bytes.len() {
            for _ in 0..SLICE {
                if !self.read_line()? {
                    break;
                }
            }
            if !while_time() {
                break;
            }
        }
        Ok(self.place >= self.bytes.len())
    }

    /// The columns that have been read.
    ///
    /// # Errors
    /// [`ImportError::NoNumbers`] where there are none.
    pub fn finish(self) -> Result<Table, ImportError> {
        let Self { dialect, format, body, line, .. } = self;
        match body {
            Body::Series(series) => series.finish(format.unwrap_or_default(), dialect, line),
            Body::Rows(rows) => {
                let form = format.map_or_else(|| dialect.to_string(), |name| format!("{name}: {dialect}"));
                rows.finish(dialect, form, line)
            }
        }
    }

    /// Reads a line. Returns whether there was one.
    fn read_line(&mut self) -> Result<bool, ImportError> {
        let Self { bytes, place, line, dialect, body, text, .. } = self;
        let rest = &bytes[*place..];
        if rest.is_empty() {
            return Ok(false);
        }
        let length = dialect.encoding.line_length(rest).unwrap_or(rest.len());
        *line += 1;
        if length > LONGEST_LINE {
            return Err(ImportError::LongLine { line: *line });
        }
        *place += length;
        if *line < dialect.data {
            return Ok(true);
        }
        let raw = &rest[..length];
        let row = match (dialect.encoding, std::str::from_utf8(raw)) {
            (Encoding::Utf8 | Encoding::Latin1, Ok(row)) => row,
            _ => {
                text.clear();
                dialect.encoding.decode(raw, text);
                text
            }
        };
        match body {
            Body::Series(series) => series.line(row, *line)?,
            Body::Rows(rows) => {
                rows.line(row, *line, *dialect);
                if rows.end.is_some() {
                    *place = bytes.len();
                }
            }
        }
        Ok(true)
    }
}

impl RowsReader {
    /// The columns of a table in a file of some length that begins with some lines: of known rows, or as its header tells.
    fn new(dialect: Dialect, lines: &[&str], length: usize, known: Option<Rows>) -> Result<Self, ImportError> {
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

    fn line(&mut self, row: &str, line: usize, dialect: Dialect) {
        let Self { columns, belongs, even: _, ends, end, lines, short, long, grouped, doubtful } = self;
        let trimmed = row.trim();
        if trimmed.is_empty() || trimmed.starts_with(dialect::REMARKS) {
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

    fn finish(self, dialect: Dialect, form: String, line: usize) -> Result<Table, ImportError> {
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
    /// Takes the number in a cell. Returns whether it has thousands apart.
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
    use super::*;

    fn read(bytes: &[u8]) -> Result<Table, ImportError> {
        let mut reader = Reader::new(bytes.to_vec(), None)?;
        while !reader.advance(&mut || false)? {}
        reader.finish()
    }

    #[test]
    fn a_trailing_delimiter_begins_no_column() {
        let table = read(b"\"V1\",\"V2\",\n0.1,0.2,\n0.3,0.4,\n").unwrap();
        assert_eq!(table.columns.len(), 2);
        assert_eq!(table.columns[1].name, "V2");
        assert_eq!(table.columns[1].values, [0.2, 0.4]);
        let empty = read(b"a,b,c\n0.1,0.2,\n0.3,0.4,\n").unwrap();
        assert_eq!(empty.columns.len(), 3, "a column that is empty so far has a name");
    }

    #[test]
    fn names_that_stand_twice_are_numbered() {
        let table = read(b"x,x,t,x\n1,2,3,4\n5,6,7,8\n").unwrap();
        let names: Vec<&str> = table.columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(names, ["x", "x (2)", "t", "x (3)"]);
    }

    #[test]
    fn utf_16_is_read_like_other_text() {
        let bytes: Vec<u8> = "\u{FEFF}t;µ\r\n0,5;1\r\n1;2,5\r\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
        let table = read(&bytes).unwrap();
        assert_eq!(table.columns[1].name, "µ");
        assert_eq!(table.columns[1].values, [1.0, 2.5]);
        assert_eq!(table.columns[0].values, [0.5, 1.0]);
    }

    #[test]
    fn ragged_rows_and_text_are_noted_with_their_lines() {
        let table = read(b"t,x\n0,1\n1\n\n# note\n2,3,4\n3,oops\n4,5\n").unwrap();
        assert_eq!(table.rows(), 5);
        assert_eq!(table.remarks.len(), 2);
        assert!(table.remarks[0].starts_with("line 3 has fewer cells"), "{:?}", table.remarks);
        assert!(table.remarks[1].starts_with("line 6 has more cells"), "{:?}", table.remarks);
        let text = table.columns[1].text.clone().unwrap();
        assert_eq!((text.line, text.text.as_str()), (7, "oops"));
        assert_eq!(table.line(4), 8);
        assert!(table.columns[1].values[1].is_nan());
    }

    #[test]
    fn what_is_no_table_is_said() {
        let message = |bytes: &[u8]| read(bytes).unwrap_err().to_string();
        assert_eq!(message(b""), "the file is empty");
        assert_eq!(message(b"\n \n"), "the file is empty");
        assert!(message(b"\x7FELF\x00\x01\x02\x03\x00\x00").contains("not text"));
        assert!(message(b"PK\x03\x04....").contains("save the sheet as CSV"));
        assert!(message(b"a,b\nc,d\n").contains("no column of numbers"));
        let wide: String = vec!["1"; 1_000_000].join(",");
        assert_eq!(message(wide.as_bytes()), "line 1 is longer than 1 MB");
        let wide: String = vec!["1"; 2000].join(",");
        assert_eq!(message(wide.as_bytes()), "line 1 has 2000 cells, but at most 1000 columns can be read");
    }

    #[test]
    fn the_memory_of_the_columns_is_that_of_their_numbers() {
        let mut text = "t,x\n".to_owned();
        (0..10_000).for_each(|k| text.push_str(&format!("{:.4},{:.6}\n", f64::from(k) * 0.01, f64::from(k).sin())));
        let reader = Reader::new(text.clone().into_bytes(), None).unwrap();
        let Body::Rows(rows) = &reader.body else { panic!("a table") };
        let reserved: usize = rows.columns.iter().map(|column| column.values.capacity() * 8).sum();
        assert!(reserved < 2 * text.len(), "{reserved} for {}", text.len());
    }
}
