//! Reads a file with columns of numbers, a slice after the other.

use super::formats::{self, Layout};
use super::limits::LONGEST_LINE;
use super::rows_reader::RowsReader;
use super::series::SeriesReader;
use super::sound;
use super::{Dialect, Encoding, ImportError, Table};

/// Limits the bytes that are looked at to find the dialect.
const LOOK: usize = 65_536;

/// The number of lines between two checks of the clock.
const SLICE: usize = 256;

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
    /// A sound, which is read at once.
    Whole(Box<Table>),
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
        if sound::is_sound(&bytes) {
            let (place, dialect) = (bytes.len(), Dialect::default());
            let body = Body::Whole(Box::new(sound::table(&bytes)?));
            return Ok(Self { bytes, place, line: 0, dialect, format: None, body, text: String::new() });
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
            Body::Whole(table) => Ok(*table),
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
            Body::Whole(_) => {}
            Body::Series(series) => series.line(row, *line)?,
            Body::Rows(rows) => {
                rows.line(row, *line, *dialect);
                if rows.has_ended() {
                    *place = bytes.len();
                }
            }
        }
        Ok(true)
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
    fn utf_16_is_read_like_other_text() {
        let bytes: Vec<u8> = "\u{FEFF}t;µ\r\n0,5;1\r\n1;2,5\r\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
        let table = read(&bytes).unwrap();
        assert_eq!(table.columns[1].name, "µ");
        assert_eq!(table.columns[1].values, [1.0, 2.5]);
        assert_eq!(table.columns[0].values, [0.5, 1.0]);
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
