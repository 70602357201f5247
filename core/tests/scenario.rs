//! Scenario files: valid contents, and the messages for invalid ones; scenarios from documents of any format, and records from columns.

use kalmanscope_core::import::{Mapping, build, read};
use kalmanscope_core::record::Input;
use kalmanscope_core::signal::Step;
use kalmanscope_core::{
    Channel, FilterKind, FilterSettings, Force, Hold, InputKind, Quantity, Record, RecordError, Scenario,
    ScenarioError, Sensor, Signal, Values, document, simulate,
};

use crate::run::{assets, finished, oscillator, plants};

fn parsed(text: &str) -> Scenario {
    Scenario::from_toml(text).unwrap_or_else(|error| panic!("{text}\n{error}"))
}

fn assert_refused(section: &str, other: impl Fn(&str, &str) -> bool) {
    let table = include_str!("refused.txt").split("## ").find(|part| part.starts_with(section)).unwrap();
    for line in table.lines().skip(1) {
        let (text, expected) = line.split_once(" => ").unwrap();
        let text = text.replace("\\n", "\n");
        if other(&text, expected) {
            continue;
        }
        let error = Scenario::from_toml(&text).expect_err(&text).to_string();
        // Lists of channels end with those of equations that other tests type.
        let mut rest = Some(error.as_str());
        for (place, part) in expected.split('…').enumerate() {
            let found =
                rest.and_then(|rest| rest.split_once(part).filter(|(before, _)| place > 0 || before.is_empty()));
            rest = found.map(|(_, after)| after);
        }
        assert!(rest.is_some_and(|rest| rest.is_empty() || expected.ends_with('…')), "{text}: {error}");
    }
}

const SAMPLE: &str = include_str!("sample.toml");

#[test]
fn the_sample_has_the_expected_settings() {
    let channels = [Channel::DISPLACEMENT, Channel::VELOCITY, Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO];
    let with = |values: [f64; 4], rest: Values| rest.with(channels.into_iter().zip(values));
    let expected = Scenario {
        seed: 1,
        dt: 0.01,
        duration: 60.0,
        plant: oscillator(Signal::Step(Step { from: 6.0, to: 4.8, at: 30.0 }), 0.05),
        force: Force::WhiteNoise { std: 10.0 },
        sensors: vec![Sensor::new(Quantity::DISPLACEMENT, 0.01), Sensor::new(Quantity::VELOCITY, 0.06)],
        filters: vec![FilterSettings {
            id: 1,
            name: "EKF with fading memory".to_owned(),
            kind: FilterKind::EKF,
            fading: 1.005,
            sensor_std: vec![0.01, 0.06],
            initial_mean: with([0.0, 0.0, 8.0, 0.1], Values::INITIAL_MEAN),
            initial_std: with([0.1, 0.3, 2.0, 0.1], Values::INITIAL_STD),
            process_std: with([1e-4, 1e-3, 1e-4, 3e-5], Values::PROCESS_STD),
            ..FilterSettings::default()
        }],
        ..Scenario::default()
    };
    assert_eq!(parsed(SAMPLE), expected);
    assert_eq!(expected.samples(), 6001);
}

#[test]
fn an_empty_file_is_the_default_and_ids_are_written_where_places_do_not_give_them() {
    let mut scenario = parsed("");
    assert_eq!((&scenario, scenario.validate()), (&Scenario::default(), Ok(())));
    assert!(scenario.filters.iter().map(|filter| filter.name.as_str()).eq(["EKF", "UKF"]));
    assert!(!scenario.to_toml().unwrap().contains("id = "));
    scenario.filters.remove(0);
    let text = scenario.to_toml().unwrap();
    assert!(text.contains("id = 2"), "{text}");
    assert_eq!(parsed(&text), scenario);
}

#[test]
fn missing_settings_are_filled_in() {
    let scenario = parsed(
        "[[sensors]]\nmeasures = \"velocity\"\nnoise_std = 0.2\n[[sensors]]\nmeasures = \"displacement\"\n\
         noise_std = 0\n[[filters]]\nkind = \"ukf\"\ninitial_std = { velocity = 9 }\n[[filters]]\nname = \"a\"\n",
    );
    let [ukf, second] = scenario.filters.as_slice() else { panic!("two filters") };
    assert_eq!((ukf.name.as_str(), second.name.as_str()), ("UKF", "a"));
    assert_eq!((ukf.id, second.id, ukf.fading, second.fading), (1, 2, 1.0, 1.0));
    assert_eq!(ukf.initial_std, Values::INITIAL_STD.with([(Channel::VELOCITY, 9.0)]));
    assert_eq!(second.initial_std, Values::INITIAL_STD);
    assert_eq!(ukf.sensor_std[0], 0.2);
    assert!(ukf.sensor_std[1] > 0.0, "a filter cannot believe in a perfect sensor");
    assert!(parsed("sensors = []\nfilters = []").filters.is_empty());
    let other_sensors = parsed("[[sensors]]\nmeasures = \"acceleration\"\nnoise_std = 0.5");
    assert!(other_sensors.filters.iter().all(|f| f.sensor_std == [0.5] && f.fading == 1.005));
}

