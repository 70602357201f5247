//! Formats with a header that describes their numbers: rows of a table, or series; and files that are no text, by their first bytes.

mod arrays;
mod rows;
mod series;
mod unpack;

use super::cell::Content;
use super::header::number_after;
use super::table::{Column, Lines, Rows, TextCell, number_names};
use super::{Decimal, Dialect, ImportError, MOST, Result, Table, sound};

pub(super) use rows::nameless;

use unpack::{gzip, has_entry, is_zip, whole, zip};

#[derive(Debug)]
pub(super) enum Layout {
    Rows(Rows),
    Series(Next),
}

type Is = fn(&[&str]) -> bool;

type FindRows = fn(&[&str]) -> Option<Rows>;

const SERIES: [(&str, Is, Next); 5] = [
    ("PEER (AT2)", |lines| lines.iter().take(6).any(|line| series::size(line).is_some()), series::peer),
    ("strong motion (CSMIP, COSMOS)", series::is_strong_motion, series::strong_motion),
    ("SLIST", |lines| lines[0].starts_with("TIMESERIES ") && lines[0].contains(", SLIST,"), series::slist),
    ("universal file, data set 58", series::is_uff58, series::uff58),
    ("SAC", series::is_sac, series::sac),
];

const ROWS: [(&str, FindRows); 4] = [
    ("LabVIEW measurement", rows::lvm),
    ("Campbell TOA5", rows::toa5),
    ("Rigol", rows::rigol),
    ("Tektronix", rows::tektronix),
];

pub(super) fn find(lines: &[&str]) -> Option<(&'static str, Layout)> {
    let series = SERIES.iter().find(|(_, is, _)| !lines.is_empty() && is(lines));
    let rows = || ROWS.iter().find_map(|(name, rows)| Some((*name, Layout::Rows(rows(lines)?))));
    series.map(|(name, _, next)| (*name, Layout::Series(*next))).or_else(rows)
}

fn text_after<'a>(line: &'a str, word: &str, ends: &[char]) -> Option<&'a str> {
    let place = line.to_ascii_lowercase().find(&word.to_ascii_lowercase())? + word.len();
    let text = line.get(place..)?.split(ends).next()?.trim();
    (!text.is_empty()).then_some(text)
}

fn field_width(line: &str) -> Option<usize> {
    let inner = line.rsplit_once('(')?.1.trim_start_matches(|c: char| c.is_ascii_digit());
    let width = inner.strip_prefix(|c: char| "fFeEgGiI".contains(c))?;
    let end = width.find(|c: char| !c.is_ascii_digit()).unwrap_or(width.len());
    width[..end].parse().ok().filter(|width| (1..=80).contains(width))
}

/// From all lines so far that are no numbers. The last line may end the header.
pub(super) type Next = fn(&[String]) -> Option<Series>;

#[derive(Clone, Debug, Default)]
pub(super) struct Series {
    pub(super) name: String,
    pub(super) unit: Option<String>,
    /// \[s\]
    pub(super) start: f64,
    pub(super) dt: f64,
    pub(super) count: Option<usize>,
    pub(super) width: Option<usize>,
    pub(super) no_record: Option<&'static str>,
}

const MOST_LINES: usize = 1000;

#[derive(Debug)]
pub(super) struct SeriesReader {
    format: &'static str,
    dialect: Dialect,
    next: Next,
    header: Vec<String>,
    all: Vec<(Series, Vec<f64>)>,
    is_reading: bool,
    rows: usize,
    lines: Lines,
    loose: usize,
}

impl SeriesReader {
    pub(super) fn new(format: &'static str, dialect: Dialect, next: Next) -> Self {
        let (header, all, lines) = Default::default();
        Self { format, dialect, next, header, all, is_reading: false, rows: 0, lines, loose: 0 }
    }

    pub(super) fn line(&mut self, text: &str, line: usize) -> Result<()> {
        let Self { next, header, all, is_reading, rows, lines, loose, .. } = self;
        if text.trim().is_empty() && *is_reading {
            return Ok(());
        }
        if let Some((series, values)) = all.last_mut().filter(|_| *is_reading) {
            if let Some(numbers) = numbers(text, series.width) {
                let before = values.len();
                values.extend(numbers);
                values.truncate(series.count.unwrap_or(usize::MAX));
                for row in before.max(*rows)..values.len() {
                    lines.push(row, line);
                    *rows = row + 1;
                }
                *is_reading = series.count.is_none_or(|count| values.len() < count);
                if values.len() > 2 * MOST {
                    return Err(ImportError::TooLong(values.len()));
                }
                return Ok(());
            }
            // A number that cannot be read is no end of a series.
            if text.trim_start().starts_with(|c: char| c.is_ascii_digit() || c == '.')
                && series.count.is_some_and(|count| values.len() < count)
                && !text.contains(char::is_alphabetic)
            {
                let text = text.trim().chars().take(40).collect();
                return Err(TextCell { line, text }.error(&series.name));
            }
            *is_reading = false;
        }
        if header.len() >= MOST_LINES {
            header.drain(..MOST_LINES / 2);
        }
        header.push(text.trim_end().to_owned());
        if let Some(series) = next(header) {
            let has_clock = series.dt > 0.0 && series.dt.is_finite() && series.start.is_finite();
            if !has_clock && series.no_record.is_none() {
                return Ok(());
            }
            all.push((series, Vec::new()));
            (*is_reading, *loose) = (true, 0);
        } else if !all.is_empty() && numbers(text, None).is_some_and(|numbers| numbers.len() > 1) {
            *loose += 1;
        }
        Ok(())
    }

