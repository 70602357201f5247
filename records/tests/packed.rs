//! Files that are no text: arrays, packed files, and kinds that are not read.

use std::io::Write as _;

use flate2::write::{DeflateEncoder, GzEncoder, ZlibEncoder};
use flate2::{Compression, Crc};

use crate::{names, read};

fn message(bytes: &[u8]) -> String {
    read(bytes).unwrap_err().to_string()
}

fn file(descr: &str, shape: &str, is_fortran: bool, data: &[u8]) -> Vec<u8> {
    let order = if is_fortran { "True" } else { "False" };
    let header = format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}\n");
    let length = u16::try_from(header.len()).unwrap().to_le_bytes();
    [b"\x93NUMPY\x01\0", &length[..], header.as_bytes(), data].concat()
}

fn columns(bytes: &[u8]) -> Vec<(String, Vec<f64>)> {
    read(bytes).unwrap().columns.into_iter().map(|column| (column.name, column.values)).collect()
}

#[test]
fn an_array_has_a_column_for_each_channel_in_either_order() {
    let data: Vec<u8> = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0].into_iter().flat_map(f64::to_be_bytes).collect();
    let by_rows = [("column 1".to_owned(), vec![0.0, 2.0, 4.0]), ("column 2".to_owned(), vec![1.0, 3.0, 5.0])];
    assert_eq!(columns(&file("'>f8'", "(3, 2)", false, &data)), by_rows);
    assert_eq!(columns(&file("'>f8'", "(2, 3)", true, &data)), by_rows, "of two rows the longer side is time");
    let by_columns = [("column 1".to_owned(), vec![0.0, 1.0, 2.0]), ("column 2".to_owned(), vec![3.0, 4.0, 5.0])];
    assert_eq!(columns(&file("'>f8'", "(3, 2)", true, &data)), by_columns);
    assert_eq!(columns(&file("'<i2'", "(2,)", false, &[1, 0, 0xFE, 0xFF]))[0].1, [1.0, -2.0]);
    assert_eq!(columns(&file("'|u1'", "(2, 1)", false, &[1, 0xFE]))[0].1, [1.0, 254.0]);
}

#[test]
fn arrays_that_are_not_read_are_named() {
    let message = |descr| message(&file(descr, "(2,)", false, &[0; 32]));
    assert!(message("[('t', '<f8'), ('x', '<f8')]").contains("its rows have names"));
    assert!(message("'<U1'").contains("type U1"), "{}", message("'<U1'"));
    assert!(message("'<M8[ns]'").contains("type M1"), "{}", message("'<M8[ns]'"));
}

#[test]
fn the_longest_arrays_are_the_columns_and_a_number_is_the_rate() {
    let array = |values: &[f64]| {
        let data: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        file("'<f8'", &format!("({},)", values.len()), false, &data)
    };
    let x: Vec<f64> = (0..40).map(|k| f64::from(k % 7)).collect();
    let with = |name: &str, rate: &[u8]| {
        let (force, x, times) = (array(&[1.0; 40]), array(&x), array(&[0.5, 0.7]));
        read(zip_of(&[("force.npy", &force), (name, rate), ("x.npy", &x), ("event_time.npy", &times)])).unwrap()
    };
    let table = with("Fs_Hz.npy", &array(&[50.0]));
    assert_eq!((names(&table), table.columns[0].values[3]), (vec!["time", "force", "x"], 0.06));
    assert_eq!(table.remarks, ["not read: `event_time` (2 rows)", "`Fs_Hz` is 50, so the rows are 0.02 s apart"]);
    assert_eq!(with("dt.npy", &file("'<f4'", "()", false, &0.01_f32.to_le_bytes())).columns[0].values[1], 0.01);
    for (name, number) in [("mass.npy", 3.0), ("fs.npy", 0.0)] {
        assert_eq!(names(&with(name, &array(&[number]))), ["force", "x"], "{name}");
    }
}

#[test]
fn arrays_that_are_none_are_said() {
    assert!(message(&file("'<f8'", "(3,)", false, &[0; 23])).ends_with("it is shorter than its header says"));
    assert!(message(&file("'<c16'", "(1,)", false, &[0; 16])).ends_with("not read: type c16"));
    assert!(message(&file("'<f8'", "(9999999999, 9999999999)", false, &[0; 16])).contains("shorter"));
    assert!(message(&file("'|V0'", "(9999999999,)", false, &[])).contains("shorter"));
}

fn part(kind: u32, data: &[u8]) -> Vec<u8> {
    let size = u32::try_from(data.len()).unwrap().to_le_bytes();
    let gap = if kind == 15 { 0 } else { data.len().next_multiple_of(8) - data.len() };
    [&kind.to_le_bytes()[..], &size, data, &vec![0; gap]].concat()
}