/// `docs.rs` holds their keys to a table, and `invariants.rs` what is written to what is read.
#[test]
fn signals_and_forces_may_have_whole_numbers_and_tables_of_their_own() {
    let step = Signal::Step(Step { from: 6.0, to: 4.8, at: 30.0 });
    for (text, expected) in [
        ("[plant]\nnatural_frequency = 6", Signal::Constant(6.0)),
        ("[plant]\nnatural_frequency = { step = { from = 6, to = 4.8, at = 30 } }", step),
        ("[plant.natural_frequency.step]\nfrom = 6\nto = 4.8\nat = 30", step),
    ] {
        assert_eq!(parsed(text).plant.parameter(Channel::NATURAL_FREQUENCY), Some(expected), "{text}");
    }
    assert_eq!(parsed("force = \"none\"").force, Force::None);
    assert_eq!(parsed("[force]\nwhite_noise = { std = 3 }").force, Force::WhiteNoise { std: 3.0 });
}

#[test]
fn impossible_values_are_refused_with_key_value_and_limits() {
    assert_refused("values", |text, expected| {
        let is_finite = !expected.contains(" is NaN, ") && !expected.contains(" is inf, ");
        if is_finite {
            assert!(matches!(Scenario::from_toml(text), Err(ScenarioError::Value { .. })), "{text}");
            return false;
        }
        // The reader of files has no such number; programs may set one.
        let error = Scenario::from_toml(text).unwrap_err().to_string();
        assert!(error.starts_with("line ") && error.ends_with(": must be a finite number"), "{error}");
        let mut scenario: Scenario = toml::from_str(text).unwrap();
        scenario.filters.iter_mut().for_each(|filter| filter.sensor_std = vec![1.0; 2]);
        assert_eq!(scenario.validate().unwrap_err().to_string(), expected);
        true
    });
    let many = Scenario::from_toml(&"[[filters]]\n".repeat(17)).unwrap_err().to_string();
    assert_eq!(many, "`filters` is a list of 17, but must be at most 16");
    assert_eq!(parsed(&"[[filters]]\n".repeat(16)).filters.len(), 16);
}

#[test]
fn invalid_toml_is_shown_with_its_place() {
    for text in ["dt = ", "seed = 1\nseed = 2", "[plant", "\u{0}", "dt = 0.01.2"] {
        let error = Scenario::from_toml(text).unwrap_err();
        assert!(matches!(error, ScenarioError::Syntax(_)), "{text}");
        assert!(error.to_string().starts_with("TOML parse error at line "), "{error}");
    }
}

#[test]
fn a_seed_that_toml_cannot_hold_is_refused() {
    let scenario = Scenario { seed: u64::MAX, ..Scenario::default() };
    let message = scenario.validate().unwrap_err().to_string();
    assert_eq!(message, "`seed` is 18446744073709551615, but must be a whole number from 0 to 2⁶³ - 1");
    for seed in ["9223372036854775808", "99999999999999999999"] {
        let error = Scenario::from_toml(&format!("seed = {seed}")).unwrap_err().to_string();
        assert!(error.starts_with("TOML parse error at line 1, column 8"), "{error}");
    }
    let largest = Scenario { seed: i64::MAX as u64, ..Scenario::default() };
    assert_eq!(parsed(&largest.to_toml().unwrap()), largest);
}

#[test]
fn unknown_keys_wrong_types_and_options_that_do_not_go_together_are_refused_with_line_path_and_what_there_is() {
    ["keys", "types", "options"].into_iter().for_each(|section| assert_refused(section, |_, _| false));
    // `docs.rs` holds all keys to their table.
    let error = |text: &str| Scenario::from_toml(text).unwrap_err().to_string();
    let unknown = error("[[filters]]\n[[filters]]\nlambda = 1");
    let said = "line 3: `filters[1].lambda`: unknown field `lambda`, expected one of `id`, ";
    assert!(unknown.starts_with(said), "{unknown}");
    let kinds = FilterKind::ALL.map(|kind| format!("`{}`", kind.key())).join(", ");
    let said = format!("line 2: `filters[0].kind`: unknown variant `lqr`, expected one of {kinds}");
    assert_eq!(error("[[filters]]\nkind = \"lqr\""), said);
}

