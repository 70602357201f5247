//! Scenarios from documents of any format, and records from columns.

use std::sync::Arc;

use kalmanscope_core::import::{Builder, Mapping, read};
use kalmanscope_core::record::Input;
use kalmanscope_core::{
    Channel, FilterKind, Hold, InputKind, PlantKind, Quantity, Record, RecordError, Run, RunError, Scenario, document,
    simulate,
};

use crate::run::{finished, finished_on, one_filter};

fn json(toml: &str) -> String {
    document::to_json(&document::from_toml(toml).expect("it is TOML")).expect("JSON can express it")
}

fn from_json(text: &str) -> Result<Scenario, String> {
    let document = document::from_json(text).map_err(|error| error.to_string())?;
    Scenario::from_document(&document).map_err(|error| error.to_string())
}

#[test]
fn every_file_of_the_project_is_the_same_scenario_as_json() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/scenarios");
    let mut files = 0;
    for entry in std::fs::read_dir(folder).expect("there is a folder") {
        let path = entry.expect("it can be read").path();
        let text = std::fs::read_to_string(&path).expect("it can be read");
        let expected = Scenario::from_toml(&text).expect("it is a scenario");
        assert_eq!(from_json(&json(&text)).as_ref(), Ok(&expected), "{path:?}");
        let document = expected.to_document().expect("a document can express it");
        assert_eq!(Scenario::from_document(&document).as_ref(), Ok(&expected), "{path:?}");
        let written = document::to_json(&document).expect("JSON can express it");
        assert_eq!(from_json(&written).as_ref(), Ok(&expected), "{path:?}");
        files += 1;
    }
    assert!(files > 5, "{files}");
}