    pub(super) fn finish(self, lines: usize) -> Result<Table> {
        let Self { format, dialect, all, loose, rows: read, lines: mut known, .. } = self;
        // Series that continue each other have more rows than lines.
        known.end(read);
        let mut remarks = Vec::new();
        let mut columns: Vec<Column> = Vec::new();
        let usable = |(series, values): &&(Series, Vec<f64>)| series.no_record.is_none() && values.len() > 1;
        let Some((first, _)) = all.iter().find(usable) else {
            let reason = all.iter().find_map(|(series, _)| Some(format!("`{}` {}", series.name, series.no_record?)));
            return Err(reason.map_or(ImportError::NoNumbers(lines), |reason| ImportError::NoRecord(reason, all.len())));
        };
        let origin = all.iter().filter(usable).map(|(series, _)| series.start).fold(first.start, f64::min);
        let dt = first.dt;
        for (series, values) in &all {
            let name = &series.name;
            if let Some(reason) = series.no_record {
                remarks.push(format!("`{name}` {reason}; it is left out"));
                continue;
            }
            if let Some(count) = series.count.filter(|count| *count != values.len()) {
                remarks.push(format!("`{name}` has {} numbers, but its header says {count}", values.len()));
            }
            let missing = values.iter().filter(|value| value.is_nan()).count();
            if missing > 0 {
                remarks.push(format!("`{name}` has no reading in {missing} place(s)"));
            }
            if (series.dt - dt).abs() > 1e-9 * dt {
                remarks.push(format!("`{name}` has other times than `{}`; it is left out", first.name));
                continue;
            }
            let place = libm::round((series.start - origin) / dt);
            if place + values.len() as f64 > MOST as f64 {
                return Err(ImportError::TooLong((place.min(1e15) as usize).saturating_add(values.len())));
            }
            let place = place as usize;
            // A later series of the same name continues the column.
            let same = columns.iter().position(|column| column.name == *name && column.values.len() <= place);
            let column = same.unwrap_or_else(|| {
                columns.push(Column { name: name.clone(), unit: series.unit.clone(), ..Column::default() });
                columns.len() - 1
            });
            columns[column].values.resize(place, f64::NAN);
            columns[column].values.extend(values);
        }
        if loose > 0 {
            remarks.push(format!("{loose} line(s) of numbers behind the last series are left out"));
        }
        number_names(&mut columns);
        let rows = columns.iter().map(|column| column.values.len()).max().unwrap_or(0);
        columns.iter_mut().for_each(|column| column.values.resize(rows, f64::NAN));
        let form = format!("{format}: {} series of {rows} numbers, {dt} s apart", columns.len());
        let times = (0..rows).map(|k| k as f64 * dt).collect();
        columns.insert(0, Column::of_header("time", Some("s"), times));
        Ok(Table { dialect, form, columns, remarks, rate: None, lines: known })
    }
}

/// `None` if the line has other text. Numbers of a known width may abut.
pub(super) fn numbers(line: &str, width: Option<usize>) -> Option<Vec<f64>> {
    let number = |text: &str| match Decimal::Point.read(text.trim(), false) {
        Content::Number(value) => Some(value),
        Content::Missing | Content::Word => Some(f64::NAN),
        _ => None,
    };
    let line = line.trim_end();
    let apart: Vec<&str> = line.split_whitespace().collect();
    let fields = width.map_or(0, |width| line.len().div_ceil(width));
    if apart.len() >= fields && !apart.is_empty() {
        return apart.into_iter().map(number).collect();
    }
    let width = width.filter(|_| line.is_ascii() && !line.is_empty())?;
    (0..fields).map(|k| number(line.get(k * width..((k + 1) * width).min(line.len()))?)).collect()
}

