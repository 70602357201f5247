//! Files whose times are kept, two files with clocks of their own that are one record, and what LibreOffice writes.

use std::fmt::Write as _;

use kalmanscope_core::import::{Builder, Decimal, Delimiter, Encoding, Imported, Mapping, Table, join, read};
use kalmanscope_core::record::{Record, Timed};
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{Channel, FilterKind, Force, Hold, InputKind, Quantity, Scenario, Sensor, simulate};

use crate::clocks::{record, run, scenario, told};
use crate::identified::identified;
use crate::random::Random;
use crate::run::last;

/// A file of a slow chirp and a displacement at these times, in steps of a millisecond: a line between two told values is nearly the
/// force.
fn text(seed: u64, wanted: &[usize]) -> String {
    let force = Force::Chirp { amplitude: 3.0, from: 1.0, to: 4.0, sweep: 30.0 };
    let mut scenario = Scenario { dt: 1e-3, duration: 60.0, hold: Hold::First, force, seed, ..Scenario::default() };
    scenario.plant.set(Channel::NATURAL_FREQUENCY, 6.0);
    scenario.plant.set(Channel::DAMPING_RATIO, 0.05);
    scenario.sensors.truncate(1);
    let record = kalmanscope_core::simulate(&scenario);
    let row = |k: &usize| format!("{:.3},{},{}\n", *k as f64 * 1e-3, record.input()[*k], record.measured(0)[*k]);
    "t [s],force,displacement\n".to_owned() + &wanted.iter().map(row).collect::<String>()
}

fn import(text: &str, even: bool) -> Imported {
    let table = read(text.as_bytes().to_vec(), None).expect("it is a table");
    let (mut mapping, kind) = Mapping::guess(&table);
    mapping.time.even = even;
    Builder::new(&table, &mapping, kind, Hold::First).and_then(Builder::finish).expect("it is a record")
}

/// How far the last estimate of ωₙ and ζ is from the truth, in its standard deviations, after a run from their start values.
fn errors(record: &Record) -> [f64; 2] {
    let scenario = suggest(&scenario_for(record), record).scenario;
    let run = run(&scenario, record.clone());
    [(Channel::NATURAL_FREQUENCY, 6.0), (Channel::DAMPING_RATIO, 0.05)].map(|(channel, truth)| {
        let (mean, std) = last(&run.estimates()[0], channel);
        (mean - truth) / std
    })
}

/// Times that come as they like are those of the readings, and identify the oscillator within the bands.
#[test]
fn irregular_times_are_kept() {
    let mut random = Random::new(11);
    let (mut within, mut all) = (0, 0);
    for seed in 0..10 {
        let mut wanted = vec![0_usize];
        while wanted[wanted.len() - 1] < 59_800 {
            let wait = -40.0 * (1.0 - random.uniform()).ln();
            wanted.push(wanted[wanted.len() - 1] + (wait as usize).clamp(1, 99));
        }
        let Imported { record, remarks, .. } = import(&text(seed, &wanted), false);
        assert!(remarks[0].starts_with("the times are irregular: the filters take each reading"), "{remarks:?}");
        let clocks = record.clocks().expect("it has times");
        let kept = wanted.iter().filter(|k| {
            let step = (**k as f64 * 1e-3 - record.time(0)) / record.dt();
            step > -1.0 && step <= (record.len() - 1) as f64
        });
        assert_eq!(clocks.readings[0].times.len(), kept.count(), "no reading is lost");
        let errors = errors(&record);
        within += errors.iter().filter(|error| error.abs() <= 2.0).count();
        all += errors.len();
        assert!(errors.iter().all(|error| error.abs() < 5.0), "seed {seed}: {errors:?}");
    }
    assert!(within * 10 >= all * 8, "{within} of {all} in the bands");
}

/// Jitter of less than half a step leaves each reading alone in its step.
#[test]
fn jitter_leaves_a_reading_in_each_step() {
    let mut random = Random::new(5);
    let wanted: Vec<usize> =
        (0..1500).map(|k| (40.0 * (f64::from(k) + 0.8 * (random.uniform() - 0.5))).max(0.0) as usize).collect();
    let text = text(3, &wanted);
    let record = import(&text, false).record;
    let there = record.measured(0).iter().filter(|value| !value.is_nan()).count();
    assert!(there >= record.len() - 2 && record.len() >= 1498, "{there} of {}", record.len());
    let found = errors(&record);
    assert!(found.iter().all(|error| error.abs() < 4.0), "{found:?}");
    let even = import(&text, true);
    assert!(even.record.clocks().is_none() && even.remarks[0].contains("even steps"), "{:?}", even.remarks);
}