#[test]
fn what_a_file_may_leave_out_a_document_may_too() {
    assert_eq!(from_json("{}"), Scenario::from_toml("").map_err(|error| error.to_string()));
    let scenario = from_json(r#"{"sensors": [{"measures": "velocity", "noise_std": 1}], "filters": [{}, {}]}"#);
    let scenario = scenario.expect("it is a scenario");
    let names: Vec<(u32, &str)> = scenario.filters.iter().map(|filter| (filter.id, filter.name.as_str())).collect();
    assert_eq!(names, [(1, "EKF"), (2, "EKF 2")]);
    assert_eq!(scenario.filters[1].sensor_std, [1.0]);
}

#[test]
fn names_that_are_changed_are_told() {
    let text = json("[[filters]]\nname = \"a\"\n[[filters]]\nname = \"a\"");
    let document = document::from_json(&text).expect("it is JSON");
    let (scenario, remarks) = Scenario::from_document_with_remarks(&document).expect("it is a scenario");
    assert_eq!(scenario.filters[1].name, "a 2");
    assert_eq!(remarks, ["filter 2 is called `a 2` in place of `a`: an earlier filter has this name"]);
}

#[test]
fn an_error_has_the_path_of_its_key_and_no_line() {
    let refused = |text: &str| from_json(text).expect_err("it is no scenario");
    assert!(refused(r#"{"filters": [{}, {"knd": "ukf"}]}"#).starts_with("`filters[1].knd`: unknown field `knd`"));
    assert_eq!(refused(r#"{"dt": "soon"}"#), "`dt`: invalid type: string \"soon\", expected f64");
    assert!(refused(r#"{"dt": -1}"#).starts_with("`dt` is -1, but must be "));
    // A list of nothing would be the default.
    assert_eq!(refused("[]"), "expected a table");
}

fn input(values: &[f64]) -> Input {
    Input { kind: InputKind::Force, hold: Hold::Zero, values: values.to_vec() }
}

fn message(result: Result<Record, RecordError>) -> String {
    result.unwrap_err().to_string()
}

#[test]
fn columns_make_a_record() {
    let measured = vec![(Quantity::VELOCITY, vec![1.0, f64::NAN]), (Quantity::DISPLACEMENT, vec![0.5, 0.25])];
    let record = Record::new(0.5, input(&[2.0, 3.0]), measured).unwrap();
    let record = record.with_truth(vec![(Channel::VELOCITY, vec![0.9, 1.1])]).unwrap().starting_at(10.0);
    assert_eq!((record.dt(), record.len(), record.time(1)), (0.5, 2, 10.5));
    assert_eq!(
        (record.input(), record.sensors()),
        (&[2.0, 3.0][..], &[Quantity::VELOCITY, Quantity::DISPLACEMENT][..])
    );
    assert!(record.measured(0)[1].is_nan());
    assert_eq!(record.truth(Channel::VELOCITY), Some(&[0.9, 1.1][..]));
    assert_eq!(record.truth(Channel::DISPLACEMENT), None);
}

#[test]
fn invalid_columns_are_reported() {
    let velocity = |values: &[f64]| vec![(Quantity::VELOCITY, values.to_vec())];
    let two = || input(&[0.0, 1.0]);
    assert_eq!(message(Record::new(0.0, two(), vec![])), "dt = 0 s, but must be positive and finite");
    assert!(message(Record::new(f64::NAN, two(), vec![])).starts_with("dt = NaN"));
    assert_eq!(
        message(Record::new(0.1, input(&[0.0, f64::NAN]), vec![])),
        "sample 1, column `input`: NaN is not a finite number"
    );
    assert_eq!(
        message(Record::new(0.1, two(), velocity(&[0.0]))),
        "column `velocity` has 1 values, but the input has 2"
    );
    let infinite = message(Record::new(0.1, two(), velocity(&[f64::INFINITY, 0.0])));
    assert_eq!(infinite, "sample 0, column `velocity`: inf is not a number or NaN");
    let twice = [velocity(&[0.0, 1.0]), velocity(&[0.0, 1.0])].concat();
    assert_eq!(message(Record::new(0.1, two(), twice)), "there are two columns `velocity`");
    let record = Record::new(0.1, two(), velocity(&[0.0, 1.0])).unwrap();
    let truth = message(record.with_truth(vec![(Channel::VELOCITY, vec![0.0; 3])]));
    assert_eq!(truth, "column `true_velocity` has 3 values, but the input has 2");
}

#[test]
fn a_record_is_run_with_the_scenarios_hold_and_only_with_its_input() {
    let mut scenario = Scenario { duration: 2.0, ..one_filter(FilterKind::EKF) };
    let run = finished(&scenario);
    let record = Arc::new(run.record().clone());
    let again = finished_on(&scenario, Arc::clone(&record));
    assert_eq!(again.checksum(), run.checksum());
    scenario.input = InputKind::GroundAcceleration;
    let error = Run::on_record(&scenario, record).err();
    let expected = RunError::InputKind { record: InputKind::Force, scenario: InputKind::GroundAcceleration };
    assert_eq!(error, Some(expected));
}

#[test]
fn a_record_is_simulated_and_changed_without_a_run() {
    let scenario = Scenario { duration: 1.0, ..Scenario::default() };
    let run = finished(&scenario);
    let record = simulate(&scenario);
    assert_eq!(&record, run.record());
    let measured = record.clone().without_truth();
    assert!(Channel::all().iter().all(|&channel| measured.truth(channel).is_none()));
    assert_eq!((measured.input(), measured.measured(1)), (record.input(), record.measured(1)));
    let gaps = record.clone().with_gaps(|sensor, k| sensor == 1 && k == 7);
    let missing = |sensor: usize| gaps.measured(sensor).iter().filter(|value| value.is_nan()).count();
    assert!([missing(0), missing(1)] == [0, 1] && gaps.measured(1)[7].is_nan());
    let changed =
        record.clone().with_measured(|sensor, k, value| if (sensor, k) == (0, 3) { 2.0 * value } else { value });
    assert_eq!(changed.measured(0)[3], 2.0 * record.measured(0)[3]);
    assert_eq!((changed.measured(0)[4], changed.measured(1)), (record.measured(0)[4], record.measured(1)));
}

/// Its file is the record of every plant under every input, with each sensor alone and with all: its columns mean what they are called.
#[test]
fn a_file_of_a_simulated_record_is_that_record() {
    let mut count = 0;
    for kind in PlantKind::ALL {
        for input in [InputKind::Force, InputKind::GroundAcceleration] {
            for hold in [Hold::Zero, Hold::First] {
                let all: Vec<Quantity> = kind.quantities().collect();
                for sensors in all.iter().map(std::slice::from_ref).chain([&all[..]]) {
                    let mut scenario = Scenario { dt: 0.03, duration: 0.9, input, hold, ..Scenario::default() };
                    scenario.set_plant(kind);
                    scenario.set_sensors(sensors);
                    let record = simulate(&scenario).with_gaps(|sensor, k| (sensor + k) % 7 == 3);
                    let mut file = Vec::new();
                    record.write_csv(&mut file).unwrap();
                    let table = read(file, None).unwrap();
                    for (mapping, of, _) in [Mapping::guess_for(&table, sensors), Mapping::guess_for(&table, &[])] {
                        let again = Builder::new(&table, &mapping, of, hold).unwrap().finish().unwrap().record;
                        assert_eq!(bits(&again), bits(&record), "{kind:?} {input:?} {sensors:?}");
                    }
                    count += 1;
                }
            }
        }
    }
    assert!(count > 500, "{count}");
}

/// All of a record, without a number that is not equal to itself.
type Bits = (f64, f64, InputKind, Hold, Vec<(String, Vec<u64>)>);

fn bits(record: &Record) -> Bits {
    let of = |values: &[f64]| {
        values.iter().map(|value| if value.is_nan() { 0 } else { 1 + value.to_bits() }).collect::<Vec<u64>>()
    };
    let sensors = record.sensors().iter().enumerate().map(|(i, sensor)| (sensor.name(), of(record.measured(i))));
    let truth = Channel::all().iter().filter_map(|c| Some((format!("true {}", c.key()), of(record.truth(*c)?))));
    let mut columns: Vec<_> = sensors.chain(truth).collect();
    columns.sort();
    columns.push(("input".to_owned(), of(record.input())));
    (record.dt(), record.time(0), record.input_kind(), record.hold(), columns)
}

#[test]
fn an_accelerometer_on_the_ground_is_what_the_scenario_calls_it() {
    let of = |text: &str, sensors: &[Quantity]| {
        let mapping = Mapping::guess_for(&read(text.as_bytes(), None).unwrap(), sensors).0;
        mapping.sensors.into_keys().collect::<Vec<_>>()
    };
    let (relative, total) = (Quantity::ACCELERATION, Quantity::TOTAL_ACCELERATION);
    let felt = "time,ground (g),roof acc (g)\n0,0.1,1\n1,0.2,1\n2,0.1,2\n";
    assert_eq!([of(felt, &[]), of(felt, &[total])], [vec![total], vec![total]], "an accelerometer feels the ground");
    assert_eq!(of(felt, &[relative]), [relative]);
    let other = "time,ground_acceleration,acceleration\n0,0.1,1\n1,0.2,1\n2,0.1,2\n";
    assert_eq!([of(other, &[]), of(other, &[relative])], [vec![total], vec![relative]]);
    let own = "t,ground_acceleration,acceleration\n0,0.1,1\n1,0.2,1\n2,0.1,2\n";
    assert_eq!([of(own, &[]), of(own, &[Quantity::DISPLACEMENT])], [vec![relative], vec![relative]]);
}
