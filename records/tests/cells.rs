//! The cells of lines: numbers, times of day, words.

use kalmanscope_records::import::{Column, Decimal, Delimiter, Dialect, read};

/// The column of one cell.
fn column(cell: &str, decimal: Decimal, thousands: bool) -> Column {
    let dialect = Dialect { delimiter: Delimiter::Semicolon, decimal, data: 1, thousands, ..Dialect::default() };
    read(format!("1;{cell}\n"), Some(dialect)).unwrap().columns.swap_remove(1)
}

fn cells(delimiter: Delimiter, line: &str) -> Vec<&str> {
    delimiter.cells(line).collect()
}

#[test]
fn lines_are_split_at_their_delimiter() {
    assert_eq!(cells(Delimiter::Comma, "1, 2,3,\r\n"), ["1", "2", "3", ""]);
    assert_eq!(cells(Delimiter::Semicolon, "1,5;;2,5"), ["1,5", "", "2,5"]);
    assert_eq!(cells(Delimiter::Tab, "\t1\t2\n"), ["", "1", "2"]);
    assert_eq!(cells(Delimiter::Blanks, "  1.0   2.0\t3.0 \n"), ["1.0", "2.0", "3.0"]);
    assert_eq!(cells(Delimiter::Comma, "\"Angle, left\",\"1,5\" ,x"), ["Angle, left", "1,5", "x"]);
    assert_eq!(cells(Delimiter::Blanks, "\"two words\" b"), ["two words", "b"]);
    assert_eq!(cells(Delimiter::Comma, "5\" pipe,2"), ["5\" pipe", "2"]);
    assert_eq!(cells(Delimiter::Comma, "\"open,2"), ["\"open", "2"]);
    assert_eq!(cells(Delimiter::Comma, ""), [""]);
}

#[test]
fn numbers_are_read_with_their_decimal_character() {
    for (points, commas, expected) in [
        ("-1.5e-3", "-1,5E-3", Some(-1.5e-3)),
        ("7", "7", Some(7.0)),
        ("oops", "oops", None),
        ("1,234", "1.234.5", None),
        ("1,234.5", "1.234,5", Some(1234.5)),
        ("+1,234,567", "1'234'567", Some(1_234_567.0)),
        ("1'234.5", "1\u{A0}234,5", Some(1234.5)),
        ("1,23.4", "1.23,4", None),
        ("1,234,56", "1,2.3,4", None),
        ("0,123.5", ".234,5", None),
        ("12,3456.7", "--1.234,5", None),
        ("-1.5D+02", "-1,5d2", Some(-150.0)),
        (".25d-1", ",25D-1", Some(0.025)),
        ("D3", "2d", None),
        ("0.01 sec", "10 ms", Some(0.01)),
        ("20ms", "0,02s", Some(0.02)),
        ("12:00:00:500", "12:00:00,5", Some(43_200.5)),
        ("5 mm", "3rd", None),
    ] {
        let found = [Decimal::Point.number(points), Decimal::Comma.number(commas)];
        assert_eq!(found, [expected; 2], "{points} {commas}");
    }
    for missing in ["", "nan", "NaN", "N/A", "-"] {
        assert!(Decimal::Point.number(missing).unwrap().is_nan(), "{missing}");
    }
    let value = |cell, decimal, thousands| column(cell, decimal, thousands).values[0];
    assert_eq!([false, true].map(|thousands| value("1.234", Decimal::Comma, thousands)), [1.234, 1234.0]);
    assert_eq!(value("1,234", Decimal::Point, true), 1234.0);
}

#[test]
fn words_of_instruments_are_missing_readings() {
    for word in ["-1.#IND", "1.#QNAN00", "1.#INF", "OVLD", "-OL", "Overflow", "#DIV/0!", "#VALUE!", "---", "********"] {
        assert_eq!(column(word, Decimal::Point, false).words, 1, "{word}");
    }
    assert_eq!(column("cold", Decimal::Point, false).text.unwrap().text, "cold");
}

#[test]
fn times_of_day_are_seconds() {
    const NOON: f64 = 1_714_564_800.0;
    for (cell, expected) in [
        ("01:02:03.5", Some((3723.5, false))),
        ("00:00:01,25", Some((1.25, false))),
        ("59:01.25", Some((3541.25, false))),
        ("12:00:01.5 AM", Some((1.5, false))),
        ("12:00:01.5 pm", Some((43_201.5, false))),
        ("1:00:00 PM", Some((46_800.0, false))),
        ("1970-01-02 00:00:00", Some((86_400.0, true))),
        ("2024-02-28 23:59:59", Some((1_709_164_799.0, true))),
        ("2024-03-01T00:00:00Z", Some((1_709_251_200.0, true))),
        ("2024-05-01T12:00:00+00:00", Some((NOON, true))),
        ("2024-05-01 14:00:00+02:00", Some((NOON, true))),
        ("2024-05-01T08:30:00-0330", Some((NOON, true))),
        ("2024-05-01 12:00:00 UTC", Some((NOON, true))),
        ("20240501T120000.5", Some((NOON + 0.5, true))),
        ("01.05.2024 12:00:00", Some((NOON, true))),
        ("1-May-2024 12:00:00", Some((NOON, true))),
        ("05/01/2024 12:00:00", Some((NOON, true))),
        ("2024/05/01 12:00:00", Some((NOON, true))),
        ("01.05.24 12:00:00", Some((NOON, true))),
        ("31/12/2024 00:00:00", Some((1_735_603_200.0, true))),
        ("13:00:00 PM", None),
        ("12:30", None),
        ("16:9.5", None),
        ("2024-13-01 00:00:00", None),
        ("12:61:00", None),
        ("1:2", None),
        ("::", None),
        ("a:b:c", None),
        ("2024-05 12:00:00", None),
        ("12:00:00 XM", None),
    ] {
        let column = column(cell, Decimal::Point, false);
        let is_clock = column.is_dated || column.is_time_of_day;
        assert_eq!(is_clock.then_some((column.values[0], column.is_dated)), expected, "{cell}");
    }
}