/// What is written is read with the same times.
#[test]
fn a_file_of_a_record_keeps_its_times() {
    let base = scenario(FilterKind::KF, 3);
    let record = record(&told(&base, 3), 700).starting_at(12.5);
    let mut file = Vec::new();
    record.write_csv(&mut file).expect("it is written");
    let table = read(file, None).expect("it is a table");
    let (mapping, kind) = Mapping::guess(&table);
    let again = Builder::new(&table, &mapping, kind, Hold::Zero).and_then(Builder::finish).expect("a record").record;
    let seconds = |record: &Record, timed: &Timed| -> Vec<f64> {
        timed.times.iter().map(|step| record.time(0) + step * record.dt()).collect()
    };
    let [own, found] = [&record, &again].map(|record| record.clocks().expect("it has times"));
    for (own, found) in own.readings.iter().zip(&found.readings) {
        let [before, after] = [seconds(&record, own), seconds(&again, found)];
        // The new one begins and ends with the steps of its fastest clock.
        let from = before.iter().position(|time| (time - after[0]).abs() < 1e-9).expect("the first is among them");
        assert!(from < 20 && after.len() + 40 > before.len(), "{from}: {} of {}", after.len(), before.len());
        for (k, time) in after.iter().enumerate() {
            assert!((time - before[from + k]).abs() < 1e-9);
            assert_eq!(found.values[k], own.values[from + k]);
        }
    }
    // At steps that are asked for, the filters know the same at the end.
    let mut at_steps = mapping.clone();
    at_steps.time.dt = Some(0.25);
    let coarse = Builder::new(&table, &at_steps, kind, Hold::Zero).and_then(Builder::finish).expect("a record").record;
    assert!((coarse.dt(), coarse.time(0)) == (0.25, again.time(0)) || coarse.time(0) < again.time(0));
    let count = |record: &Record| record.clocks().map(|clocks| clocks.readings[0].times.len());
    assert!(count(&coarse) > Some(600) && coarse.len() < 40, "{:?} in {}", count(&coarse), coarse.len());
    at_steps.time.dt = Some(1e-12);
    let refused = Builder::new(&table, &at_steps, kind, Hold::Zero).err().expect("it is too long").to_string();
    assert!(refused.contains("samples"), "{refused}");
}

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
        for ((mean, std), value) in identified(&both).0.into_iter().zip([6.0, 0.05]) {
            let band = 2.0 * std;
            assert!((mean - value).abs() < 1.6 * band, "{every:?}: {value} {mean} ± {band}");
            assert!((mean / value - 1.0).abs() < 0.05, "{every:?}: {value} {mean} ± {band}");
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

/// Files that LibreOffice 7.4 has written, with their encoding and delimiter: a sheet of 121 rows, with the German locale and without
/// the reading in row 18, converted by `soffice --headless --convert-to 'csv:Text - txt - csv (StarCalc):…,1031,…'` with the charsets
/// UTF-8, UTF-16 and Latin-1.
const FILES: [(&[u8], Encoding, Delimiter); 3] = [
    (include_bytes!("data/libreoffice/german.csv"), Encoding::Utf8, Delimiter::Semicolon),
    (include_bytes!("data/libreoffice/utf-16.csv"), Encoding::Utf16Le, Delimiter::Semicolon),
    (include_bytes!("data/libreoffice/latin-1-tabs.csv"), Encoding::Latin1, Delimiter::Tab),
];

#[test]
fn files_of_a_german_libreoffice_are_read_without_a_choice() {
    for (bytes, encoding, delimiter) in FILES {
        let table = read(bytes, None).unwrap();
        let dialect = table.dialect;
        assert_eq!((dialect.encoding, dialect.delimiter, dialect.decimal), (encoding, delimiter, Decimal::Comma));
        let (mapping, kind) = Mapping::guess(&table);
        assert_eq!(kind, InputKind::Force);
        let Imported { record, remarks, .. } =
            Builder::new(&table, &mapping, kind, Hold::First).unwrap().finish().unwrap();
        assert_eq!(remarks, Vec::<String>::new());
        assert_eq!((record.len(), record.dt()), (121, 0.05));
        assert_eq!((record.input()[1], record.input()[120]), (0.005, 0.0));
        let displacement = record.measured_quantity(Quantity::DISPLACEMENT).unwrap();
        assert!((displacement[1] - 1.9098e-3).abs() < 1e-15, "{}", displacement[1]);
        let missing: Vec<usize> = (0..121).filter(|&k| displacement[k].is_nan()).collect();
        assert_eq!(missing, [17]);
    }
}
