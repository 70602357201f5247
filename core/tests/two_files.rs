//! Two files with clocks of their own: their offset is found, and together they are one record.

use std::fmt::Write as _;

use kalmanscope_core::import::{Builder, ClockOffset, Clocked, ImportError, Mapping, Table, join, read};
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{Channel, Force, Hold, Quantity, Record, Run, Scenario, Sensor, Source, simulate};

/// The truth, 500 samples a second, with an input that is linear between samples. What changes within a step of a file cannot be
/// in it, so a file of few samples has a slow input.
const SLOW: Force = Force::Chirp { amplitude: 3.0, from: 1.0, to: 25.0, sweep: 60.0 };

fn truth(frequency: f64, damping: f64, seed: u64, force: Force, sensors: &[Quantity]) -> Record {
    let mut scenario = Scenario { seed, dt: 0.002, duration: 60.0, hold: Hold::First, force, ..Scenario::default() };
    scenario.plant.set(Channel::NATURAL_FREQUENCY, frequency);
    scenario.plant.set(Channel::DAMPING_RATIO, damping);
    scenario.sensors.clear();
    for &quantity in sensors {
        let std = if quantity == Quantity::ACCELERATION { 0.05 } else { 0.002 };
        scenario.add_sensor(Sensor::new(quantity, std));
    }
    simulate(&scenario)
}