fn variable(name: &str, class: u8, [rows, columns]: [u8; 2], kind: u32, data: &[u8]) -> Vec<u8> {
    let short = [&[1, 0, name.len() as u8, 0], name.as_bytes(), &vec![0; 4 - name.len()]].concat();
    let lengths = part(5, &[rows, 0, 0, 0, columns, 0, 0, 0]);
    part(14, &[part(6, &[class, 0, 0, 0, 0, 0, 0, 0]), lengths, short, part(kind, data)].concat())
}

fn matlab_file() -> Vec<u8> {
    let times: Vec<u8> = (0..6_u16).flat_map(u16::to_le_bytes).collect();
    let data: Vec<u8> = (0..12).flat_map(|k| (f64::from(k) / 2.0).to_le_bytes()).collect();
    let mut packed = ZlibEncoder::new(Vec::new(), Compression::default());
    packed.write_all(&variable("acc", 6, [6, 2], 9, &data)).unwrap();
    let packed = part(15, &packed.finish().unwrap());
    let (rate, rest) = (variable("fs", 6, [1, 1], 2, &[100]), variable("s", 2, [1, 1], 5, &[0; 4]));
    let header = [&b"MATLAB 5.0 MAT-file"[..], &[b' '; 105], b"\x00\x01IM"].concat();
    [header, variable("t", 6, [6, 1], 4, &times), packed, rate, rest].concat()
}

#[test]
fn matrices_are_columns_and_what_is_not_read_is_said() {
    let table = read(matlab_file()).unwrap();
    assert_eq!(names(&table), ["t", "acc[0]", "acc[1]"]);
    assert_eq!(table.columns[0].values, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    assert_eq!(table.columns[2].values, [3.0, 3.5, 4.0, 4.5, 5.0, 5.5]);
    assert_eq!(table.remarks, ["not read: `s` (struct)", "`fs` is 100, which is not used"]);
    let cut = read(&matlab_file()[..matlab_file().len() - 20]).unwrap();
    assert!(cut.remarks[0].contains("cut short"), "{:?}", cut.remarks);
}

#[test]
fn a_kind_that_is_not_read_is_named_with_the_way_out() {
    let at = |place: usize, bytes: &[u8]| [&vec![0; place], bytes, &[0; 700]].concat();
    let sheet = zip_of(&[("[Content_Types].xml", b"<"), ("xl/workbook.xml", b"<")]);
    let seed = [&b"000001D STATI"[..], &[0; 40]].concat();
    let segy = [&b"C 1 CLIENT"[..], &[b' '; 3190], &[0; 24], &[0, 5]].concat();
    let mat4 = [&[0_u8; 4][..], &[2, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0], b"x\0", &[0; 16]].concat();
    for (bytes, name) in [
        (&b"\x89HDF\r\n\x1A\n\0"[..], "an HDF5 file; write its columns as CSV"),
        (b"MATLAB 7.3 MAT-file", "a MATLAB 7.3 file (HDF5); write"),
        (&sheet, "a spreadsheet (.xlsx); save the sheet as CSV"),
        (b"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1", "an old spreadsheet"),
        (&at(304, &[6, 0, 0, 0]), "a binary SAC"),
        (&seed, "a miniSEED"),
        (&mat4, "a MATLAB 4 file; save"),
        (&segy, "a SEG-Y"),
        (b"\x80\x04\x95.", "a pickle"),
        (&at(257, b"ustar"), "a tar archive"),
        (&[0, 0, 0, 24, b'f', b't', b'y', b'p'], "a sound or film"),
    ] {
        assert!(message(bytes).starts_with(&format!("this is {name}")), "{}", message(bytes));
    }
    for text in ["C 1,2\n1,2\n3,4\n", "BZh,x\n1,2\n3,4\n", "ID3,x\n1,2\n3,4\n"] {
        assert!(read(text).is_ok(), "{text}");
    }
}

fn set_58b(order: usize, kind: usize, spacing: usize, count: usize, data: &[u8]) -> Vec<u8> {
    let size = data.len();
    let begin = format!("    -1\n    58b{order:6}     2          11{size:12}\nx\n\n\n\n\n    1 0 0 0 NONE 1 3\n");
    let sizes = format!("{kind} {count} {spacing} 0.0 0.5 0.0\n17\n12 0 0 0 NONE m/s2\n0\n0\n");
    [begin.as_bytes(), sizes.as_bytes(), data, b"    -1\n"].concat()
}

fn file_58b() -> Vec<u8> {
    let big: Vec<u8> = [1.5_f64, -2.0, 3.0].into_iter().flat_map(f64::to_be_bytes).collect();
    let little: Vec<u8> = [4.0_f32, 5.0, 10.0].into_iter().flat_map(f32::to_le_bytes).collect();
    let other = b"    -1\n   151\na model\n    -1\n";
    [&other[..], &set_58b(2, 4, 1, 3, &big), &set_58b(1, 5, 1, 1, &[10; 8]), &set_58b(1, 2, 1, 3, &little)].concat()
}

#[test]
fn binary_universal_files_are_read_in_both_orders_and_spacings() {
    let table = read(file_58b()).unwrap();
    let values: Vec<&[f64]> = table.columns.iter().map(|column| &column.values[..]).collect();
    assert_eq!(values, [[0.0, 0.5, 1.0], [1.5, -2.0, 3.0], [4.0, 5.0, 10.0]]);
    assert!(table.remarks[0].contains("not a function of time"), "{:?}", table.remarks);
    let uneven = [&0.25_f32.to_be_bytes()[..], &7.0_f64.to_be_bytes()].concat().repeat(2);
    let table = read(set_58b(2, 4, 0, 2, &uneven)).unwrap();
    assert_eq!([&table.columns[0].values[..], &table.columns[1].values], [[0.25; 2], [7.0; 2]]);
    let wrong = message(&set_58b(1, 4, 1, 3, &[0; 20]));
    assert!(wrong.contains("another number of bytes"), "{wrong}");
}

#[test]
fn damaged_files_are_tables_or_sentences() {
    let array = file("'>f4'", "(3, 3)", false, &[7; 36]);
    let text = b"t,x\n0,1\n1,2\n2,1\n3,2\n";
    let (zip, npz) = (zip_of(&[("a.csv", text)]), zip_of(&[("a.npy", &array)]));
    for file in [gzip_of(text), zip, npz, matlab_file(), file_58b(), array] {
        assert!(read(&file).is_ok());
        for place in 0..file.len() {
            let _ = read(&file[..place]);
            for change in [0x01, 0x80, 0xFF] {
                let mut file = file.clone();
                file[place] ^= change;
                if let Ok(table) = read(file) {
                    assert!(table.columns.iter().all(|column| column.values.len() == table.rows()));
                }
            }
        }
    }
}

fn gzip_of(bytes: &[u8]) -> Vec<u8> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::default());
    packed.write_all(bytes).unwrap();
    packed.finish().unwrap()
}

