//! Formats whose header says what the numbers are, as the importer reads them.

use kalmanscope_core::import::{Mapping, Table, read};

#[track_caller]
fn table_of(text: &str) -> (Table, Vec<String>) {
    let table = read(text.as_bytes(), None).unwrap();
    let names = table.columns.iter().map(|column| column.name.clone()).collect();
    (table, names)
}

fn v2(channel: u32, size: f64) -> String {
    let block = |kind: &str, unit: &str, form: &str, rows: &[[f64; 4]]| {
        let head =
            format!(" {} points of {kind} data equally spaced at 0.010 sec, in {unit}. ({form})    \n", 4 * rows.len());
        let row = |row: &[f64; 4]| row.map(|x| format!("{:10.3}", size * x)).concat() + "\n";
        head + &rows.iter().map(row).collect::<String>()
    };
    format!("Corrected accelerogram   89486-N2628-22354.08       Chan  {channel}: 180 Deg     from   \n")
        + "Uncorrected Accelerogram Data\n 8 points of instrument- and baseline-corrected accel, veloc and displ data \n"
        + "At equally-spaced intervals of   0.010  sec.\n"
        + &format!("89486-N2628-22354.08      Fortuna - 701 S. Fortuna Blvd.    Chan  {channel}: 180 Deg    \n")
        + "    1  100    1    3    3  200    1\n 0.0049020 0.7000000 101.00000-999.00000-999.00000\n"
        + &block("accel", "cm/sec2", "8f10.3", &[[-0.001, -1234.567, -2345.678, 12.0], [1.0, 2.0, 3.0, 123456.789]])
        + &block("veloc", "cm/sec", "8f10.3", &[[1.0, 2.0, 3.0, 4.0]; 2])
        + &block("displ", "cm", "8f10.3", &[[4.0, 3.0, 2.0, 1.0]; 2])
        + &format!("/&  ----------  End of data for channel  {channel}  ----------\n")
}

#[test]
fn numbers_that_abut_and_several_channels_are_read() {
    let (table, names) = table_of(&(v2(1, 1.0) + &v2(2, -0.1)));
    let expected = ["acceleration", "velocity, integrated", "displacement, integrated"];
    let expected = [1, 2].map(|channel| expected.map(|kind| format!("channel {channel} 180 Deg {kind}"))).concat();
    assert_eq!(names[1..], expected);
    assert_eq!(table.columns[1].values, [-0.001, -1234.567, -2345.678, 12.0, 1.0, 2.0, 3.0, 123456.789]);
    assert_eq!(table.columns[4].values[7], -12345.679);
    assert_eq!((table.columns[1].unit.as_deref(), table.columns[0].values[3]), (Some("cm/sec2"), 0.03));
    assert_eq!(table.remarks, Vec::<String>::new());
}

#[test]
fn the_step_of_cosmos_stands_among_the_real_values() {
    let values: String = (0..100)
        .map(|k| format!("{:15.6}{}", [-999.0, 0.01][usize::from(k == 33)], ["", "\n"][usize::from(k % 5 == 4)]))
        .collect();
    let text = format!(
        "Corrected acceleration    (Format v01.20 with 13 text lines)\nSta Chan   1:270 deg (Rcrdr Chan  1) Location:10\n\
         \x20100 Real-header values follow on  20 lines, Format= (5F15.6)\n{values}   1 Comment line(s) follow, each starting with a \"|\":\n\
         | Sensor: Kinemetrics_Episensor\n   12 acceleration pts, approx  0 secs, units=cm/s^2 (4),Format=(10F8.5)\n\
         -0.00003-0.00004-0.00004-0.00004-0.00004-0.00004-0.00004-0.00004-0.00004-0.00004\n 0.00001 0.00002\n\
         End-of-data for Chan  1 acceleration\n"
    );
    let (table, names) = table_of(&text);
    assert_eq!(names, ["time", "channel 1 270 deg acceleration"]);
    assert_eq!((table.rows(), table.columns[0].values[1], table.columns[1].values[11]), (12, 0.01, 0.00002));
    assert_eq!(table.columns[1].values[1], -0.00004);
}