enum Handling {
    Read(fn(&[u8], Option<Dialect>) -> Result<Table>),
    Refuse(&'static str),
}

use Handling::{Read, Refuse};

const SHEET: Handling = Refuse("save the sheet as CSV");
const PICTURE: Handling = Refuse("a record is a table of numbers: export the readings as CSV");
const SOUND: Handling = Refuse("save it as WAV");
const FRAME: Handling = Refuse("write its columns as CSV (pandas: to_csv)");
const HDF5: Handling = Refuse("write its columns as CSV (h5dump, pandas, or writematrix in MATLAB)");
const SEISMOGRAM: Handling =
    Refuse("write it as text: SLIST, or SAC's alphanumeric form (ObsPy: write with format=\"SLIST\")");

/// Name, test of the bytes, and handling. The first match counts.
type Kind = (&'static str, fn(&[u8]) -> bool, Handling);

const KINDS: [Kind; 22] = [
    ("a sound", |b| b.starts_with(b"RIFF") && has(b, 8, b"WAVE"), Read(|b, _| sound::table(b))),
    ("a gzip file", |b| b.starts_with(b"\x1F\x8B\x08"), Read(gzip)),
    ("a NumPy file", |b| b.starts_with(b"\x93NUMPY"), Read(|b, _| arrays::npy(b))),
    ("a NumPy archive", |b| is_zip(b) && has_entry(b, |name| name.ends_with(".npy")), Read(|b, _| arrays::npz(b))),
    ("a MATLAB file", is_mat5, Read(|b, _| arrays::mat(b))),
    ("a universal file with data set 58b", has_58b, Refuse("save it as text (data set 58)")),
    ("a spreadsheet (.xlsx)", |b| is_zip(b) && has_entry(b, |name| name.starts_with("xl/")), SHEET),
    ("a spreadsheet or document (.ods, .odt)", |b| is_zip(b) && has_entry(b, |name| name == "content.xml"), SHEET),
    ("a ZIP", is_zip, Read(zip)),
    ("an old spreadsheet (.xls) or document", |b| b.starts_with(b"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1"), SHEET),
    ("a MATLAB 7.3 file (HDF5)", |b| b.starts_with(b"MATLAB 7.3"), HDF5),
    ("an HDF5 file", |b| (0..5).any(|k| has(b, [0, 512, 1024, 2048, 4096][k], b"\x89HDF\r\n\x1A\n")), HDF5),
    ("a TDMS file of LabVIEW", |b| b.starts_with(b"TDSm"), Refuse("write it as LVM or CSV (LabVIEW, or npTDMS)")),
    ("a binary SAC seismogram", is_sac, SEISMOGRAM),
    ("a miniSEED seismogram", is_seed, SEISMOGRAM),
    ("a Parquet file", |b| b.starts_with(b"PAR1"), FRAME),
    ("JSON", |b| [&b"{\""[..], b"[{", b"[["].iter().any(|mark| b.trim_ascii_start().starts_with(mark)), FRAME),
    ("a GSE seismogram in packed form", is_packed_gse, SEISMOGRAM),
    ("an SQLite database", |b| b.starts_with(b"SQLite format 3\0"), Refuse("write its table as CSV (sqlite3 -csv)")),
    ("an MP3 sound", |b| b.starts_with(b"ID3") && b.contains(&0), SOUND),
    ("a sound or film (.m4a, .mp4)", |b| b[0] == 0 && has(b, 4, b"ftyp"), SOUND),
    ("a PDF document", |b| b.starts_with(b"%PDF-"), PICTURE),
];

pub(super) fn read_binary(bytes: &[u8], dialect: Option<Dialect>) -> Option<Result<Table>> {
    let (name, _, handling) = KINDS.iter().find(|(_, is, _)| !bytes.is_empty() && is(bytes))?;
    Some(match handling {
        Read(read) => read(bytes, dialect),
        Refuse(help) => Err(ImportError::OtherKind(format!("this is {name}; {help}"))),
    })
}

fn has(bytes: &[u8], place: usize, part: &[u8]) -> bool {
    bytes.get(place..).is_some_and(|rest| rest.starts_with(part))
}

fn has_58b(bytes: &[u8]) -> bool {
    let mut lines = bytes.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
    let mut is_set = lines.next() == Some(b"-1");
    is_set && lines.any(|line| std::mem::replace(&mut is_set, line == b"-1") && line.starts_with(b"58b"))
}

/// Only the end of the header: programs choose its text.
fn is_mat5(bytes: &[u8]) -> bool {
    bytes.starts_with(b"MATLAB 5.0") || has(bytes, 124, b"\x00\x01IM") || has(bytes, 124, b"\x01\x00MI")
}

fn is_sac(bytes: &[u8]) -> bool {
    let version = |is_big| whole(bytes, 304, 4, is_big).is_some_and(|version| (6..=7).contains(&version));
    bytes.len() >= 632 && [false, true].into_iter().any(version)
}

fn is_packed_gse(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(800)];
    let has_word = |word: &[u8]| head.windows(word.len()).any(|part| part == word);
    has_word(b"WID2 ") && has_word(b" CM6 ")
}

fn is_seed(bytes: &[u8]) -> bool {
    let is_number = |b: &[u8]| b.iter().all(|c| c.is_ascii_digit() || *c == b' ');
    let is_second = bytes.len() > 47 && is_number(&bytes[..6]) && b"DRQMV".contains(&bytes[6]) && bytes[7] == b' ';
    bytes.starts_with(b"MS\x03") || (is_second && bytes[..512.min(bytes.len())].contains(&0))
}
