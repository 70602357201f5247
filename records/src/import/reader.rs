//! Reads a file of a record, a slice after the other: its columns and its hash.

use super::formats::{self, Layout, SeriesReader};
use super::mend::mend;
use super::table::RowsReader;
use super::{Dialect, Encoding, Hash, ImportError, LONGEST_LINE, Table};
use crate::task::Task;

const HEAD: usize = 65_536;

const SLICE: usize = 256;

#[derive(Debug)]
pub(super) struct Reader {
    bytes: Vec<u8>,
    place: usize,
    line: usize,
    dialect: Dialect,
    format: Option<&'static str>,
    body: Body,
    text: String,
}

#[derive(Debug)]
enum Body {
    Rows(Box<RowsReader>),
    Series(SeriesReader),
    Whole(Box<Table>),
}

impl Reader {
    pub(super) fn new(bytes: Vec<u8>, dialect: Option<Dialect>) -> Result<Self, ImportError> {
        if bytes.iter().all(u8::is_ascii_whitespace) {
            return Err(ImportError::Empty);
        }
        if let Some(table) = formats::read_binary(&bytes, dialect) {
            let (place, dialect) = (bytes.len(), Dialect::default());
            let body = Body::Whole(Box::new(table?));
            return Ok(Self { bytes, place, line: 0, dialect, format: None, body, text: String::new() });
        }
        let head = &bytes[..bytes.len().min(HEAD)];
        let encoding = match dialect {
            Some(dialect) => dialect.encoding,
            None => Encoding::sniff(head).ok_or(ImportError::Binary)?,
        };
        let head = match encoding.line_length(head) {
            Some(_) => head,
            None => &bytes[..bytes.len().min(LONGEST_LINE + 1)],
        };
        if encoding.line_length(head).is_none() && head.len() > LONGEST_LINE {
            return Err(ImportError::LongLine(1));
        }
        let start = encoding.mark(&bytes);
        let mut text = String::new();
        encoding.decode(&head[start..], &mut text);
        // The last line may be cut.
        let whole =
            if head.len() < bytes.len() { text.rfind('\n').map_or(text.len(), |end| end + 1) } else { text.len() };
        let lines: Vec<&str> = text[..whole].lines().collect();
        let found = if dialect.is_none() { formats::find(&lines) } else { None };
        let (format, layout) = match found {
            Some((name, layout)) => (Some(name), layout),
            None => {
                let dialect = dialect.or_else(|| Dialect::sniff(encoding, &lines));
                let dialect = dialect.ok_or(ImportError::NoNumbers(lines.len()))?;
                (None, Layout::Rows(formats::nameless(dialect, &lines)))
            }
        };
        let (dialect, body) = match layout {
            Layout::Series(next) => (Dialect { encoding, ..Dialect::default() }, Body::Series(SeriesReader::new(next))),
            Layout::Rows(mut rows) => {
                rows.dialect.encoding = encoding;
                (rows.dialect, Body::Rows(Box::new(RowsReader::new(rows, &lines, bytes.len())?)))
            }
        };
        Ok(Self { bytes, place: start, line: 0, dialect, format, body, text })
    }

    /// Calls `while_time` every hundred microseconds. Returns whether the file ends.
    pub(super) fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> Result<bool, ImportError> {
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

    pub(super) fn read(bytes: Vec<u8>, dialect: Option<Dialect>) -> Result<Table, ImportError> {
        let mut reader = Self::new(bytes, dialect)?;
        while !reader.advance(&mut || true)? {}
        reader.columns()
    }

    fn columns(self) -> Result<Table, ImportError> {
        let Self { dialect, format, body, line, .. } = self;
        match body {
            Body::Whole(table) => Ok(*table),
            Body::Series(series) => series.finish(format.unwrap_or_default(), dialect, line),
            Body::Rows(rows) => {
                let form = format.map_or_else(|| dialect.to_string(), |name| format!("{name}: {dialect}"));
                rows.finish(form, line)
            }
        }
    }

    fn read_line(&mut self) -> Result<bool, ImportError> {
        let Self { bytes, place, line, dialect, body, text, .. } = self;
        let rest = &bytes[*place..];
        if rest.is_empty() {
            return Ok(false);
        }
        let length = dialect.encoding.line_length(rest).unwrap_or(rest.len());
        *line += 1;
        if length > LONGEST_LINE {
            return Err(ImportError::LongLine(*line));
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
                rows.line(row, *line);
                if rows.end.is_some() {
                    *place = bytes.len();
                }
            }
        }
        Ok(true)
    }
}

/// A file that has been read.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The [`struct@Hash`] of its bytes.
    pub hash: String,
    /// Its columns.
    pub table: Table,
}

/// Reads a file's columns, in the dialect that it finds, and hashes its bytes.
///
/// ```
/// use kalmanscope_records::Task;
/// use kalmanscope_records::import::{Loading, hash};
/// # fn main() -> Result<(), kalmanscope_records::import::ImportError> {
/// let loaded = Loading::new(b"t;x\n0,0;1,5\n0,1;2\n".to_vec()).run()?;
/// assert_eq!(loaded.hash, hash(b"t;x\n0,0;1,5\n0,1;2\n"));
/// assert_eq!(loaded.table.columns[1].values, [1.5, 2.0]);
/// # Ok(())
/// # }
/// ```
#[derive(Debug)]
pub struct Loading {
    bytes: Option<Vec<u8>>,
    reader: Result<Reader, ImportError>,
    hash: Hash,
    hashed: usize,
}