const NEW: &str = "PEER NGA STRONG MOTION DATABASE RECORD\nImperial Valley-02, 5/19/1940, El Centro Array #9, 180\n\
                   ACCELERATION TIME SERIES IN UNITS OF G\nNPTS=     7, DT=   .0100 SEC,\n\
                   \x20  .1234567E-02  -.2345678E-02   .3000000E-02   .4000000E-02  -.5000000E-02\n\
                   \x20  .6000000E-02   .7000000E-02\n";

#[test]
fn a_series_is_one_column_whatever_its_lines() {
    let (table, names) = table_of(NEW);
    assert_eq!(names, ["time", "acceleration"]);
    assert_eq!(table.columns[1].unit.as_deref(), Some("g"));
    assert_eq!(table.columns[1].values, [0.001234567, -0.002345678, 0.003, 0.004, -0.005, 0.006, 0.007]);
    assert_eq!(table.columns[0].values[6], 0.06);
    assert_eq!((table.line(0), table.line(5)), (5, 6));
    assert_eq!(table.form, "PEER (AT2): 1 series of 7 numbers, 0.01 s apart");
}

#[test]
fn older_headers_and_velocities_are_known_and_what_is_missing_is_said() {
    let old = "PEER STRONG MOTION DATABASE\nVELOCITY TIME HISTORY IN UNITS OF CM/S\n    6    0.0200    NPTS, DT\n 1 2 3\n 4 5\n";
    let (table, names) = table_of(old);
    assert_eq!((names[1].as_str(), table.rows()), ("velocity", 5));
    assert_eq!(table.columns[1].unit.as_deref(), Some("cm/s"));
    assert_eq!(table.remarks, ["`velocity` has 5 numbers, but its header tells of 6"]);
    let more = NEW.replace("NPTS=     7", "NPTS=     5");
    let (table, _) = table_of(&more);
    assert_eq!((table.rows(), table.remarks.len()), (5, 1));
    assert!(table.remarks[0].contains("1 line(s) of numbers behind the last series"), "{:?}", table.remarks);
}

fn series(name: &str, start: &str, numbers: &str) -> String {
    let count = numbers.split_whitespace().count();
    format!("TIMESERIES {name}, {count} samples, 50 sps, 2024-05-01T00:00:{start}, SLIST, FLOAT, M/S\n{numbers}\n")
}

