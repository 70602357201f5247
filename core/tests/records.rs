//! Records from columns.

use std::sync::Arc;

use kalmanscope_core::record::Input;
use kalmanscope_core::simulate;
use kalmanscope_core::{Channel, Hold, InputKind, Quantity, Record, RecordError, Run, RunError, Scenario};

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
    let mut scenario = Scenario { duration: 2.0, ..Scenario::default() };
    scenario.filters.truncate(1);
    let mut run = Run::new(&scenario).unwrap();
    run.finish();
    let record = Arc::new(run.record().clone());
    let mut again = Run::on_record(&scenario, Arc::clone(&record)).unwrap();
    again.finish();
    assert_eq!(again.checksum(), run.checksum());
    scenario.input = InputKind::GroundAcceleration;
    let error = Run::on_record(&scenario, record).err();
    let expected = RunError::InputKind { record: InputKind::Force, scenario: InputKind::GroundAcceleration };
    assert_eq!(error, Some(expected));
}

#[test]
fn a_record_is_simulated_and_changed_without_a_run() {
    let scenario = Scenario { duration: 1.0, ..Scenario::default() };
    let mut run = Run::new(&scenario).unwrap();
    run.finish();
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
