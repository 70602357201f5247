//! Inputs that are recorded late or early: filters that know, filters that do not, and the cause that is named.

use std::sync::Arc;

use kalmanscope_core::diagnosis::Remedy;
use kalmanscope_core::record::Input;
use kalmanscope_core::simulate;
use kalmanscope_core::{Channel, Diagnosis, Diagnostics, Estimates, FilterKind, Quantity, Record, Run, Scenario};

const DELAYS: [i32; 7] = [-3, -2, -1, 0, 1, 2, 3];

/// The default oscillator without a change, under white noise, with an EKF; the plant feels the input so many samples late.
fn scenario(delay: i32, seed: u64) -> Scenario {
    let mut scenario = Scenario { seed, duration: 20.0, ..Scenario::default() };
    scenario.plant.set(Channel::NATURAL_FREQUENCY, 6.0);
    scenario.plant.input_delay = delay;
    scenario.filters.truncate(1);
    (scenario.filters[0].kind, scenario.filters[0].fading) = (FilterKind::EKF, 1.0);
    scenario
}

fn columns(record: &Record) -> Vec<(Quantity, Vec<f64>)> {
    record.sensors().iter().enumerate().map(|(i, &sensor)| (sensor, record.measured(i).to_vec())).collect()
}

fn rebuilt(record: &Record, input: Vec<f64>, measured: Vec<(Quantity, Vec<f64>)>) -> Record {
    let input = Input { kind: record.input_kind(), hold: record.hold(), values: input };
    Record::new(record.dt(), input, measured).unwrap()
}

/// The same record with every third measurement missing, and all of them for a while.
fn with_holes(record: &Record) -> Record {
    record.clone().without_truth().with_gaps(|place, k| (k + place).is_multiple_of(3) || (300..360).contains(&k))
}

fn estimates(scenario: &Scenario, record: &Record) -> Estimates {
    let mut run = Run::on_record(scenario, Arc::new(record.clone())).unwrap();
    run.finish();
    run.estimates()[0].clone()
}

fn remedies(scenario: &Scenario, record: &Record) -> Vec<Remedy> {
    let estimates = estimates(scenario, record);
    let diagnostics = Diagnostics::new(&estimates, record);
    let diagnosis = Diagnosis::new(&diagnostics, &estimates, record, None).unwrap();
    let mut trials = diagnosis.trials(scenario, 0, &diagnostics, &estimates, record).unwrap();
    while !trials.advance(&mut || true) {}
    trials.remedies()
}

#[test]
fn a_filter_that_knows_the_delay_is_one_on_an_input_that_is_moved() {
    for delay in DELAYS {
        let mut scenario = scenario(delay, 7);
        let late = with_holes(&simulate(&scenario));
        scenario.filters[0].input_delay = delay;
        let known = estimates(&scenario, &late);
        scenario.filters[0].input_delay = 0;
        // Before the first sample and after the last one, the input is what it is there.
        let last = late.len() as i32 - 1;
        let moved = (0..=last).map(|k| late.input()[(k - delay).clamp(0, last) as usize]);
        let moved = rebuilt(&late, moved.collect(), columns(&late));
        let expected = estimates(&scenario, &moved);
        for k in 0..late.len() {
            assert_eq!(known.mean(k), expected.mean(k), "delay {delay}, sample {k}");
        }
    }
}

#[test]
fn a_delay_is_named_with_its_sign_and_its_number_also_with_gaps() {
    for delay in DELAYS {
        for seed in 1_000_000..1_000_003 {
            let scenario = scenario(delay, seed);
            let whole = simulate(&scenario);
            for record in [with_holes(&whole), whole] {
                let found = remedies(&scenario, &record);
                let named = found.iter().position(|remedy| remedy.first.cause.key == "input_delay");
                if delay == 0 {
                    assert_eq!(named, None, "seed {seed}: {:?}", found[0].first.sentence);
                    continue;
                }
                let place = named.unwrap_or_else(|| panic!("delay {delay}, seed {seed}: {found:?}"));
                assert!(place < 2, "delay {delay}, seed {seed}: place {place}");
                let likely = &found[place].first;
                assert_eq!(likely.edits[0].toml_line(), format!("input_delay = {delay}"), "seed {seed}");
                let word = if delay > 0 { "early" } else { "late" };
                assert!(likely.sentence.ends_with(word), "delay {delay}: {}", likely.sentence);
            }
        }
    }
}
