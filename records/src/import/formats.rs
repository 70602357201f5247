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

use unpack::{NumberForm, gzip, has_entry, is_zip, whole, zip};

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
    pub(super) has_times: bool,
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
            if !has_clock && !series.has_times {
                return Ok(());
            }
            all.push((series, Vec::new()));
            (*is_reading, *loose) = (true, 0);
        } else if !all.is_empty() && numbers(text, None).is_some_and(|numbers| numbers.len() > 1) {
            *loose += 1;
        }
        Ok(())
    }

    /// `size` counts all bytes; the form 2 is that of IEEE.
    fn bytes(&mut self, bytes: &[u8], size: usize, is_big: bool, form: usize) {
        let Some((series, values)) = self.all.last_mut().filter(|_| self.is_reading) else { return };
        self.is_reading = false;
        let points = series.count.unwrap_or(0) / if series.has_times { 2 } else { 1 };
        // A time may have fewer bytes than its value.
        let sizes: &[usize] = match (series.has_times, size.checked_div(points)) {
            (false, Some(4)) => &[4],
            (false, Some(8)) => &[8],
            (true, Some(8)) => &[4, 4],
            (true, Some(12)) => &[4, 8],
            (true, Some(16)) => &[8, 8],
            _ => &[],
        };
        let width = sizes.iter().sum();
        let reason = match form {
            2 if width > 0 && size == points * width => None,
            2 => Some("has another number of bytes than its header says"),
            _ => Some("has numbers of VAX or IBM, which are not read"),
        };
        series.no_record = series.no_record.or(reason);
        if series.no_record.is_none() {
            for mut point in bytes.chunks_exact(width) {
                for &size in sizes {
                    values.push(NumberForm { kind: 'f', size, is_big }.number(&point[..size]));
                    point = &point[size..];
                }
            }
            self.lines.push(self.rows, self.rows + 1);
            self.rows = self.rows.max(values.len());
        }
    }

    pub(super) fn finish(self, lines: usize) -> Result<Table> {
        let Self { format, dialect, all, loose, rows: read, lines: mut known, .. } = self;
        // Series that continue each other have more rows than lines.
        known.end(read);
        let mut remarks = Vec::new();
        let mut columns: Vec<Column> = Vec::new();
        let mut times: Option<Vec<f64>> = None;
        let usable = |(series, values): &&(Series, Vec<f64>)| series.no_record.is_none() && values.len() > 1;
        let Some((first, _)) = all.iter().find(usable) else {
            let reason = all.iter().find_map(|(series, _)| Some(format!("`{}` {}", series.name, series.no_record?)));
            return Err(reason.map_or(ImportError::NoNumbers(lines), |reason| ImportError::NoRecord(reason, all.len())));
        };
        let origin = all.iter().filter(usable).map(|(series, _)| series.start).fold(first.start, f64::min);
        let (dt, has_times) = (first.dt, first.has_times);
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
            // A time without its value is no row.
            let (own, values): (Vec<f64>, Vec<f64>) = if series.has_times {
                values.chunks_exact(2).map(|pair| (pair[0], pair[1])).unzip()
            } else {
                (Vec::new(), values.clone())
            };
            if series.has_times != has_times
                || (has_times && times.as_ref().is_some_and(|times| *times != own))
                || (!has_times && (series.dt - dt).abs() > 1e-9 * dt)
            {
                remarks.push(format!("`{name}` has other times than `{}`; it is left out", first.name));
                continue;
            }
            let place = if has_times { 0.0 } else { libm::round((series.start - origin) / dt) };
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
            if has_times {
                times.get_or_insert(own);
            }
        }
        if loose > 0 {
            remarks.push(format!("{loose} line(s) of numbers behind the last series are left out"));
        }
        number_names(&mut columns);
        let rows = columns.iter().map(|column| column.values.len()).max().unwrap_or(0);
        columns.iter_mut().for_each(|column| column.values.resize(rows, f64::NAN));
        let apart = if has_times { " with their times".to_owned() } else { format!(", {dt} s apart") };
        let form = format!("{format}: {} series of {rows} numbers{apart}", columns.len());
        let even = || (0..rows).map(|k| k as f64 * dt).collect();
        columns.insert(0, Column::of_header("time", Some("s"), times.unwrap_or_else(even)));
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
const PACKED: Handling = Refuse("unpack it, and open the table in it");
const SOUND: Handling = Refuse("save it as WAV");
const FRAME: Handling = Refuse("write its columns as CSV (pandas: to_csv)");
const TOPICS: Handling =
    Refuse("write the message with the readings as CSV (PlotJuggler, or the tool that comes with it)");