impl Loading {
    /// A file's bytes, none of them read yet.
    pub fn new(bytes: Vec<u8>) -> Self {
        Self { bytes: Some(bytes), reader: Err(ImportError::Empty), hash: Hash::default(), hashed: 0 }
    }
}

impl Task for Loading {
    /// [`ImportError`] where the file is empty, not text, or without numbers.
    type Outcome = Result<Loaded, ImportError>;

    fn progress(&self) -> f64 {
        match &self.reader {
            Ok(reader) => reader.place as f64 / reader.bytes.len().max(1) as f64,
            Err(_) => f64::from(u8::from(self.bytes.is_none())),
        }
    }

    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        if let Some(bytes) = self.bytes.take() {
            self.reader = Reader::new(bytes, None);
        }
        let Ok(reader) = &mut self.reader else { return true };
        let is_read = reader.advance(while_time);
        self.hash.add(&reader.bytes[self.hashed..reader.place]);
        self.hashed = reader.place;
        is_read.unwrap_or_else(|error| {
            self.reader = Err(error);
            true
        })
    }

    fn finish(mut self) -> Self::Outcome {
        while !self.advance(&mut || true) {}
        Ok(Loaded { hash: self.hash.text(), table: mend(self.reader?.columns()?) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document;
    use crate::import::hash;

    fn read(bytes: &[u8]) -> Result<Table, ImportError> {
        let mut reader = Reader::new(bytes.to_vec(), None)?;
        while !reader.advance(&mut || false)? {}
        reader.columns().map(mend)
    }

    #[test]
    fn each_encoding_is_read() {
        let text = "t;µ\r\n0,5;1\r\n1;2,5\r\n";
        let utf_16: Vec<u8> = format!("\u{FEFF}{text}").encode_utf16().flat_map(u16::to_le_bytes).collect();
        let latin_1: Vec<u8> = text.chars().map(|c| u8::try_from(c).unwrap()).collect();
        for bytes in [text.as_bytes(), &utf_16, &latin_1] {
            let columns = read(bytes).unwrap().columns;
            assert_eq!(
                (columns[1].name.as_str(), &columns[0].values, &columns[1].values),
                ("µ", &vec![0.5, 1.0], &vec![1.0, 2.5])
            );
        }
    }

    #[test]
    fn what_is_no_table_is_said() {
        let message = |bytes: &[u8]| {
            let said = read(bytes).unwrap_err().to_string();
            assert_eq!(Loading::new(bytes.to_vec()).finish().unwrap_err().to_string(), said);
            said
        };
        assert_eq!(message(b""), "the file is empty");
        assert_eq!(message(b"\n \n"), "the file is empty");
        assert!(message(b"\x7FELF\x00\x01\x02\x03\x00\x00").contains("not text"));
        assert!(message(b"PK\x03\x04....").contains("ZIP"));
        assert!(message(b"a,b\nc,d\n").contains("no column of numbers"));
        let wide: String = vec!["1"; 1_000_000].join(",");
        assert_eq!(message(wide.as_bytes()), "line 1 is longer than 1 MB");
        let wide: String = (vec!["1"; 2000].join(",") + "\n").repeat(2);
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

    fn text() -> Vec<u8> {
        let row = |k: u32| format!("{},{:.6}\n{}", f64::from(k) * 0.01, f64::from(k).sin(), ["", "\n"][k as usize % 2]);
        let rows: String = (0..60_000).map(row).collect();
        format!("t [s],x [mm]\n{rows}600,oops,7\n").into_bytes()
    }

    #[test]
    fn a_file_in_slices_is_the_file_in_one_go() {
        let (mut loading, mut shares) = (Loading::new(text()), vec![0.0]);
        while !loading.advance(&mut || false) {
            shares.push(loading.progress());
        }
        assert!(shares.len() > 100 && shares.is_sorted() && shares[shares.len() - 1] < 1.0);
        let Loaded { hash: sum, table } = loading.finish().unwrap();
        assert_eq!(sum, hash(&text()));
        // NaN is not equal to itself.
        assert_eq!(format!("{table:?}"), format!("{:?}", read(&text()).unwrap()));
        assert_eq!(Loading::new(text()).finish().unwrap().hash, hash(&text()), "in one go");
    }

    #[test]
    fn a_table_can_be_sent_apart_from_its_numbers() {
        let table = read(&text()).unwrap();
        let mut sent: Table = document::read(&document::of(&table).unwrap()).unwrap();
        assert_eq!((sent.columns.len(), sent.rows(), sent.line(50_000)), (2, 0, table.line(50_000)));
        for (sent, column) in sent.columns.iter_mut().zip(&table.columns) {
            sent.values.clone_from(&column.values);
        }
        assert_eq!(format!("{sent:?}"), format!("{table:?}"));
    }
}
