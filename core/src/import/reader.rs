//! Reads a file with columns of numbers, a slice after the other.

use super::table::{Column, Lines, Table, TextCell};
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
    columns: Vec<Column>,
    lines: Lines,
    short: Odd,
    long: Odd,
    text: String,
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
        if bytes.starts_with(b"MATLAB 5.0 MAT-file") || bytes.starts_with(b"\x89HDF") {
            return Err(ImportError::Matlab);
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
        let dialect = dialect
            .or_else(|| Dialect::sniff(encoding, &lines))
            .ok_or(ImportError::NoNumbers { lines: lines.len() })?;
        let first = lines.get(dialect.data.saturating_sub(1)).copied().unwrap_or_default();
        let mut width = dialect.delimiter.cells(first).count();
        // A delimiter that ends each line begins no column.
        let ends = |line: &&&str| dialect.delimiter.cells(line).nth(width - 1).is_none_or(str::is_empty);
        let data = lines.iter().skip(dialect.data.saturating_sub(1)).filter(|line| !line.trim().is_empty());
        if width > 1 && data.take(100).all(|line| ends(&line)) && named(&dialect, &lines, width) < width {
            width -= 1;
        }
        if width > MOST_COLUMNS {
            return Err(ImportError::TooManyColumns { line: dialect.data, found: width });
        }
        let mean = (whole.max(1) / lines.len().max(1)).max(1);
        let rows = (bytes.len() / mean.max(1)).min(bytes.len() / width.max(1) + 1);
        let header = unique(dialect.header(&lines, width));
        let column = |(name, unit)| Column { name, unit, values: Vec::with_capacity(rows + rows / 50), text: None };
        let columns = header.into_iter().map(column).collect();
        let (short, long) = Default::default();
        Ok(Self { bytes, place: start, line: 0, dialect, columns, lines: Lines::default(), short, long, text })
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
        let Self { dialect, mut columns, lines, short, long, line, .. } = self;
        if columns.iter().all(|column| column.values.iter().all(|value| value.is_nan())) {
            return Err(ImportError::NoNumbers { lines: line });
        }
        columns.iter_mut().for_each(|column| column.values.shrink_to_fit());
        let remarks = [
            short.remark("fewer cells than the others; what is missing counts as empty"),
            long.remark("more cells than the others; those at the end are left out"),
        ];
        Ok(Table { dialect, columns, remarks: remarks.into_iter().flatten().collect(), lines })
    }

    /// Reads a line. Returns whether there was one.
    fn read_line(&mut self) -> Result<bool, ImportError> {
        let Self { bytes, place, line, dialect, columns, lines, short, long, text } = self;
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
        let trimmed = row.trim();
        if trimmed.is_empty() || trimmed.starts_with(dialect::REMARKS) {
            return Ok(true);
        }
        let mut cells = dialect.delimiter.cells(row);
        let mut missing = false;
        for column in columns.iter_mut() {
            let cell = cells.next();
            missing |= cell.is_none();
            column.push(cell.unwrap_or_default(), dialect.decimal, *line);
        }
        if missing {
            short.note(*line);
        }
        if cells.any(|cell| !cell.is_empty()) {
            long.note(*line);
        }
        lines.push(columns[0].values.len() - 1, *line);
        Ok(true)
    }
}

/// The same headers with a number behind each name that there was before.
fn unique(mut header: Vec<(String, Option<String>)>) -> Vec<(String, Option<String>)> {
    for place in 1..header.len() {
        let (before, rest) = header.split_at_mut(place);
        let name = rest[0].0.clone();
        let mut number = 2;
        while before.iter().any(|(other, _)| *other == rest[0].0) {
            rest[0].0 = format!("{name} ({number})");
            number += 1;
        }
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
    fn push(&mut self, cell: &str, decimal: Decimal, line: usize) {
        let number = decimal.number(cell);
        if number.is_none() && self.text.is_none() {
            /// Limits the characters that a message quotes.
            const QUOTED: usize = 40;
            self.text = Some(TextCell { line, text: cell.chars().take(QUOTED).collect() });
        }
        self.values.push(number.unwrap_or(f64::NAN));
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
        let reserved: usize = reader.columns.iter().map(|column| column.values.capacity() * 8).sum();
        assert!(reserved < 2 * text.len(), "{reserved} for {}", text.len());
    }
}
