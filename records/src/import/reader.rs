//! Reads a file of a record, a slice after the other: its columns and its hash.

use super::formats::{self, Layout, SeriesReader};
use super::mend::mend;
use super::table::RowsReader;
use super::{Dialect, Encoding, Hash, ImportError, LONGEST_LINE, Result, Table};
use crate::task::{Progress, Work, pause};

const HEAD: usize = 65_536;

enum Body {
    Rows(Box<RowsReader>),
    Series(SeriesReader),
}

pub(super) async fn read(bytes: &[u8], dialect: Option<Dialect>, progress: &Progress) -> Result<Table> {
    if bytes.iter().all(u8::is_ascii_whitespace) {
        return Err(ImportError::Empty);
    }
    if let Some(table) = formats::read_binary(bytes, dialect) {
        return table;
    }
    let (Dialect { encoding, data, .. }, mut body) = begin(bytes, dialect)?;
    let (mut place, mut line, mut text) = (encoding.mark(bytes), 0, String::new());
    while place < bytes.len() {
        if line % 256 == 0 {
            progress.set(place as f64 / bytes.len() as f64);
            pause().await;
        }
        let rest = &bytes[place..];
        let length = encoding.line_length(rest).unwrap_or(rest.len());
        line += 1;
        if length > LONGEST_LINE {
            return Err(ImportError::LongLine(line));
        }
        place += length;
        if line < data {
            continue;
        }
        let raw = &rest[..length];
        let row = match (encoding, std::str::from_utf8(raw)) {
            (Encoding::Utf8 | Encoding::Latin1, Ok(row)) => row,
            _ => {
                text.clear();
                encoding.decode(raw, &mut text);
                &text
            }
        };
        match &mut body {
            Body::Series(series) => series.line(row, line)?,
            Body::Rows(rows) => {
                rows.line(row, line);
                if rows.end.is_some() {
                    break;
                }
            }
        }
    }
    match body {
        Body::Series(series) => series.finish(line),
        Body::Rows(rows) => rows.finish(line),
    }
}

fn begin(bytes: &[u8], dialect: Option<Dialect>) -> Result<(Dialect, Body)> {
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
    let mut text = String::new();
    encoding.decode(&head[encoding.mark(bytes)..], &mut text);
    // The last line may be cut.
    let whole = if head.len() < bytes.len() { text.rfind('\n').map_or(text.len(), |end| end + 1) } else { text.len() };
    let lines: Vec<&str> = text[..whole].lines().collect();
    let found = if dialect.is_none() { formats::find(&lines) } else { None };
    let (format, mut rows) = match found {
        Some((name, Layout::Series(next))) => {
            let dialect = Dialect { encoding, ..Dialect::default() };
            return Ok((dialect, Body::Series(SeriesReader::new(name, dialect, next))));
        }
        Some((name, Layout::Rows(rows))) => (Some(name), rows),
        None => {
            let dialect = dialect.or_else(|| Dialect::sniff(encoding, &lines));
            (None, formats::nameless(dialect.ok_or(ImportError::NoNumbers(lines.len()))?, &lines))
        }
    };
    rows.dialect.encoding = encoding;
    Ok((rows.dialect, Body::Rows(Box::new(RowsReader::new(format, rows, &lines, bytes.len())?))))
}

/// A file that has been read.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The [`struct@Hash`] of its bytes.
    pub hash: String,
    /// Its columns.
    pub table: Table,
}

/// Begins to read a file's columns, in the dialect that it finds, and to hash its bytes.
///
/// ```
/// use kalmanscope_records::Task;
/// use kalmanscope_records::import::{hash, load};
/// # fn main() -> Result<(), kalmanscope_records::import::ImportError> {
/// let loaded = load(b"t;x\n0,0;1,5\n0,1;2\n".to_vec()).run()?;
/// assert_eq!(loaded.hash, hash(b"t;x\n0,0;1,5\n0,1;2\n"));
/// assert_eq!(loaded.table.columns[1].values, [1.5, 2.0]);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// [`ImportError`] where the file is empty, not text, or without numbers.
pub fn load(bytes: Vec<u8>) -> Work<Result<Loaded>> {
    Work::new(async move |progress: Progress| {
        let table = mend(read(&bytes, None, &progress).await?);
        let mut hash = Hash::default();
        for part in bytes.chunks(HEAD) {
            hash.add(part);
            pause().await;
        }
        Ok(Loaded { hash: hash.text(), table })
    })
}