fn json(toml: &str) -> String {
    document::to_json(&document::from_toml(toml).expect("it is TOML")).expect("JSON can express it")
}

fn from_json(text: &str) -> Result<Scenario, String> {
    let document = document::from_json(text).map_err(|error| error.to_string())?;
    Scenario::from_document(&document).map_err(|error| error.to_string())
}

#[test]
fn every_file_of_the_project_is_the_same_scenario_as_json() {
    let files = assets("scenarios");
    for (name, text) in &files {
        let expected = Scenario::from_toml(text).expect("it is a scenario");
        assert_eq!(from_json(&json(text)).as_ref(), Ok(&expected), "{name}");
        let written = expected.to_toml().expect("TOML can express it");
        assert_eq!(from_json(&json(&written)).as_ref(), Ok(&expected), "{name}");
    }
    assert!(files.len() > 5, "{}", files.len());
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
    assert_eq!(record.input(), [2.0, 3.0]);
    assert_eq!(record.sensors(), [Quantity::VELOCITY, Quantity::DISPLACEMENT]);
    assert!(record.measured(0)[1].is_nan());
    assert_eq!(record.truth(Channel::VELOCITY), Some(&[0.9, 1.1][..]));
    assert_eq!(record.truth(Channel::DISPLACEMENT), None);
}

#[test]
fn invalid_columns_are_reported() {
    let velocity = |values: &[f64]| vec![(Quantity::VELOCITY, values.to_vec())];
    let two = [0.0, 1.0];
    let twice = [velocity(&two), velocity(&two)].concat();
    for (dt, values, columns, said) in [
        (0.0, two, vec![], "dt = 0 s, but must be positive and finite"),
        (f64::NAN, two, vec![], "dt = NaN s, but must be positive and finite"),
        (0.1, [0.0, f64::NAN], vec![], "sample 1, column `input`: NaN is not a finite number"),
        (0.1, two, velocity(&[0.0]), "column `velocity` has 1 values, but the input has 2"),
        (0.1, two, velocity(&[f64::INFINITY, 0.0]), "sample 0, column `velocity`: inf is not a number or NaN"),
        (0.1, two, twice, "there are two columns `velocity`"),
    ] {
        assert_eq!(message(Record::new(dt, input(&values), columns)), said);
    }
    let record = Record::new(0.1, input(&two), velocity(&two)).unwrap();
    let truth = message(record.with_truth(vec![(Channel::VELOCITY, vec![0.0; 3])]));
    assert_eq!(truth, "column `true_velocity` has 3 values, but the input has 2");
}

#[test]
fn a_record_is_simulated_and_changed_without_a_run() {
    let scenario = Scenario { duration: 1.0, ..Scenario::default() };
    let run = finished(&scenario);
    let record = simulate(&scenario);
    assert_eq!(&record, run.record());
    let measured = record.clone().without_truth();
    assert!(measured.true_channels().is_empty());
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
    for kind in plants() {
        for input in [InputKind::Force, InputKind::GroundAcceleration] {
            for hold in [Hold::Zero, Hold::First] {
                let all: Vec<Quantity> = kind.quantities().collect();
                for sensors in all.iter().map(std::slice::from_ref).chain([&all[..]]) {
                    let mut scenario = Scenario { dt: 0.03, duration: 0.9, input, hold, ..Scenario::default() };
                    scenario.set_plant(kind.clone());
                    scenario.set_sensors(sensors);
                    let record = simulate(&scenario).with_gaps(|sensor, k| (sensor + k) % 7 == 3);
                    let mut file = Vec::new();
                    record.write_csv(&mut file).unwrap();
                    let table = read(file, None).unwrap();
                    for (mapping, of, _) in [Mapping::guess_for(&table, sensors), Mapping::guess_for(&table, &[])] {
                        let again = build(&table, &mapping, of, hold, &[]).unwrap().record;
                        assert_eq!(written(&again), written(&record), "{kind:?} {input:?} {sensors:?}");
                    }
                    count += 1;
                }
            }
        }
    }
    assert!(count > 500, "{count}");
}

/// All of a record, whatever the order of its sensors; NaN is equal to itself here.
fn written(record: &Record) -> String {
    let mut columns: Vec<_> = record.sensors().iter().map(|of| (of.name(), record.measured_quantity(*of))).collect();
    columns.extend(record.true_channels().into_iter().map(|of| (format!("true {}", of.key()), record.truth(of))));
    columns.sort_by(|a, b| a.0.cmp(&b.0));
    let (kind, hold) = (record.input_kind(), record.hold());
    format!("{:?} {:?} {kind:?} {hold:?} {:?} {columns:?}", record.dt(), record.time(0), record.input())
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
