//! The meaning of columns, as the importer guesses it, and readings that failed.

use kalmanscope_core::import::{Imported, Mapping, Sentinel, build, read};
use kalmanscope_core::{Hold, InputKind, Quantity};

#[track_caller]
fn check(text: &str, time: Option<&str>, input: Option<&str>, sensors: &[(Quantity, &str)]) -> InputKind {
    let table = read(text.as_bytes(), None).unwrap();
    let (mapping, kind) = Mapping::guess(&table);
    assert_eq!(mapping.time.column.as_deref(), time, "{text}");
    assert_eq!(mapping.input.as_ref().map(|input| input.column.as_str()), input, "{text}");
    let found: Vec<_> = mapping.sensors.iter().map(|(q, column)| (*q, column.column.as_str())).collect();
    assert_eq!(found, sensors, "{text}");
    kind
}

#[test]
fn names_and_shapes_are_understood() {
    let x = Quantity::DISPLACEMENT;
    check("t,force,displacement\n0,1,2\n1,0,3\n2,1,2\n", Some("t"), Some("force"), &[(x, "displacement")]);
    check("Time,Force,Displacement\n0,1,2\n1,0,3\n2,1,1\n", Some("Time"), Some("Force"), &[(x, "Displacement")]);
    check("V1,V2\n0.1,0.2\n0.3,-0.1\n0.2,0\n", None, Some("V1"), &[(x, "V2")]);
    check("0 1 2\n0.1 0 3\n0.2 1 0\n", Some("column 1"), Some("column 2"), &[(x, "column 3")]);
    let angle = "Time,\"Angle, Ch 1+2 (rad) Run #13\"\n0,0.5\n0.1,0.4\n0.2,0.1\n";
    check(angle, Some("Time"), None, &[(x, "Angle, Ch 1+2 Run #13")]);
    let ground = "time,ground acc (g),total_acceleration\n0,0.1,1\n1,0.2,1\n2,0.1,2\n";
    let total = Quantity::TOTAL_ACCELERATION;
    assert_eq!(
        check(ground, Some("time"), Some("ground acc"), &[(total, "total_acceleration")]),
        InputKind::GroundAcceleration
    );
    let felt = "time,ground (g),roof acc (g)\n0,0.1,1\n1,0.2,1\n2,0.1,2\n";
    check(felt, Some("time"), Some("ground"), &[(total, "roof acc")]);
    check("time,acc (g)\n0,1\n1,-1\n2,0\n", Some("time"), None, &[(Quantity::ACCELERATION, "acc")]);
    check("Zeit;Kraft;Weg\n0,0;1;2\n0,1;0;3\n0,2;1;1\n", Some("Zeit"), Some("Kraft"), &[(x, "Weg")]);
    check("1\n3\n2\n", None, None, &[(x, "column 1")]);
    let axes = "time,ax,ay,az\n0,1,2,3\n1,2,0,1\n2,0,1,2\n";
    check(axes, Some("time"), None, &[(Quantity::ACCELERATION, "ax")]);
    let phone = "Time (s),Linear Acceleration x (m/s^2),Linear Acceleration y (m/s^2),Linear Acceleration z (m/s^2)\n\
                 0,1,2,3\n1,2,0,1\n2,0,1,2\n";
    check(phone, Some("Time"), None, &[(Quantity::ACCELERATION, "Linear Acceleration x")]);
    check("t,x,y\n0,1,2\n1,2,0\n2,0,1\n", Some("t"), None, &[(x, "x")]);
    check("t,other_velocity,x\n0,1,2\n1,2,0\n2,0,1\n", Some("t"), None, &[(x, "x")]);
    let both = "t,my velocity,velocity\n0,1,2\n1,2,0\n2,0,1\n";
    check(both, Some("t"), None, &[(Quantity::VELOCITY, "velocity")]);
    let logger = "TIMESTAMP,RECORD,accel,batt\n0,5,2,12\n1,6,0,12\n2,7,1,12\n";
    check(logger, Some("TIMESTAMP"), None, &[(Quantity::ACCELERATION, "accel")]);
    let station = "time,XX_A_DISP (m)\n0,1\n1,2\n2,1\n";
    check(station, Some("time"), None, &[(x, "XX_A_DISP")]);
    let several = "time,gauge 1,gauge 2,accel\n0,1,2,3\n1,2,0,1\n2,0,1,2\n";
    check(several, Some("time"), None, &[(Quantity::ACCELERATION, "accel")]);
    let one = "time,gauge 1,accel\n0,1,3\n1,2,1\n2,0,2\n";
    check(one, Some("time"), Some("gauge 1"), &[(Quantity::ACCELERATION, "accel")]);
    check("t,x,true_displacement\n0,1,1\n1,2,2\n2,1,1\n", Some("t"), None, &[(x, "x")]);
}
#[test]
fn a_usual_number_for_missing_readings_is_guessed() {
    let table = read("t,force,x\n0,1,2\n1,0,-9999\n2,1,2.5\n3,1,-9999\n4,1,2.25\n".as_bytes(), None).unwrap();
    let (mapping, _) = Mapping::guess(&table);
    assert_eq!(mapping.sensors[&Quantity::DISPLACEMENT].missing, Some(-9999.0));
    assert_eq!(mapping.input.unwrap().missing, None);
}

