//! The form of text files, as the importer finds it.

use kalmanscope_core::import::{Decimal, Delimiter, Dialect, Encoding, read};

fn utf16(text: &str) -> Vec<u8> {
    text.encode_utf16().flat_map(u16::to_le_bytes).collect()
}

#[test]
fn encodings_are_found_with_and_without_a_mark() {
    assert_eq!(Encoding::sniff(b"t,x\n1,2\n"), Some(Encoding::Utf8));
    assert_eq!(Encoding::sniff("\u{FEFF}t,x\n".as_bytes()), Some(Encoding::Utf8));
    assert_eq!(Encoding::sniff("Größe;Weg\n".as_bytes()), Some(Encoding::Utf8));
    assert_eq!(Encoding::sniff(b"Gr\xF6\xDFe;Weg\n"), Some(Encoding::Latin1));
    assert_eq!(Encoding::sniff(&utf16("t;x\n1;2\n")), Some(Encoding::Utf16Le));
    assert_eq!(Encoding::sniff(&utf16("\u{FEFF}t;x\n1;2\n")), Some(Encoding::Utf16Le));
    let big: Vec<u8> = "t;x\n1;2\n".encode_utf16().flat_map(u16::to_be_bytes).collect();
    assert_eq!(Encoding::sniff(&big), Some(Encoding::Utf16Be));
    assert_eq!(Encoding::sniff(b"\x7FELF\x02\x01\x01\x00\x00\x03\x10\x00\x00"), None);
    assert_eq!(Encoding::sniff(b"\x89PNG\r\n\x1A\n\x01\x02\x03"), None);
}

#[test]
fn a_character_that_is_cut_at_the_end_does_not_change_the_encoding() {
    let text = "Größe".as_bytes();
    assert_eq!(Encoding::sniff(&text[..3]), Some(Encoding::Utf8));
}

fn sniff(text: &str) -> Dialect {
    read(text, None).unwrap().dialect
}

fn header(text: &str) -> Vec<(String, Option<String>)> {
    read(text, None).unwrap().columns.into_iter().map(|column| (column.name, column.unit)).collect()
}

#[track_caller]
fn check(text: &str, delimiter: Delimiter, decimal: Decimal, [names, units, data]: [usize; 3]) {
    let dialect = Dialect { encoding: Encoding::Utf8, delimiter, decimal, names, units, data, thousands: false };
    assert_eq!(sniff(text), dialect, "{text}");
}

#[test]
fn usual_dialects_are_found() {
    use Decimal::{Comma as DecimalComma, Point};
    check("t,force,x\n0,1,2\n1,2,3\n", Delimiter::Comma, Point, [1, 0, 2]);
    check("\"V1\",\"V2\",\n0.1,0.2,\n0.3,0.4,\n", Delimiter::Comma, Point, [1, 0, 2]);
    check("Zeit;Kraft;Weg\n0,00;1,5;2\n0,01;1;2,5\n", Delimiter::Semicolon, DecimalComma, [1, 0, 2]);
    check("0.0 1.5 2\n0.1 2.5 3\n", Delimiter::Blanks, Point, [0, 0, 1]);
    check("0,0 1,5 2\n0,1 2,5 3\n", Delimiter::Blanks, DecimalComma, [0, 0, 1]);
    check("t\tx\ns\tmm\n0\t1.5\n1\t2\n", Delimiter::Tab, Point, [1, 2, 3]);
    check("# a remark\n# t x\n0 1\n1 2\n", Delimiter::Blanks, Point, [2, 0, 3]);
    check("Time (s) acc (g)\n0 1\n1 2\n", Delimiter::Blanks, Point, [1, 0, 2]);
    check("\"t\",\"x\"\n\"0,1\",\"2,5\"\n\"0,2\",\"3\"\n", Delimiter::Comma, DecimalComma, [1, 0, 2]);
    check("1.5\n2.5\n", Delimiter::Semicolon, Point, [0, 0, 1]);
}

#[test]
fn leading_text_is_no_header_and_text_columns_are_no_obstacle() {
    let text = "Logger 3000\nStart: 12.05.2024; rate 100\n\nZeit;Weg;Status\ns;mm;\n0,00;1,2;ok\n0,01;1,3;ok\n";
    check(text, Delimiter::Semicolon, Decimal::Comma, [4, 5, 6]);
    check("A TEST OF 4\n.1 .2 .3\n.4 .5 .6\n", Delimiter::Blanks, Decimal::Point, [0, 0, 2]);
    let clock = "when,x\n2024-05-01 12:00:00.00,1\n2024-05-01 12:00:00.01,2\n";
    check(clock, Delimiter::Comma, Decimal::Point, [1, 0, 2]);
}

#[test]
fn names_and_units_come_from_one_line_or_two() {
    let units = header("t\tx\n[ms]\t[mm]\n0\t1.5\n1\t2\n");
    assert_eq!(units, [("t".to_owned(), Some("ms".to_owned())), ("x".to_owned(), Some("mm".to_owned()))]);
    let blanks = header("Time (s) acc (g)\n0 1\n1 2\n");
    assert_eq!(blanks, [("Time".to_owned(), Some("s".to_owned())), ("acc".to_owned(), Some("g".to_owned()))]);
    assert_eq!(header("1 2\n3 4\n")[1], ("column 2".to_owned(), None));
}

#[test]
fn a_line_that_names_nothing_is_passed_over() {
    let raw = "test5.txt\nSampling Frequency - 5000\nLow G Accel\tSG_300_a\tAccel\tTime\n\
               Voltage (unscaled)\tVoltage (unscaled)\tVoltage (unscaled)\tSec\n0.0 0.0 0\t\t\t\n\n\
               2.4E-3\t6.8E-2\t-6.6E-2\t0.0E+0\n2.4E-3\t6.7E-2\t-5.5E-2\t2.0E-4\n";
    check(raw, Delimiter::Tab, Decimal::Point, [3, 4, 7]);
    let header = header(raw);
    assert_eq!(header[0], ("Low G Accel".to_owned(), Some("Voltage".to_owned())));
    assert_eq!(header[3], ("Time".to_owned(), Some("Sec".to_owned())));
}

#[test]
fn thousands_are_found_where_a_number_has_them_for_sure() {
    let dialect = sniff("t;x\n0;1.234,5\n1;1.234\n");
    assert_eq!((dialect.decimal, dialect.thousands), (Decimal::Comma, true));
    assert!(!sniff("t;x\n0;1,5\n1;1.234\n").thousands);
    let quoted = sniff("t,x\n0,\"1,234.5\"\n1,\"999.5\"\n");
    assert_eq!((quoted.delimiter, quoted.decimal, quoted.thousands), (Delimiter::Comma, Decimal::Point, true));
}

#[test]
fn it_says_what_it_found() {
    let said = sniff("Zeit;Weg\ns;mm\n0,0;1,5\n0,1;2\n").to_string();
    let expected = "UTF-8, semicolons between cells, decimal commas, names in line 1, units in line 2, numbers from \
                    line 3 on";
    assert_eq!(said, expected);
}
