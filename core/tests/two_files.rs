//! Two files with clocks of their own are one record.

use std::fmt::Write as _;

use kalmanscope_core::import::{Builder, Mapping, Table, join, read};
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
