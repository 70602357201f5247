//! The kinds of files that are no text, by their first bytes.

use super::super::{Dialect, ImportError, Result, Table, sound};
use super::arrays;
use super::unpack::{gzip, has_entry, is_zip, whole, zip};

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

pub(in super::super) fn read_binary(bytes: &[u8], dialect: Option<Dialect>) -> Option<Result<Table>> {
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