fn zip_of(files: &[(&str, &[u8])]) -> Vec<u8> {
    let (mut all, mut directory) = (Vec::new(), Vec::new());
    for (name, bytes) in files {
        let mut packed = DeflateEncoder::new(Vec::new(), Compression::default());
        packed.write_all(bytes).unwrap();
        let (packed, mut sum, place) = (packed.finish().unwrap(), Crc::new(), all.len());
        sum.update(bytes);
        let word = |number: usize| u32::try_from(number).unwrap().to_le_bytes();
        let sizes = [sum.sum().to_le_bytes(), word(packed.len()), word(bytes.len()), word(name.len())].concat();
        let common = [&[20, 0, 0, 0, 8, 0, 0, 0, 0, 0], &sizes[..]].concat();
        all.extend([b"PK\x03\x04", &common[..], name.as_bytes(), &packed].concat());
        let head = [b"PK\x01\x02\x14\0", &common[..], &[0; 10], &word(place), name.as_bytes()].concat();
        directory.extend(head);
    }
    let count = [files.len() as u8, 0];
    let place = u32::try_from(all.len()).unwrap().to_le_bytes();
    [&all[..], &directory, b"PK\x05\x06\0\0\0\0", &count, &count, &[0; 4], &place, &[0; 2]].concat()
}

fn record() -> Vec<u8> {
    let rows = (0..40).map(|k| format!("{},{}\n", 0.1 * f64::from(k), k % 7));
    format!("time,x\n{}", rows.collect::<String>()).into_bytes()
}

#[test]
fn a_packed_table_is_the_table() {
    let plain = read(record()).unwrap();
    assert_eq!(read(gzip_of(&record())).unwrap(), plain);
    let parts = [gzip_of(&record()[..60]), gzip_of(&record()[60..])].concat();
    assert_eq!(read(parts).unwrap(), plain);
    let names = b"property,value\nversion,1.1\n".repeat(40);
    let files = [("meta/device.csv", &names[..]), ("Raw Data.csv", &record()), ("__MACOSX/._Raw Data.csv", b"\0")];
    let table = read(zip_of(&files)).unwrap();
    assert_eq!((&table.columns, table.remarks.len()), (&plain.columns, 1));
    assert!(table.remarks[0].ends_with("left out: `meta/device.csv`"), "{:?}", table.remarks);
}

#[test]
fn what_cannot_be_unpacked_is_said() {
    let message_of = |files: &[(&str, &[u8])]| message(&zip_of(files));
    let two = message_of(&[("a.csv", &record()), ("b.csv", &record())]);
    assert_eq!(two, "this is a ZIP; it has several tables: `a.csv`, `b.csv`; unpack it and open one");
    assert!(message_of(&[("a.pdf", b"%PDF-1")]).contains("no table in it: `a.pdf`: this is a PDF document"));
    assert!(message_of(&[("b.gz", &gzip_of(&record()))]).contains("packed twice"));
    let mut damaged = zip_of(&[("a.csv", &record())]);
    damaged[60] ^= 1;
    assert!(message(&damaged).contains("damaged"));
    let bomb = gzip_of(&vec![b'1'; 65 << 20]);
    assert!(message(&bomb).contains("too large"), "{} bytes", bomb.len());
}