fn swing(k: u32) -> f64 {
    (0.3 * f64::from(k)).sin()
}

/// What each column of a file is taken for, but for why it has a meaning.
fn meanings(header: &str, row: fn(u32) -> String) -> Vec<String> {
    let text = format!("{header}\n") + &(0..60).map(|k| row(k) + "\n").collect::<String>();
    let (mapping, _, guesses) = Mapping::guess_for(&read(text.as_bytes(), None).unwrap(), &[]);
    let of = |name: &String| {
        let sensor = mapping.sensors.iter().find(|(_, column)| column.column == *name);
        let is_input = mapping.input.as_ref().is_some_and(|input| input.column == *name);
        let input = is_input.then(|| "input".to_owned());
        let time = (mapping.time.column.as_ref() == Some(name)).then(|| "time".to_owned());
        time.or(input).or_else(|| sensor.map(|(quantity, _)| quantity.key().to_owned()))
    };
    guesses.iter().map(|guess| of(&guess.column).unwrap_or_else(|| guess.why.to_owned())).collect()
}

type Case = (&'static str, fn(u32) -> String, &'static [&'static str]);

const STILL: &str = "its numbers never change";
const COUNTER: &str = "it counts the rows";
const UNIT: &str = "its unit is that of neither a motion nor a force";
const AXIS: &str = "another axis moves more";
const TURNS: &str = "it turns, and another sensor moves along a line";

#[test]
fn what_is_no_motion_is_left_out_and_of_axes_the_liveliest_counts() {
    let cases: [Case; 13] = [
        (
            "time (s),Pressure (MPa),T (°C),Volume (ml)",
            |k| format!("{k}.5,{},2,{}", swing(k), swing(k + 3)),
            &["time", UNIT, UNIT, UNIT],
        ),
        (
            "Zeit [s],Druck [bar],Weg [mm]",
            |k| format!("{k}.5,{},{}", swing(k), swing(k + 3)),
            &["time", UNIT, "displacement"],
        ),
        (
            "timestamp,accelerometer_m_s2[0],accelerometer_m_s2[1],accelerometer_m_s2[2],device_id",
            |k| format!("{k}0000,{},{},{},3932170", 0.01 * swing(k), 0.02 * swing(k), swing(k)),
            &["time", AXIS, AXIS, "acceleration", "its name says that it is something else"],
        ),
        (
            "time,seconds_elapsed,z,y,x",
            |k| format!("17145648{k:02}0000000,{k}.5,{},0.1,{}", swing(k), 0.1 * swing(k)),
            &["time", "another column has that meaning already", "acceleration", AXIS, AXIS],
        ),
        (
            "t,x,y,z",
            |k| format!("{k}.5,{},{},0.1{}", swing(k), 2.0 * swing(k), k % 3),
            &["time", AXIS, "displacement", AXIS],
        ),
        (
            "Time (s),Gyroscope x (rad/s),Gyroscope y (rad/s),Gyroscope z (rad/s)",
            |k| format!("{k}.5,{},{},{}", 0.01 * swing(k), 0.02 * swing(k), swing(k)),
            &["time", AXIS, AXIS, "velocity"],
        ),
        (
            "packet,t,AccX,AccY,gyro_x (deg/s),gyro_y (deg/s)",
            |k| format!("{},{k}.5,{},{},{},{}", k % 16, swing(k), 0.1 * swing(k), swing(k), 0.1 * swing(k)),
            &[COUNTER, "time", "acceleration", AXIS, TURNS, AXIS],
        ),
        (
            "t_a,U_bus (V),V (l),level_%,t_b,fork_travel_mm",
            |k| format!("{k}.5,{},{},{},{k}.7,{}", 24.0 + 0.1 * swing(k), swing(k), swing(k), swing(k + 3)),
            &[
                "time",
                "it is a voltage that hardly changes, as that of a supply",
                UNIT,
                "its name says that it is something else",
                "it has the times of other columns",
                "displacement",
            ],
        ),
        ("time,Voltage_0 (V),Voltage_1 (V)", |k| format!("{k}.5,0.001,{}", swing(k)), &["time", STILL, "displacement"]),
        (
            "loopIteration,time,SampleC,acc",
            |k| format!("{},{k}.5,{},{}", 8 * k, k + k / 9, swing(k)),
            &[COUNTER, "time", COUNTER, "acceleration"],
        ),
        (
            "time,ticks,level,mass",
            |k| format!("{k}.5,{},{},{}", k + k / 9, swing(k), swing(k + 3)),
            &["time", COUNTER, "its name says that it is something else", "displacement"],
        ),
        (
            "time,battery (V),supply_V,x (mm)",
            |k| format!("{k}.5,3.{k},5.{k},{}", swing(k)),
            &[
                "time",
                "its name says that it is something else",
                "its name says that it is something else",
                "displacement",
            ],
        ),
        (
            "time,gFx,gFy,gFz,TgF",
            |k| format!("{k}.5,{},{},{},1.{k}", 0.1 * swing(k), swing(k), 1.0 + 0.1 * swing(k)),
            &["time", AXIS, "acceleration", AXIS, "its name says that it is something else"],
        ),
    ];
    for (header, row, expected) in cases {
        assert_eq!(meanings(header, row), expected, "{header}");
    }
    // A sensor that stands still is one all the same, where no other is: its readings are said to be the same.
    assert_eq!(meanings("t,force,x", |k| format!("{k}.5,{},2", swing(k))), ["time", "input", "displacement"]);
}

fn import(text: &str, change: impl Fn(&mut Mapping)) -> Imported {
    let table = read(text.as_bytes(), None).unwrap();
    let (mut mapping, kind) = Mapping::guess(&table);
    change(&mut mapping);
    build(&table, &mapping, kind, Hold::First, &[]).unwrap()
}

fn imported(header: &str, cell: impl Fn(u32) -> String) -> Imported {
    let text = format!("{header}\n")
        + &(0..200).map(|k| format!("{}.{:02},{}\n", k / 100, k % 100, cell(k))).collect::<String>();
    import(&text, |_| {})
}

/// Angles run on where they wrap, in units of their kind or in counts; what jumps otherwise does not.
#[test]
fn angles_that_wrap_run_on() {
    use std::f64::consts::TAU;
    let wave = |k: u32| if (k / 20).is_multiple_of(2) { f64::from(k % 3) } else { 4092.0 + f64::from(k % 4) };
    // The range, its beginning, and the middle of the motion as a share of the range.
    for (header, range, low, middle) in [
        ("time (s),angle (deg)", 360.0, 0.0, 0.02),
        ("time (s),yaw (deg)", 360.0, -180.0, 0.49),
        ("time (s),theta (rad)", TAU, 0.0, 0.97),
        ("time (s),theta (rad)", TAU, -0.5 * TAU, -0.5),
        ("time (s),pos", 4096.0, 0.0, 1.0),
        ("time (s),encoder", 65_536.0, -32_768.0, 0.5),
        ("time (s),encoder", 4000.0, 0.0, 0.01),
    ] {
        let turned = |k: u32| range * (middle + 0.15 * swing(k));
        let Imported { record, remarks, .. } =
            imported(header, |k| format!("{:.4}", (turned(k) - low).rem_euclid(range) + low));
        let size = if header.contains("deg") { TAU / 360.0 } else { 1.0 };
        let readings = record.measured(0);
        for k in 0..200 {
            let moved = readings[k as usize] - readings[0] - size * (turned(k) - turned(0));
            assert!(moved.abs() < 1e-3 * size, "{header}, {range}: {moved} at {k}");
        }
        assert!(remarks.iter().any(|remark| remark.contains("an angle that wraps; it is unwrapped")), "{remarks:?}");
    }
    for cell in [&|k| format!("{}", wave(k)) as String, &|k: u32| format!("{}", 180.0 * swing(k)) as String]
        as [&dyn Fn(u32) -> String; 2]
    {
        let Imported { record, remarks, .. } = imported("time (s),pos", cell);
        assert_eq!(record.measured(0)[30], cell(30).parse::<f64>().unwrap());
        assert!(!remarks.iter().any(|remark| remark.contains("wraps")), "{remarks:?}");
    }
}

#[test]
fn infinities_of_instruments_are_readings_that_failed() {
    let words = ["∞", "-∞", "Inf", "-inf", "missing"];
    let cell = |k: u32| {
        words.get(k as usize / 7).filter(|_| k % 7 == 3).map_or_else(|| swing(k).to_string(), |word| (*word).to_owned())
    };
    let Imported { record, remarks, .. } = imported("time (s),x", cell);
    let failed: Vec<usize> = (0..200).filter(|k| record.measured(0)[*k].is_nan()).collect();
    assert_eq!(failed, [3, 10, 17, 24, 31]);
    assert!(remarks[1].contains("4 cell(s) of `x` have a word such as `∞`, the first in line 5"), "{remarks:?}");
}

fn sentinel(readings: &[&str]) -> Option<Sentinel> {
    let text: String = std::iter::once("x").chain(readings.iter().copied()).map(|cell| format!("{cell}\n")).collect();
    read(text.as_bytes(), None).unwrap().sentinel(0)
}

#[test]
fn several_equal_numbers_far_from_all_others_stand_out() {
    let found = sentinel(&["0.1", "-0.2", "-9999", "0.3", "-9999", "0.2"]).unwrap();
    assert_eq!(found, Sentinel { value: -9999.0, count: 2, line: 4, is_usual: true });
    let found = sentinel(&["1000.1", "0", "1000.2", "0", "1000.3", "0", "1000.4"]).unwrap();
    assert_eq!((found.value, found.count, found.is_usual), (0.0, 3, false));
    assert_eq!(sentinel(&["1e38", "2", "1", "1e38", "3"]).unwrap().line, 2);
}

#[test]
fn pulses_steps_and_clipped_readings_are_no_sentinels() {
    let steps = ["0", "0", "0", "1", "1", "1"];
    let clipped = ["0", "2", "4", "5", "5", "5", "4", "1"];
    let hammer = ["0.01", "-0.01", "0.02", "50", "0.01", "0", "-0.02"];
    let random = ["1", "-1", "-1", "1", "0", "1", "-1"];
    let counts = ["-9999", "9999", "-5000", "5000", "0", "-9999"];
    for readings in [&steps[..], &clipped, &hammer, &random, &counts, &["1", "2"], &["1", "nan"]] {
        assert_eq!(sentinel(readings), None, "{readings:?}");
    }
}

#[test]
fn numbers_and_words_for_missing_readings_are_said() {
    let text = "t,force,x\n0,1,2\n0.1,2,-9999\n0.2,1,2.5\n0.3,OVLD,1.5\n0.4,1,-9999\n";
    let Imported { record, remarks, .. } = import(text, |_| {});
    assert!(record.measured(0)[1].is_nan() && record.measured(0)[4].is_nan());
    let said = remarks.join("\n");
    assert!(said.contains("1 cell(s) of `force` have a word such as `OVLD`, the first in line 5"), "{said}");
    assert!(said.contains("2 cell(s) of `x` are -9999, the first in line 3: they count as missing"), "{said}");
    let as_they_are = import(text, |m| m.sensors.values_mut().for_each(|sensor| sensor.missing = None));
    assert_eq!(as_they_are.record.measured(0)[1], -9999.0);
    assert!(as_they_are.remarks.join("\n").contains("are they missing?"), "{:?}", as_they_are.remarks);
}

#[test]
fn readings_that_stand_still_are_known() {
    let still = import("t,force,x\n0,1,2\n0.1,2,2\n0.2,1,\n0.3,1,2\n", |_| {});
    assert_eq!(still.still, Some(Quantity::DISPLACEMENT));
    assert_eq!(import("t,force,x\n0,1,2\n0.1,2,3\n0.2,,4\n", |_| {}).still, None);
}