#[test]
fn channels_stand_side_by_side_at_their_times() {
    let text = series("XX_A__HHZ_R", "01.000000", "1 2 3\n4 5 6") + &series("XX_A__HHN_R", "01.040000", "-1.5E-3 7\n8");
    let (table, names) = table_of(&text);
    assert_eq!(names, ["time", "XX_A__HHZ_R", "XX_A__HHN_R"]);
    assert_eq!(table.columns[1].values, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(table.columns[2].values[2..5], [-0.0015, 7.0, 8.0]);
    assert!(table.columns[2].values[0].is_nan() && table.columns[2].values[5].is_nan());
    assert_eq!((table.columns[0].values[1], table.columns[1].unit.as_deref()), (0.02, Some("m/s")));
}

#[test]
fn a_series_in_pieces_is_one_column_with_a_gap() {
    let text = series("XX_A__HHZ_R", "01.000000", "1 2") + &series("XX_A__HHZ_R", "01.080000", "5 6");
    let (table, names) = table_of(&text);
    assert_eq!(names, ["time", "XX_A__HHZ_R"]);
    assert_eq!(format!("{:?}", table.columns[1].values), "[1.0, 2.0, NaN, NaN, 5.0, 6.0]");
}

fn set(function: u32, quantity: u32, [kind, count, is_even]: [usize; 3], data: &str) -> String {
    format!(
        "    -1\n    58\nBeam\nNONE\n01-May-24 12:00:00\nNONE\nNONE\n\
         {function:5}         1    0         0 NONE               7   3 NONE               1   3\n\
         {kind:10}{count:10}{is_even:10}    0.00000e0   5.00000e-3    0.00000e0\n\
         \x20       17    0    0    0 Time                 s                   \n\
         {quantity:10}    0    0    0 Response             m/s^2               \n\
         \x20        0    0    0    0 NONE                 NONE                \n\
         \x20        0    0    0    0 NONE                 NONE                \n{data}    -1\n"
    )
}

#[test]
fn functions_of_time_are_columns_and_others_are_left_out() {
    let numbers = "  1.00000e+00 -2.00000e+00  3.00000e+00  4.00000e+00  5.00000e+00  6.00000e+00\n  7.00000e+00\n";
    let forces: String =
        (0..7).map(|k| format!("{:20.12}{}", f64::from(k) + 0.25, ["", "\n"][usize::from(k % 4 == 3)])).collect();
    let spectrum = "  1.00000e+00  0.00000e+00  2.00000e+00  1.00000e+00\n";
    let units = "    -1\n   164\n         1  SI: Meter (newton)         2\n  1.0 1.0 1.0\n    -1\n";
    let text = units.to_owned()
        + &set(1, 12, [2, 7, 1], numbers)
        + &set(4, 12, [5, 2, 1], spectrum)
        + &set(1, 13, [4, 7, 1], &(forces + "\n"));
    let (table, names) = table_of(&text);
    assert_eq!(names, ["time", "Beam acceleration 7 +Z", "Beam force 7 +Z"]);
    assert_eq!(table.columns[1].values, [1.0, -2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    assert_eq!(table.columns[2].values[6], 6.25);
    assert_eq!((table.columns[0].values[2], table.columns[1].unit.as_deref()), (0.01, Some("m/s^2")));
    let left = "`Beam acceleration 7 +Z` is a frequency response, no function of time; it is left out";
    assert_eq!(table.remarks, [left]);
    let none = read(set(4, 12, [5, 2, 1], spectrum).as_bytes(), None).unwrap_err().to_string();
    assert!(
        none.starts_with("`Beam acceleration 7 +Z` is a frequency response, no function of time, and none"),
        "{none}"
    );
}

#[test]
fn uneven_functions_bring_their_times() {
    let pairs = "  0.00000e+00  1.00000e+00  1.00000e-01  2.00000e+00  2.50000e-01  3.00000e+00\n";
    let (table, names) = table_of(&set(1, 8, [2, 3, 0], pairs));
    assert_eq!(names, ["time", "Beam displacement 7 +Z"]);
    assert_eq!(
        (table.columns[0].values.as_slice(), table.columns[1].values.as_slice()),
        (&[0.0, 0.1, 0.25][..], &[1.0, 2.0, 3.0][..])
    );
}

fn file(columns: &str, names: &str, rows: &str) -> String {
    format!(
        "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\nMulti_Headings\tYes\n\
         X_Columns\t{columns}\nTime_Pref\tRelative\nOperator\tLab\nDate\t2024/05/01\nTime\t12:00:00.0000000000000000000\n\
         ***End_of_Header***\t\n\t\nChannels\t2\t\t\nSamples\t3\t2\t\nDate\t2024/05/01\t2024/05/01\t\nTime\t12:00:00.5\t12:00:00.5\t\n\
         Y_Unit_Label\tm/s^2\tN\t\nX_Dimension\tTime\tTime\t\nX0\t0.0000000000000000E+0\t0.0000000000000000E+0\t\n\
         Delta_X\t2.500000E-1\t2.500000E-1\t\n***End_of_Header***\t\t\t\n{names}\n{rows}"
    )
}

#[test]
fn one_column_of_times_and_channels_of_unequal_length_are_read() {
    let text = file(
        "One",
        "X_Value\tAcceleration\tForce\tComment",
        "0.000000\t1.5\t2.5\tfirst\n0.250000\t1.25\t2.25\n0.500000\t1.0\t\n\t\t\t\n",
    );
    let (table, names) = table_of(&text);
    assert_eq!(names, ["time", "Acceleration", "Force"]);
    assert_eq!((table.columns[1].unit.as_deref(), table.columns[2].unit.as_deref()), (Some("m/s^2"), Some("N")));
    assert_eq!(table.columns[1].values, [1.5, 1.25, 1.0]);
    assert!(table.columns[2].values[2].is_nan());
}

#[test]
fn without_times_the_step_of_the_header_counts_and_other_segments_are_told() {
    let rows = "\t1.5\t2.5\n\t1.25\t2.25\n\t1.0\t2.0\n\nChannels\t2\nSamples\t3\t3\n***End_of_Header***\nX_Value\tA\tB\n\t9\t9\n";
    let (table, names) = table_of(&file("No", "X_Value\tAcceleration\tForce\tComment", rows));
    assert_eq!(names, ["time", "Acceleration", "Force"]);
    assert_eq!((table.rows(), table.columns[0].values[2], table.columns[1].values[2]), (3, 0.5, 1.0));
    assert_eq!(table.remarks, ["line 28 begins another table; it is left out, with all below it"]);
    let comma = file("No", "X_Value\tA\tB", "\t1,5\t2\n\t1\t2\n")
        .replace("Decimal_Separator\t.", "Decimal_Separator\t,")
        .replace("2.500000E-1", "0,25");
    assert_eq!(table_of(&comma).0.columns[0].values[1], 0.25);
}

#[test]
fn of_several_columns_of_times_the_first_counts() {
    let text = file("Multi", "X_Value\tA\tX_Value\tB\tComment", "0.0\t1\t0.0\t2\n0.25\t3\t0.25\t4\n");
    let (table, names) = table_of(&text);
    assert_eq!(names, ["time", "A", "B"]);
    assert_eq!(table.columns[2].values, [2.0, 4.0]);
}

#[test]
fn times_follow_from_start_and_increment() {
    let (table, names) = table_of(
        "X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-2.000000e-03,1.000000e-03\n0,1.0e-01,2.0e-02,,\n1,1.1e-01,2.1e-02,,\n2,1.2e-01,2.2e-02,,\n",
    );
    assert_eq!(names, ["time", "CH1", "CH2"]);
    assert_eq!(table.columns[0].values, [-0.002, -0.001, 0.0]);
    assert_eq!((table.columns[1].unit.as_deref(), table.columns[2].values[2]), (Some("Volt"), 0.022));
    let (table, names) = table_of("Time(s),CH1(V),t0 = -5e-01, tInc = 2.5e-01,\n,0.5,,\n,0.25,,\n,0.125,,\n");
    assert_eq!(names, ["time", "CH1"]);
    assert_eq!((table.columns[0].values[2], table.columns[1].values[2]), (0.0, 0.125));
}

#[test]
fn settings_are_no_columns() {
    let text = "Record Length,2.500000e+03,,-0.005000000000,  0.00000,\nSample Interval,4.000000e-06,,-0.004996000000,  0.00160,\n\
                Trigger Point,1.250000000000e+03,,-0.004992000000, -0.00320,\n,,,-0.004988000000,  0.00480,\n,,,-0.004984000000,  0.00160,\n\
                ,,,-0.004980000000,  0.00160,\nSource,CH2,,-0.004976000000,  0.00000,\nVertical Units,V,,-0.004972000000,  0.00160,\n\
                Vertical Scale,2.000000e-02,,-0.004968000000,  0.00160,\nHorizontal Units,s,,-0.004964000000,  0.00000,\n\
                ,,,-0.004960000000,  0.00160,\n";
    let (table, names) = table_of(text);
    assert_eq!(names, ["time", "CH2"]);
    assert_eq!((table.rows(), table.columns[0].values[2], table.columns[1].values[3]), (11, -0.004992, 0.0048));
    assert_eq!((table.columns[0].unit.as_deref(), table.columns[1].unit.as_deref()), (Some("s"), Some("V")));
}

#[test]
fn names_and_units_stand_in_the_second_and_third_line() {
    let text = "\"TOA5\",\"Bridge\",\"CR6\",\"1234\",\"CR6.Std.08\",\"CPU:acc.CR6\",\"51234\",\"Fast\"\n\
                \"TIMESTAMP\",\"RECORD\",\"Accel_1\",\"Batt_V\"\n\"TS\",\"RN\",\"m/s^2\",\"Volts\"\n\"\",\"\",\"Smp\",\"Smp\"\n\
                \"2024-05-01 12:00:00\",0,0.125,12.5\n\"2024-05-01 12:00:00.02\",1,-0.25,12.5\n\
                \"2024-05-01 12:00:00.04\",2,\"NAN\",12.5\n";
    let (table, names) = table_of(text);
    assert_eq!(names, ["TIMESTAMP", "RECORD", "Accel_1", "Batt"]);
    assert_eq!(table.columns[2].unit.as_deref(), Some("m/s^2"));
    assert_eq!((table.rows(), table.columns[2].values[1]), (3, -0.25));
    assert!(table.form.starts_with("Campbell TOA5: UTF-8, commas"), "{}", table.form);
    let (mapping, _) = Mapping::guess(&table);
    assert_eq!(mapping.time.column.as_deref(), Some("TIMESTAMP"));
    assert!(mapping.input.is_none(), "neither the row's number nor the battery is a force");
}

/// What LabVIEW's files leave open, and say wrongly: separators, decimal characters, and how many rows there are.
#[test]
fn what_a_header_leaves_open_is_found_and_what_it_says_wrongly_is_said() {
    let rows = |count: usize| (0..count).map(|k| format!("{}.00\t{}.5\n", k % 4, k)).collect::<String>();
    let one = |samples: usize, count: usize| {
        let text = file("One", "X_Value\tAcceleration\tComment", &rows(count));
        text.replace("Samples\t3\t2", &format!("Samples\t{samples}"))
    };
    let commas = |text: String| text.replace("Decimal_Separator\t.\n", "").replace('.', ",");
    let without = |text: String| text.replace("X_Columns\tOne", "X_Columns\tNo");
    for (text, rows, step, said) in [
        (one(4, 4).replace('\t', ","), 4, 1.0, None),
        (commas(one(4, 4)), 4, 1.0, None),
        (one(4, 4).replace(".5\n", ",5\n").replace(".00", ",00"), 4, 1.0, None),
        (one(4, 12), 4, 1.0, Some("4 rows, but there are 12: 3 part(s) of 4; the first part is read")),
        (one(4, 10), 4, 1.0, Some("4 rows, but there are 10: 2 part(s) of 4 and 2 more rows; the first part")),
        (without(one(4, 8)), 4, 0.25, Some("4 rows, but there are 8: 2 part(s) of 4; the first part is read")),
        (one(3, 4), 4, 1.0, Some("3 rows, but there are 4; all are read")),
        (without(one(9, 8)), 8, 0.25, Some("9 rows, but there are 8; all are read")),
    ] {
        let (table, names) = table_of(&text);
        assert_eq!(names, ["time", "Acceleration"], "{text}");
        assert_eq!((table.rows(), table.columns[0].values[1], table.columns[1].values[1]), (rows, step, 1.5), "{text}");
        assert_eq!(table.remarks.len(), said.iter().len(), "{:?}", table.remarks);
        assert!(said.is_none_or(|said| table.remarks[0].contains(said)), "{:?}", table.remarks);
    }
}

#[test]
fn unlike_columns_of_times_are_clocks() {
    let text = file(
        "Multi",
        "X_Value\tA\tX_Value\tB\tComment",
        "0.0\t1\t0.0\t2\n0.25\t3\t0.5\t4\n0.5\t5\t1.0\t6\n0.75\t7\t\t\n",
    );
    let text = text
        .replace("Delta_X\t2.500000E-1\t2.500000E-1", "Delta_X\t0.25\t\t0.5\t")
        .replace("m/s^2\tN", "m/s^2\t\tmm")
        .replace("Samples\t3\t2", "Samples\t4\t\t3");
    let (table, names) = table_of(&text);
    assert_eq!((names, table.remarks.len()), (["time", "A", "time (2)", "B"].map(str::to_owned).to_vec(), 0));
    assert_eq!([&table.columns[1], &table.columns[3]].map(|c| c.unit.as_deref()), [Some("m/s^2"), Some("mm")]);
    assert_eq!(table.columns[2].values[..3], [0.0, 0.5, 1.0]);
}

fn swing(k: usize) -> f64 {
    (-0.002 * k as f64).exp() * (0.1 * k as f64).sin()
}

fn lines(width: usize, of: impl Fn(usize) -> f64) -> String {
    (0..403).map(|k| format!("{:10.0}{}", 1e5 * of(k), if k % width + 1 == width { "\n" } else { "" })).collect()
}

/// A series in lines is one column whatever its header is, if it has one; the last line may be shorter.
#[test]
fn a_series_in_lines_of_numbers_is_one_column() {
    for (header, width, step, unit, scale) in [
        (
            "Station TST\nSampling Freq(Hz) 100Hz\nScale Factor      3920(gal)/6182761\nMax. Acc. (gal)   126.8\nMemo.\n",
            8,
            Some(0.01),
            Some("gal"),
            3920.0 / 6_182_761.0,
        ),
        ("DELTA: 1.000000e-02\nLENGTH: 403\nCOMP: Z\n", 4, Some(0.01), None, 1.0),
        (
            "OLD LISTING\nACCELERATION IN CM/SEC/SEC AT EQUALLY SPACED INTERVALS OF 0.02 SEC\n",
            10,
            Some(0.02),
            Some("cm/sec/sec"),
            1.0,
        ),
        ("a test\nDT=0.01\n", 5, Some(0.01), None, 1.0),
        ("sampled at 200 sps\n", 6, Some(0.005), None, 1.0),
        ("Sample interval: 5 ms, units = mm\n", 6, Some(0.005), Some("mm"), 1.0),
        ("", 3, None, None, 1.0),
    ] {
        let (table, names) = table_of(&(header.to_owned() + &lines(width, swing)));
        assert_eq!((table.rows(), names.len()), (403, 1 + usize::from(step.is_some())), "{header}: {names:?}");
        let series = table.columns.last().unwrap();
        assert!(
            (series.values[402] - scale * rounded(1e5 * swing(402))).abs() < 1e-6,
            "{header}: {}",
            series.values[402]
        );
        assert_eq!(series.unit.as_deref(), unit, "{header}");
        assert!(step.is_none_or(|step| (table.columns[0].values[1] - step).abs() < 1e-12), "{header}");
        assert!(table.remarks[0].contains("one series that runs on in the next line"), "{:?}", table.remarks);
    }
}

fn rounded(x: f64) -> f64 {
    format!("{x:.0}").parse().unwrap()
}

/// Channels that move together, noise, and times are no series in lines.
#[test]
fn channels_are_no_series_in_lines() {
    let noise = |k: usize| f64::from((k as u32).wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 24);
    let channels: [&dyn Fn(usize, usize) -> f64; 6] = [
        &|row, place| swing(8 * row) * (0.7 + 0.1 * place as f64),
        &|row, place| swing(8 * row) + 1e-3 * noise(4 * row + place),
        &|row, place| swing(3 * row) + 0.3 * noise(4 * row + place),
        &|row, place| noise(7 * row + 3 * place),
        &|row, place| if place == 0 { 0.01 * row as f64 } else { swing(2 * row + place) },
        &|row, place| swing(20 * row + 2 * place),
    ];
    for (nth, of) in channels.into_iter().enumerate() {
        let row = |row: usize| (0..4).map(|place| format!("{:10.5}", of(row, place))).collect::<String>() + "\n";
        let (table, _) = table_of(&(0..200).map(row).collect::<String>());
        assert_eq!((table.columns.len(), table.rows()), (4, 200), "{nth}");
    }
}

#[test]
fn a_header_of_keys_says_rate_and_unit_of_one_column() {
    let numbers: String = (0..50).map(|k| format!("{:.5}\n", swing(k))).collect();
    let keys = "STATION_CODE: XYZ\nVS30_M/S: 500\nSAMPLING_INTERVAL_S: 0.005000\nUNITS: cm/s^2\nUSER5:\n";
    for header in [keys, "Sampling rate = 200 Hz\nacceleration [cm/s^2]\n"] {
        let (table, names) = table_of(&(header.to_owned() + &numbers));
        assert_eq!((names, table.rows()), (vec!["time".to_owned(), "acceleration".to_owned()], 50), "{header}");
        assert_eq!((table.columns[0].values[1], table.columns[1].unit.as_deref()), (0.005, Some("cm/s^2")), "{header}");
    }
    assert_eq!(table_of("x\n1\n2\n3\n").1, ["x"]);
}

#[test]
fn seismograms_of_sac_have_their_header_in_numbers_and_texts() {
    let five = |of: &dyn Fn(usize) -> String, count: usize| {
        (0..count).map(|k| of(k) + if k % 5 == 4 { "\n" } else { "" }).collect::<String>()
    };
    let floats = five(&|k| format!("{:>15}", if k == 0 { "0.01" } else { "-12345.00" }), 70);
    let wholes = five(
        &|k| format!("{:>10}", [(6, 6), (9, 403), (16, 8)].into_iter().find(|at| at.0 == k).map_or(-12_345, |at| at.1)),
        40,
    );
    let texts = "TST     EVENT           \n".to_owned()
        + &"-12345  -12345  -12345  \n".repeat(5)
        + "-12345  -12345  BHZ     \n-12345  -12345  -12345  \n";
    let (table, names) = table_of(&(floats + &wholes + &texts + &lines(5, swing)));
    assert_eq!(names, ["time", "TST BHZ acceleration"]);
    assert_eq!((table.rows(), table.columns[0].values[1]), (403, 0.01));
    assert_eq!(table.columns[1].values[10], rounded(1e5 * swing(10)));
}
