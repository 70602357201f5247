//! Formats whose header says what the numbers are, as the importer reads them.

use kalmanscope_core::import::{Mapping, Table, read};

#[track_caller]
fn table_of(text: &str) -> (Table, Vec<String>) {
    let table = read(text.as_bytes(), None).unwrap();
    let names = table.columns.iter().map(|column| column.name.clone()).collect();
    (table, names)
}

/// A file of as many rows has columns of these names, some with `[unit]`, numbers by column and row, and remarks with these words.
#[track_caller]
fn check(text: &str, rows: usize, columns: &[&str], numbers: &[(usize, usize, f64)], remarks: &[&str]) -> Table {
    let (table, names) = table_of(text);
    assert_eq!((table.rows(), names.len()), (rows, columns.len()), "{names:?} in {text}");
    for (column, expected) in table.columns.iter().zip(columns) {
        let (name, unit) = expected.split_once(" [").unwrap_or((expected, ""));
        let unit = unit.trim_end_matches(']');
        let has_unit = unit.is_empty() || column.unit.as_deref() == Some(unit);
        assert!(column.name == name && has_unit, "{} [{:?}], not {expected}", column.name, column.unit);
    }
    for &(column, row, expected) in numbers {
        let found = table.columns[column].values[row];
        assert!(found == expected || found.is_nan() && expected.is_nan(), "{column}, {row}: {found}, not {expected}");
    }
    let all = table.remarks.iter().zip(remarks).all(|(remark, words)| remark.contains(words));
    assert!(all && table.remarks.len() == remarks.len(), "{:?}", table.remarks);
    table
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

const NEW: &str = "PEER NGA STRONG MOTION DATABASE RECORD\nImperial Valley-02, 5/19/1940, El Centro Array #9, 180\n\
                   ACCELERATION TIME SERIES IN UNITS OF G\nNPTS=     7, DT=   .0100 SEC,\n\
                   \x20  .1234567E-02  -.2345678E-02   .3000000E-02   .4000000E-02  -.5000000E-02\n\
                   \x20  .6000000E-02   .7000000E-02\n";

#[test]
fn accelerograms_have_their_channels_steps_and_units() {
    let columns = [1, 2].map(|channel| {
        let kinds = ["acceleration [cm/sec2]", "velocity, integrated", "displacement, integrated"];
        kinds.map(|kind| format!("channel {channel} 180 Deg {kind}"))
    });
    let columns: Vec<&str> = std::iter::once("time").chain(columns.iter().flatten().map(String::as_str)).collect();
    let abut = [(0, 3, 0.03), (1, 1, -1234.567), (1, 2, -2345.678), (1, 7, 123456.789), (4, 7, -12345.679)];
    check(&(v2(1, 1.0) + &v2(2, -0.1)), 8, &columns, &abut, &[]);
    let values: String = (0..100)
        .map(|k| format!("{:15.6}{}", [-999.0, 0.01][usize::from(k == 33)], ["", "\n"][usize::from(k % 5 == 4)]))
        .collect();
    let cosmos = format!(
        "Corrected acceleration    (Format v01.20 with 13 text lines)\nSta Chan   1:270 deg (Rcrdr Chan  1) Location:10\n\
         \x20100 Real-header values follow on  20 lines, Format= (5F15.6)\n{values}   1 Comment line(s) follow, each starting with a \"|\":\n\
         | Sensor: Kinemetrics_Episensor\n   12 acceleration pts, approx  0 secs, units=cm/s^2 (4),Format=(10F8.5)\n\
         -0.00003-0.00004-0.00004-0.00004-0.00004-0.00004-0.00004-0.00004-0.00004-0.00004\n 0.00001 0.00002\n\
         End-of-data for Chan  1 acceleration\n"
    );
    let step = [(0, 1, 0.01), (1, 1, -0.00004), (1, 11, 0.00002)];
    check(&cosmos, 12, &["time", "channel 1 270 deg acceleration"], &step, &[]);
    let peer = [(0, 6, 0.06), (1, 0, 0.001234567), (1, 1, -0.002345678), (1, 6, 0.007)];
    let table = check(NEW, 7, &["time", "acceleration [g]"], &peer, &[]);
    assert_eq!((table.line(0), table.line(5)), (5, 6));
    assert_eq!(table.form, "PEER (AT2): 1 series of 7 numbers, 0.01 s apart");
    let old = "PEER STRONG MOTION DATABASE\nVELOCITY TIME HISTORY IN UNITS OF CM/S\n    6    0.0200    NPTS, DT\n 1 2 3\n 4 5\n";
    check(old, 5, &["time", "velocity [cm/s]"], &[], &["`velocity` has 5 numbers, but its header says 6"]);
    let more = NEW.replace("NPTS=     7", "NPTS=     5");
    check(&more, 5, &["time", "acceleration"], &[], &["1 line(s) of numbers behind the last series"]);
}

fn series(name: &str, start: &str, numbers: &str) -> String {
    let count = numbers.split_whitespace().count();
    format!("TIMESERIES {name}, {count} samples, 50 sps, 2024-05-01T00:00:{start}, SLIST, FLOAT, M/S\n{numbers}\n")
}

#[test]
fn channels_stand_side_by_side_at_their_times_and_pieces_are_one_column() {
    let text = series("XX_A__HHZ_R", "01.000000", "1 2 3\n4 5 6") + &series("XX_A__HHN_R", "01.040000", "-1.5E-3 7\n8");
    let nan = f64::NAN;
    let numbers = [(0, 1, 0.02), (1, 5, 6.0), (2, 0, nan), (2, 2, -0.0015), (2, 4, 8.0), (2, 5, nan)];
    check(&text, 6, &["time", "XX_A__HHZ_R [m/s]", "XX_A__HHN_R"], &numbers, &[]);
    let text = series("XX_A__HHZ_R", "01.000000", "1 2") + &series("XX_A__HHZ_R", "01.080000", "5 6");
    check(&text, 6, &["time", "XX_A__HHZ_R"], &[(1, 1, 2.0), (1, 2, nan), (1, 3, nan), (1, 4, 5.0)], &[]);
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
    let spectrum = set(4, 12, [5, 2, 1], "  1.00000e+00  0.00000e+00  2.00000e+00  1.00000e+00\n");
    let units = "    -1\n   164\n         1  SI: Meter (newton)         2\n  1.0 1.0 1.0\n    -1\n";
    let text =
        units.to_owned() + &set(1, 12, [2, 7, 1], numbers) + &spectrum + &set(1, 13, [4, 7, 1], &(forces + "\n"));
    let columns = ["time", "Beam acceleration 7 +Z [m/s^2]", "Beam force 7 +Z"];
    let left = "`Beam acceleration 7 +Z` is a frequency response, not a function of time; it is left out";
    check(&text, 7, &columns, &[(0, 2, 0.01), (1, 1, -2.0), (1, 6, 7.0), (2, 6, 6.25)], &[left]);
    let none = read(spectrum.as_bytes(), None).unwrap_err().to_string();
    assert!(none.contains("is a frequency response, not a function of time, like all"), "{none}");
    let pairs = "  0.00000e+00  1.00000e+00  1.00000e-01  2.00000e+00  2.50000e-01  3.00000e+00\n";
    let uneven = [(0, 1, 0.1), (0, 2, 0.25), (1, 2, 3.0)];
    check(&set(1, 8, [2, 3, 0], pairs), 3, &["time", "Beam displacement 7 +Z"], &uneven, &[]);
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
fn labview_has_one_column_of_times_or_several_or_none() {
    let nan = f64::NAN;
    let names = "X_Value\tAcceleration\tForce\tComment";
    let one = file("One", names, "0.000000\t1.5\t2.5\tfirst\n0.250000\t1.25\t2.25\n0.500000\t1.0\t\n\t\t\t\n");
    check(&one, 3, &["time", "Acceleration [m/s^2]", "Force [N]"], &[(1, 1, 1.25), (1, 2, 1.0), (2, 2, nan)], &[]);
    let rows = "\t1.5\t2.5\n\t1.25\t2.25\n\t1.0\t2.0\n\nChannels\t2\nSamples\t3\t3\n***End_of_Header***\nX_Value\tA\tB\n\t9\t9\n";
    let another = "line 28 begins another table; it is left out, with all below it";
    check(&file("No", names, rows), 3, &["time", "Acceleration", "Force"], &[(0, 2, 0.5), (1, 2, 1.0)], &[another]);
    let comma =
        file("No", "X_Value\tA\tB", "\t1,5\t2\n\t1\t2\n").replace("Decimal_Separator\t.", "Decimal_Separator\t,");
    check(&comma.replace("2.500000E-1", "0,25"), 2, &["time", "A", "B"], &[(0, 1, 0.25)], &["3 rows, but there are 2"]);
    let equal = file("Multi", "X_Value\tA\tX_Value\tB\tComment", "0.0\t1\t0.0\t2\n0.25\t3\t0.25\t4\n");
    check(&equal, 2, &["time", "A", "B"], &[(2, 0, 2.0), (2, 1, 4.0)], &["3 rows, but there are 2"]);
    let unlike = "0.0\t1\t0.0\t2\n0.25\t3\t0.5\t4\n0.5\t5\t1.0\t6\n0.75\t7\t\t\n";
    let unlike = file("Multi", "X_Value\tA\tX_Value\tB\tComment", unlike)
        .replace("Delta_X\t2.500000E-1\t2.500000E-1", "Delta_X\t0.25\t\t0.5\t")
        .replace("m/s^2\tN", "m/s^2\t\tmm")
        .replace("Samples\t3\t2", "Samples\t4\t\t3");
    check(&unlike, 4, &["time", "A [m/s^2]", "time (2)", "B [mm]"], &[(2, 1, 0.5), (2, 2, 1.0)], &[]);
}

#[test]
fn oscilloscopes_and_loggers_have_settings_beside_and_above_their_columns() {
    let rigol = "X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-2.000000e-03,1.000000e-03\n0,1.0e-01,2.0e-02,,\n1,1.1e-01,2.1e-02,,\n2,1.2e-01,2.2e-02,,\n";
    check(rigol, 3, &["time", "CH1 [Volt]", "CH2"], &[(0, 0, -0.002), (0, 2, 0.0), (2, 2, 0.022)], &[]);
    let newer = "Time(s),CH1(V),t0 = -5e-01, tInc = 2.5e-01,\n,0.5,,\n,0.25,,\n,0.125,,\n";
    check(newer, 3, &["time", "CH1"], &[(0, 2, 0.0), (1, 2, 0.125)], &[]);
    let tektronix = "Record Length,2.500000e+03,,-0.005000000000,  0.00000,\nSample Interval,4.000000e-06,,-0.004996000000,  0.00160,\n\
                Trigger Point,1.250000000000e+03,,-0.004992000000, -0.00320,\n,,,-0.004988000000,  0.00480,\n,,,-0.004984000000,  0.00160,\n\
                ,,,-0.004980000000,  0.00160,\nSource,CH2,,-0.004976000000,  0.00000,\nVertical Units,V,,-0.004972000000,  0.00160,\n\
                Vertical Scale,2.000000e-02,,-0.004968000000,  0.00160,\nHorizontal Units,s,,-0.004964000000,  0.00000,\n\
                ,,,-0.004960000000,  0.00160,\n";
    check(tektronix, 11, &["time [s]", "CH2 [V]"], &[(0, 2, -0.004992), (1, 3, 0.0048)], &[]);
    let campbell = "\"TOA5\",\"Bridge\",\"CR6\",\"1234\",\"CR6.Std.08\",\"CPU:acc.CR6\",\"51234\",\"Fast\"\n\
                \"TIMESTAMP\",\"RECORD\",\"Accel_1\",\"Batt_V\"\n\"TS\",\"RN\",\"m/s^2\",\"Volts\"\n\"\",\"\",\"Smp\",\"Smp\"\n\
                \"2024-05-01 12:00:00\",0,0.125,12.5\n\"2024-05-01 12:00:00.02\",1,-0.25,12.5\n\
                \"2024-05-01 12:00:00.04\",2,\"NAN\",12.5\n";
    let columns = ["TIMESTAMP", "RECORD", "Accel_1 [m/s^2]", "Batt"];
    let table = check(campbell, 3, &columns, &[(2, 1, -0.25), (2, 2, f64::NAN)], &[]);
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
        assert!(table.remarks[0].contains("one series that continues in the next line"), "{:?}", table.remarks);
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