const HDF5: Handling = Refuse("write its columns as CSV (h5dump, pandas, or writematrix in MATLAB)");
const MATLAB: Handling = Refuse("save its variables in MATLAB with -v7, or its columns with writematrix");
const SEISMOGRAM: Handling =
    Refuse("write it as text: SLIST, or SAC's alphanumeric form (ObsPy: write with format=\"SLIST\")");

/// Name, test of the bytes, and handling. The first match counts.
type Kind = (&'static str, fn(&[u8]) -> bool, Handling);

const KINDS: [Kind; 53] = [
    ("a sound", |b| b.starts_with(b"RIFF") && has(b, 8, b"WAVE"), Read(|b, _| sound::table(b))),
    ("a gzip file", |b| b.starts_with(b"\x1F\x8B\x08"), Read(gzip)),
    ("a NumPy file", |b| b.starts_with(b"\x93NUMPY"), Read(|b, _| arrays::npy(b))),
    ("a NumPy archive", |b| is_zip(b) && has_entry(b, |name| name.ends_with(".npy")), Read(|b, _| arrays::npz(b))),
    ("a MATLAB file", is_mat5, Read(|b, _| arrays::mat(b))),
    ("a universal file with data set 58b", has_58b, Read(|b, _| series::uff58b(b))),
    ("a spreadsheet (.xlsx)", |b| is_zip(b) && has_entry(b, |name| name.starts_with("xl/")), SHEET),
    ("a spreadsheet or document (.ods, .odt)", |b| is_zip(b) && has_entry(b, |name| name == "content.xml"), SHEET),
    ("a document (.docx, .pptx)", |b| is_zip(b) && has_entry(b, |name| name == "[Content_Types].xml"), PICTURE),
    ("a ZIP", is_zip, Read(zip)),
    ("an old spreadsheet (.xls) or document", |b| b.starts_with(b"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1"), SHEET),
    ("a MATLAB 7.3 file (HDF5)", |b| b.starts_with(b"MATLAB 7.3"), HDF5),
    ("an HDF5 file", |b| (0..5).any(|k| has(b, [0, 512, 1024, 2048, 4096][k], b"\x89HDF\r\n\x1A\n")), HDF5),
    ("a MATLAB 4 file", is_mat4, MATLAB),
    ("a TDMS file of LabVIEW", |b| b.starts_with(b"TDSm"), Refuse("write it as LVM or CSV (LabVIEW, or npTDMS)")),
    ("an index of a TDMS file", |b| b.starts_with(b"TDSh"), Refuse("write the file beside it as LVM or CSV")),
    ("a binary SAC seismogram", is_sac, SEISMOGRAM),
    ("a miniSEED seismogram", is_seed, SEISMOGRAM),
    ("a SEG-Y file", is_segy, SEISMOGRAM),
    ("a SEG-2 file", |b| b.starts_with(b"\x55\x3A") || b.starts_with(b"\x3A\x55\x00"), SEISMOGRAM),
    ("a NetCDF file", |b| b.starts_with(b"CDF\x01") || b.starts_with(b"CDF\x02"), FRAME),
    ("a Parquet file", |b| b.starts_with(b"PAR1"), FRAME),
    ("a Feather or Arrow file", |b| b.starts_with(b"ARROW1\0\0") || b.starts_with(b"FEA1"), FRAME),
    ("a pickle of Python", |b| b[0] == 0x80 && b.len() > 3 && (2..6).contains(&b[1]) && b.ends_with(b"."), FRAME),
    ("an Avro file", |b| b.starts_with(b"Obj\x01"), FRAME),
    ("a file of Stata", |b| b.starts_with(b"<stata_dta>") || has(b, 1, b"\x02\x01\0") && b[0] > 0x70, FRAME),
    ("JSON", |b| [&b"{\""[..], b"[{", b"[["].iter().any(|mark| b.trim_ascii_start().starts_with(mark)), FRAME),
    ("a GSE seismogram in packed form", is_packed_gse, SEISMOGRAM),
    ("an SQLite database", |b| b.starts_with(b"SQLite format 3\0"), Refuse("write its table as CSV (sqlite3 -csv)")),
    ("a bag of ROS", |b| b.starts_with(b"#ROSBAG V"), TOPICS),
    ("an MCAP file", |b| b.starts_with(b"\x89MCAP0\r\n"), TOPICS),
    ("a ULog of PX4", |b| b.starts_with(b"ULog\x01\x12\x35"), TOPICS),
    ("a log of ArduPilot", |b| b.starts_with(b"\xA3\x95"), TOPICS),
    (
        "an MDF file",
        |b| b.starts_with(b"MDF  ") && b.contains(&0),
        Refuse("write its channels as CSV (asammdf: export)"),
    ),
    ("an EDF or BDF file", is_edf, Refuse("write its channels as CSV (MNE: to_data_frame)")),
    ("a C3D file", |b| b.starts_with(b"\x02\x50") && b.len() >= 512, Refuse("write its channels as CSV (ezc3d)")),
    (
        "a file of R",
        |b| [b"RDX2", b"RDX3"].iter().any(|mark| b.starts_with(*mark)),
        Refuse("write its columns with write.csv"),
    ),
    (
        "a file of enDAQ or Matroska",
        |b| b.starts_with(b"\x1A\x45\xDF\xA3"),
        Refuse("write its channels as CSV (enDAQ Lab)"),
    ),
    ("a FLAC sound", |b| b.starts_with(b"fLaC"), SOUND),
    ("an Ogg sound", |b| b.starts_with(b"OggS"), SOUND),
    ("an MP3 sound", |b| b.starts_with(b"ID3") && b.contains(&0), SOUND),
    ("an AIFF sound", |b| b.starts_with(b"FORM") && has(b, 8, b"AIF"), SOUND),
    ("a sound or film (.m4a, .mp4)", |b| b[0] == 0 && has(b, 4, b"ftyp"), SOUND),
    ("a PDF document", |b| b.starts_with(b"%PDF-"), PICTURE),
    ("a PNG picture", |b| b.starts_with(b"\x89PNG\r\n\x1A\n"), PICTURE),
    ("a JPEG picture", |b| b.starts_with(b"\xFF\xD8\xFF"), PICTURE),
    ("a GIF picture", |b| b.starts_with(b"GIF87a") || b.starts_with(b"GIF89a"), PICTURE),
    ("a 7z archive", |b| b.starts_with(b"7z\xBC\xAF\x27\x1C"), PACKED),
    ("a RAR archive", |b| b.starts_with(b"Rar!\x1A\x07"), PACKED),
    ("a tar archive", |b| has(b, 257, b"ustar"), PACKED),
    ("a bzip2 file", |b| b.starts_with(b"BZh") && has(b, 4, b"1AY&SY"), PACKED),
    ("an xz file", |b| b.starts_with(b"\xFD7zXZ\0"), PACKED),
    ("a Zstandard file", |b| b.starts_with(b"\x28\xB5\x2F\xFD"), PACKED),
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

fn is_edf(bytes: &[u8]) -> bool {
    let size =
        bytes.get(184..192).and_then(|text| std::str::from_utf8(text).ok()?.trim().parse().ok()).unwrap_or(1_usize);
    (bytes.starts_with(b"0       ") || bytes.starts_with(b"\xFFBIOSEMI")) && size > 256 && size % 256 == 0
}

/// Source: MathWorks, MAT-file format, level 4: kind, rows, columns, whether it is complex, and the length of the name.
fn is_mat4(bytes: &[u8]) -> bool {
    [false, true].into_iter().any(|is_big| {
        let word = |k: usize| whole(bytes, 4 * k, 4, is_big).unwrap_or(usize::MAX);
        let (kind, length) = (word(0), word(4));
        let name = bytes.get(20..).and_then(|rest| rest.get(..length)).and_then(|name| name.split_last());
        let is_name = name.is_some_and(|(end, name)| *end == 0 && name.iter().all(u8::is_ascii_graphic));
        is_name && kind / 1000 == usize::from(is_big) && kind / 100 % 10 == 0 && kind % 100 < 60 && word(3) < 2
    })
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

fn is_segy(bytes: &[u8]) -> bool {
    let is_card = [&b"\xC3\x40\xF1"[..], b"C 1", b"C01"].iter().any(|mark| bytes.starts_with(mark))
        || [&b"\xC3\xF4\xF0"[..], b"C40"].iter().any(|mark| has(bytes, 3120, mark));
    is_card && [false, true].iter().any(|big| whole(bytes, 3224, 2, *big).is_some_and(|k| (1..=16).contains(&k)))
}
