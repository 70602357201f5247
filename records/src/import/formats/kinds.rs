//! The kinds of files that are no text, by their first bytes.

use super::super::{Dialect, ImportError, Table, sound};
use super::unpack::{gzip, has_entry, is_zip, whole, zip};
use super::{arrays, series};

enum Handling {
    Read(fn(&[u8], Option<Dialect>) -> Result<Table, ImportError>),
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
    ("a MATLAB file", |b| b.starts_with(b"MATLAB 5.0") || has_mat5_mark(b), Read(|b, _| arrays::mat(b))),
    ("a universal file with data set 58b", series::has_58b, Read(|b, _| series::uff58b(b))),
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

pub(in super::super) fn read_binary(bytes: &[u8], dialect: Option<Dialect>) -> Option<Result<Table, ImportError>> {
    let (name, _, handling) = KINDS.iter().find(|(_, is, _)| !bytes.is_empty() && is(bytes))?;
    Some(match handling {
        Read(read) => read(bytes, dialect),
        Refuse(help) => Err(ImportError::OtherKind(format!("this is {name}; {help}"))),
    })
}

fn has(bytes: &[u8], place: usize, part: &[u8]) -> bool {
    bytes.get(place..).is_some_and(|rest| rest.starts_with(part))
}

fn is_edf(bytes: &[u8]) -> bool {
    let size =
        bytes.get(184..192).and_then(|text| std::str::from_utf8(text).ok()?.trim().parse().ok()).unwrap_or(1_usize);
    (bytes.starts_with(b"0       ") || bytes.starts_with(b"\xFFBIOSEMI")) && size > 256 && size % 256 == 0
}

/// Only the end of the header: programs choose its text.
fn has_mat5_mark(bytes: &[u8]) -> bool {
    has(bytes, 124, b"\x00\x01IM") || has(bytes, 124, b"\x01\x00MI")
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

#[cfg(test)]
mod tests {
    use super::super::{arrays, series, unpack};
    use super::*;
    use crate::import::read;

    #[test]
    fn a_kind_that_is_not_read_is_named_with_the_way_out() {
        let message = |bytes: &[u8]| read(bytes, None).unwrap_err().to_string();
        let at = |place: usize, bytes: &[u8]| [&vec![0; place], bytes, &[0; 700]].concat();
        let sheet = unpack::tests::zip_of(&[("[Content_Types].xml", b"<"), ("xl/workbook.xml", b"<")]);
        let seed = [&b"000001D STATI"[..], &[0; 40]].concat();
        let segy = [&b"C 1 CLIENT"[..], &[b' '; 3190], &[0; 24], &[0, 5]].concat();
        let mat4 = [&[0_u8; 4][..], &[2, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0], b"x\0", &[0; 16]].concat();
        for (bytes, name) in [
            (&b"\x89HDF\r\n\x1A\n\0"[..], "an HDF5 file; write its columns as CSV"),
            (b"MATLAB 7.3 MAT-file", "a MATLAB 7.3 file (HDF5); write"),
            (&mat4, "a MATLAB 4 file; save"),
            (&sheet, "a spreadsheet (.xlsx); save the sheet as CSV"),
            (b"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1", "an old spreadsheet"),
            (&at(304, &[6, 0, 0, 0]), "a binary SAC"),
            (&seed, "a miniSEED"),
            (&segy, "a SEG-Y"),
            (b"\x80\x04\x95.", "a pickle"),
            (&at(257, b"ustar"), "a tar archive"),
            (&[0, 0, 0, 24, b'f', b't', b'y', b'p'], "a sound or film"),
        ] {
            assert!(message(bytes).starts_with(&format!("this is {name}")), "{}", message(bytes));
        }
        for text in [&b"C 1,2\n1,2\n3,4\n"[..], b"-1\n58b\n", b"BZh,x\n1,2\n3,4\n", b"ID3,x\n1,2\n3,4\n"] {
            assert!(KINDS.iter().all(|(name, is, _)| !is(text) || name.contains("58b")), "{text:?}");
        }
    }

    #[test]
    fn damaged_files_are_tables_or_sentences() {
        let array = arrays::tests::file("'>f4'", "(3, 3)", false, &[7; 36]);
        let text = b"t,x\n0,1\n1,2\n2,1\n3,2\n";
        let (zip, npz) = (unpack::tests::zip_of(&[("a.csv", text)]), unpack::tests::zip_of(&[("a.npy", &array)]));
        let files =
            [unpack::tests::gzip_of(text), zip, npz, arrays::tests::matlab_file(), series::tests::file_58b(), array];
        for file in &files {
            assert!(read(file.as_slice(), None).is_ok());
            for place in 0..file.len() {
                let _ = read(&file[..place], None);
                for change in [0x01, 0x80, 0xFF] {
                    let mut file = file.clone();
                    file[place] ^= change;
                    if let Ok(table) = read(file, None) {
                        assert!(table.columns.iter().all(|column| column.values.len() == table.rows()));
                    }
                }
            }
        }
    }
}
