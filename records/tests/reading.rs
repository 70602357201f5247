//! Files as tables: their bytes, lines, headers and formats, and the faults of their times.

use kalmanscope_records::import::{Column, Dimension, Loaded, Table, hash, load, unit};
use kalmanscope_records::{Task as _, document};

use crate::read;

#[test]
fn what_is_no_table_is_said() {
    let message = |bytes: &[u8]| {
        let said = read(bytes).unwrap_err().to_string();
        assert_eq!(load(bytes.to_vec()).run().unwrap_err().to_string(), said);
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

fn text() -> Vec<u8> {
    let row = |k: u32| format!("{},{:.6}\n{}", f64::from(k) * 0.01, f64::from(k).sin(), ["", "\n"][k as usize % 2]);
    let rows: String = (0..60_000).map(row).collect();
    format!("t [s],x [mm]\n{rows}600,oops,7\n").into_bytes()
}

#[test]
fn a_file_in_slices_is_the_file_in_one_go() {
    let (mut loading, mut shares) = (load(text()), vec![0.0]);
    while !loading.advance(&mut || false) {
        shares.push(loading.progress());
    }
    assert!(shares.len() > 100 && shares.is_sorted() && shares[shares.len() - 1] < 1.0);
    let Loaded { hash: sum, table } = loading.finish().unwrap();
    assert_eq!(sum, hash(&text()));
    // NaN is not equal to itself.
    assert_eq!(format!("{table:?}"), format!("{:?}", read(text()).unwrap()));
    assert_eq!(load(text()).finish().unwrap().hash, hash(&text()), "in one go");
}

#[test]
fn a_table_can_be_sent_apart_from_its_numbers() {
    let table = read(text()).unwrap();
    let mut sent: Table = document::read(&document::of(&table).unwrap()).unwrap();
    assert_eq!((sent.columns.len(), sent.rows(), sent.line(50_000)), (2, 0, table.line(50_000)));
    for (sent, column) in sent.columns.iter_mut().zip(&table.columns) {
        sent.values.clone_from(&column.values);
    }
    assert_eq!(format!("{sent:?}"), format!("{table:?}"));
}

#[test]
fn lines_are_known_for_each_row() {
    let table = read("t,x\n1,1\n2,1\n3,1\n\n\n4,1\n5,1\n".to_owned() + &"\n".repeat(11) + "6,1\n").unwrap();
    assert_eq!((0..6).map(|row| table.line(row)).collect::<Vec<_>>(), [2, 3, 4, 7, 8, 20]);
    assert_eq!(table.line(100), 20 + 95);
    let series = read("2 0.1 NPTS, DT\n1 2\n").unwrap();
    assert_eq!([1, 100].map(|row| series.line(row)), [2; 2]);
}

#[test]
fn names_are_numbered_and_a_trailing_delimiter_begins_no_column() {
    for (text, names) in [
        ("x,x,t,x\n1,2,3,4\n5,6,7,8\n", &["x", "x (2)", "t", "x (3)"][..]),
        ("\"V1\",\"V2\",\n0.1,0.2,\n0.3,0.4,\n", &["V1", "V2"]),
        ("a,b,c\n0.1,0.2,\n0.3,0.4,\n", &["a", "b", "c"]),
    ] {
        assert_eq!(crate::names(&read(text).unwrap()), names);
    }
}

#[test]
fn ragged_rows_and_text_are_noted_with_their_lines() {
    let table = read("t,x\n0,1\n1\n\n# note\n2,3,4\n3,oops\n4,5\n").unwrap();
    assert_eq!(table.rows(), 5);
    assert_eq!(table.remarks.len(), 2);
    assert!(table.remarks[0].starts_with("line 3 has fewer cells"), "{:?}", table.remarks);
    assert!(table.remarks[1].starts_with("line 6 has more cells"), "{:?}", table.remarks);
    let text = table.columns[1].text.clone().unwrap();
    assert_eq!((text.line, text.text.as_str()), (7, "oops"));
    assert_eq!(table.line(4), 8);
    assert!(table.columns[1].values[1].is_nan());
}

#[test]
fn spellings_are_known_and_stand_behind_names() {
    for (text, expected) in [
        ("ms", Some((Dimension::Time, 1e-3))),
        ("g", Some((Dimension::Acceleration, 9.80665))),
        ("M/S^2", Some((Dimension::Acceleration, 1.0))),
        ("mV", Some((Dimension::Voltage, 1e-3))),
        // A siemens is no second.
        ("S", None),
        ("Angle", None),
    ] {
        assert_eq!(unit(text), expected, "{text}");
    }
    for (header, name, unit) in [
        ("acc (g)", "acc", Some("g")),
        ("Angle, Ch 1+2 (rad) Run #13", "Angle, Ch 1+2 Run #13", Some("rad")),
        ("Weg [mm]", "Weg", Some("mm")),
        ("t in ms", "t", Some("ms")),
        ("force_N", "force", Some("N")),
        ("ground_acceleration", "ground_acceleration", None),
        ("V1", "V1", None),
        ("(s)", "s", Some("s")),
    ] {
        let column = Column::of_header(header, None, Vec::new());
        assert_eq!((column.name.as_str(), column.unit.as_deref()), (name, unit), "{header}");
    }
}

#[test]
fn usual_tables_have_no_format() {
    for text in
        ["t,x\n0,1\n1,2\n", "X,CH1\n0,1\n", "Record Length\n1\n", "NPTS and DT of this file:\n1 2\n", "-1\n2\n3\n"]
    {
        assert!(read(text).map_or(true, |table| table.form.starts_with("UTF-8")), "{text}");
    }
}

#[test]
fn series_have_the_numbers_and_units_of_their_headers_and_abut_where_their_width_is_known() {
    let csmip = "5 points of accel data equally spaced at 0.010 sec, in cm/sec2. (2f9.3)\n12345.67812345.679\n     1.5 ********\n3D2\n";
    let header = "34 real-header values follow on 34 lines, Format= (1F15.6)\n".to_owned() + &"0.02\n".repeat(34);
    let cosmos = header
        + "3 acceleration pts, approx  1 secs, units=cm/sec2(04),Format=(1E15.6)\n1.5 2.5 -2.5E+1\nEnd of data\n";
    for (text, step, unit, values) in [
        (csmip, 0.01, Some("cm/sec2"), "[12345.678, 12345.679, 1.5, NaN, 300.0]"),
        (&cosmos, 0.02, Some("cm/sec2"), "[1.5, 2.5, -25.0]"),
        ("NPTS=  3, DT=   .0050 SEC,\n1 2 3\n", 0.005, None, "[1.0, 2.0, 3.0]"),
    ] {
        let table = read(text).unwrap();
        let [time, series] = table.columns.as_slice() else { panic!("{:?}", table.columns) };
        assert_eq!((time.values[1], series.unit.as_deref()), (step, unit), "{text}");
        assert_eq!(format!("{:?}", series.values), values, "{text}");
    }
}

fn mended(text: &str) -> (Vec<f64>, Vec<f64>, Vec<String>) {
    let table = read(text).unwrap();
    let [time, .., last] = table.columns.as_slice() else { panic!("two columns") };
    (time.values.clone(), last.values.clone(), table.remarks)
}

fn file(times: impl IntoIterator<Item = f64>) -> String {
    let rows = times.into_iter().enumerate().map(|(row, time)| format!("{time},{row}\n"));
    "time,x\n".to_owned() + &rows.collect::<String>()
}

fn steps(times: &[f64]) -> Vec<f64> {
    times.windows(2).map(|pair| ((pair[1] - pair[0]) * 1e6).round() * 1e-6).collect()
}

#[test]
fn counters_go_on_where_they_turn_over() {
    for (range, from, step) in [
        (4_294_967_296.0, 4_294_960_000.0, 20_000.0),
        (4_294_967.296, 4_294_967.0, 0.5),
        (65_536.0, 65_500.0, 10.0),
        (65.536, 65.0, 0.01),
    ] {
        let times = (0..200).map(|k| (from + f64::from(k) * step) % range);
        let (times, _, remarks) = mended(&file(times));
        assert!(times.windows(2).all(|pair| (pair[1] - pair[0] - step).abs() < 1e-6 * range.max(1.0)), "{range}");
        assert!(remarks.len() == 1 && remarks[0].contains("turns over"), "{remarks:?}");
    }
    let signed = (0..50).map(|k| f64::from(32_700_i16.wrapping_add(10 * k)));
    assert_eq!(steps(&mended(&file(signed)).0), [10.0; 49]);
}

#[test]
fn each_fault_with_one_cure_is_cured_and_said() {
    let even = |count: u32| (0..count).map(|k| 0.02 * f64::from(k));
    let epoch = std::iter::once(0.0).chain(even(50).map(|time| 1.7e9 + time));
    let mut swapped: Vec<f64> = even(60).collect();
    swapped.swap(10, 11);
    let back = even(60).map(|time| if time > 0.5 { 7200.0 + time - 3600.0 } else { 7200.0 + time });
    let again = even(30).chain(even(40)).chain(even(20));
    let twice = even(40).flat_map(|time| [time, time]);
    let cases: [(&str, String, usize, usize, &str); 4] = [
        ("epoch", file(epoch), 50, 1, "far from all others"),
        ("swapped", file(swapped), 60, 0, "not in the order"),
        ("back", file(back), 60, 0, "is set back by 3600.000"),
        ("again", file(again), 40, 30, "of 3 parts the longest is read, lines 32 to 71"),
    ];
    for (name, text, rows, first, words) in cases {
        let (times, readings, remarks) = mended(&text);
        assert_eq!((times.len(), readings[0]), (rows, first as f64), "{name}");
        assert!(steps(&times).iter().all(|step| (step - 0.02).abs() < 1e-6), "{name}: {times:?}");
        assert!(remarks.len() == 1 && remarks[0].contains(words), "{name}: {remarks:?}");
    }
    let same: String = even(40).map(|time| format!("{time},{time}\n").repeat(2)).collect();
    let parts: String = even(40).map(|time| format!("{time},1,\n{time},,{time}\n")).collect();
    let event: String = even(40)
        .map(|time| if time == 0.4 { format!("{time},9\n{time},{time}\n") } else { format!("{time},{time}\n") })
        .collect();
    for text in [format!("t,x\n{same}"), format!("t,f,x\n{parts}"), format!("t,x\n{event}")] {
        let (times, readings, remarks) = mended(&text);
        assert_eq!((times.len(), &times), (40, &readings), "{remarks:?}");
        assert!(remarks.iter().any(|remark| remark.contains("have the time of the row before")), "{remarks:?}");
    }
    let (times, _, remarks) = mended(&file(twice));
    assert_eq!((times.len(), remarks), (80, vec![]), "rounded times stay: their rows are not one");
}