/// Random numbers from -1/2 to 1/2.
fn noise(k: usize) -> f64 {
    let mut x = (k as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
}

/// A file of some values of a record: one of `every` samples from a time on, with jitter of that share of a step, and a clock
/// that is ahead.
fn file(
    record: &Record,
    values: &[f64],
    name: &str,
    (every, from, to, jitter, ahead): (usize, f64, f64, f64, f64),
) -> Table {
    let mut text = format!("t [s],{name}\n");
    let dt = record.dt();
    let mut k = (from / dt) as usize;
    while k < values.len() && k as f64 * dt <= to {
        let moved = (k as f64 + jitter * every as f64 * noise(k)).max(0.0) as usize;
        let at = moved.min(values.len() - 1);
        writeln!(text, "{:.6},{}", at as f64 * dt + ahead, values[at]).expect("a text takes it");
        k += every;
    }
    read(text.into_bytes(), None).expect("it is a table")
}

#[test]
fn the_offset_between_input_and_sensor_is_found() {
    for (place, (frequency, damping, offset)) in
        [(6.0, 0.05, 1.237), (9.0, 0.02, -3.3), (4.0, 0.1, 12.0), (12.0, 0.03, 0.0), (7.3, 0.01, 1000.25)]
            .into_iter()
            .enumerate()
    {
        for quantity in [Quantity::DISPLACEMENT, Quantity::VELOCITY, Quantity::ACCELERATION] {
            let force = if place % 2 == 0 { SLOW } else { Force::default() };
            let record = truth(frequency, damping, 11 + place as u64, force, &[quantity]);
            let every = if place % 2 == 0 { 4 } else { 1 };
            let input = file(&record, record.input(), "force", (every, 0.0, 60.0, 0.0, 0.0));
            let sensor = file(&record, record.measured(0), "reading", (5, 3.0, 58.0, 0.5, -offset));
            let of_input = Clocked { table: &input, column: "force", measures: None };
            let of_sensor = Clocked { table: &sensor, column: "reading", measures: Some(quantity) };
            let name = format!("{frequency} {damping} {offset} {quantity:?}");
            let found = ClockOffset::between(of_input, of_sensor).expect(&name);
            assert!((found.seconds - offset).abs() < 0.015, "{name}: {found:?}");
            assert!(!found.is_turned, "{name}: {found:?}");
            let other = ClockOffset::between(of_sensor, of_input).expect(&name);
            assert!((other.seconds + offset).abs() < 0.015, "{name}: {other:?}");
        }
    }
}

#[test]
fn the_offset_between_two_sensors_is_found_and_a_turned_one_is_noticed() {
    let all = [Quantity::DISPLACEMENT, Quantity::VELOCITY, Quantity::ACCELERATION];
    for (frequency, offset) in [(6.0, 0.731), (11.0, -7.7)] {
        let record = truth(frequency, 0.03, 5, SLOW, &all);
        for a in 0..3 {
            for b in 0..3 {
                let turned: Vec<f64> = record.measured(b).iter().map(|value| -value).collect();
                let first = file(&record, record.measured(a), "a", (5, 0.0, 60.0, 0.0, 0.0));
                let second = file(&record, &turned, "b", (7, 2.0, 55.0, 0.4, -offset));
                let of = |table, column, place: usize| Clocked { table, column, measures: Some(all[place]) };
                let found = ClockOffset::between(of(&first, "a", a), of(&second, "b", b)).expect("it is found");
                let name = format!("{frequency} {offset} {:?} {:?} {found:?}", all[a], all[b]);
                assert!((found.seconds - offset).abs() < 0.006 && found.is_turned, "{name}");
            }
        }
    }
}

#[test]
fn noise_alone_tells_no_offset() {
    let record = truth(6.0, 0.05, 3, SLOW, &[Quantity::DISPLACEMENT]);
    let other = truth(6.5, 0.05, 4, SLOW, &[Quantity::DISPLACEMENT]);
    let hiss: Vec<f64> = (0..record.len()).map(noise).collect();
    let input = file(&record, &hiss, "force", (2, 0.0, 60.0, 0.0, 0.0));
    let sensor = file(&other, other.measured(0), "reading", (5, 0.0, 60.0, 0.0, 0.0));
    let found = ClockOffset::between(
        Clocked { table: &input, column: "force", measures: None },
        Clocked { table: &sensor, column: "reading", measures: Some(Quantity::DISPLACEMENT) },
    );
    assert!(matches!(found, Err(ImportError::NoOffset { .. })), "{found:?}");
}

#[test]
fn both_files_are_one_record_that_identifies_the_oscillator() {
    for (every, jitter) in [([2, 7], 0.0), ([5, 3], 0.4), ([4, 25], 0.6)] {
        let record = truth(6.0, 0.05, 21, SLOW, &[Quantity::DISPLACEMENT]);
        let input = file(&record, record.input(), "force", (every[0], 0.0, 60.0, 0.0, 0.0));
        let sensor = file(&record, record.measured(0), "x [m]", (every[1], 4.0, 50.0, jitter, 100.0));
        let both = join(&input, &sensor, -100.0).expect("they overlap");
        assert_eq!(both.columns.len(), 4, "each has its column of times");
        assert!(both.remarks.iter().any(|remark| remark.contains("s in common")), "{:?}", both.remarks);
        let readings = both.columns[3].values.iter().filter(|value| value.is_finite()).count();
        assert!(readings as f64 > 0.97 * 46.0 / (0.002 * every[1] as f64), "no reading is lost: {readings}");
        let (mapping, kind) = Mapping::guess(&both);
        let imported = Builder::new(&both, &mapping, kind, Hold::First).and_then(Builder::finish).expect("a record");
        let scenario = suggest(&scenario_for(&imported.record), &imported.record).scenario;
        let mut run = Run::from_source(&scenario, Source::Measured(imported.record.into())).expect("it can be run");
        run.finish();
        let estimates = &run.estimates()[0];
        let last = estimates.len() - 1;
        for (channel, value) in [(Channel::NATURAL_FREQUENCY, 6.0), (Channel::DAMPING_RATIO, 0.05)] {
            let at = estimates.place(channel).expect("it is estimated");
            let (mean, band) = (estimates.mean(last)[at], 2.0 * estimates.std(last, at));
            assert!((mean - value).abs() < 1.6 * band, "{every:?}: {channel:?} {mean} ± {band}");
            assert!((mean / value - 1.0).abs() < 0.05, "{every:?}: {channel:?} {mean} ± {band}");
        }
    }
}

#[test]
fn files_without_common_time_say_so() {
    let record = truth(6.0, 0.05, 2, SLOW, &[Quantity::DISPLACEMENT]);
    let input = file(&record, record.input(), "force", (2, 0.0, 10.0, 0.0, 0.0));
    let sensor = file(&record, record.measured(0), "x [m]", (2, 20.0, 30.0, 0.0, 0.0));
    let apart = join(&input, &sensor, 0.0).expect_err("they do not overlap").to_string();
    assert!(apart.contains("one file is from 0 to 10 s, the other from 20 to 30 s"), "{apart}");
    assert!(join(&input, &sensor, -15.0).is_ok());
    let without = read(b"force,x\n1,2\n3,4\n5,6\n".to_vec(), None).expect("it is a table");
    assert!(join(&without, &sensor, 0.0).expect_err("it has no times").to_string().contains("times"));
}
