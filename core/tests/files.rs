//! Files: their times, the course of an input between samples, two that are one record, and those of LibreOffice.

use std::f64::consts::TAU;
use std::fmt::Write as _;

use kalmanscope_core::import::{Decimal, Delimiter, Encoding, Imported, Mapping, Table, build, join, read};
use kalmanscope_core::record::{Record, Timed};
use kalmanscope_core::suggest::{Suggestion, scenario_for, suggest};
use kalmanscope_core::{Channel, FilterKind, Force, Hold, InputKind, Quantity, Run, Scenario, Sensor, simulate};

use crate::clocks::{record, scenario, told};
use crate::numbers::{Random, rms};
use crate::run::{identified, imported, last, oscillator, run_on};

/// The displacement of an oscillator under a slow chirp that is linear between samples: a file cannot show a change within its step.
fn chirped(seed: u64, dt: f64, to: f64, sweep: f64, noise_std: f64) -> Record {
    let force = Force::Chirp { amplitude: 3.0, from: 1.0, to, sweep };
    let (plant, sensors) = (oscillator(6.0, 0.05), vec![Sensor::new(Quantity::DISPLACEMENT, noise_std)]);
    let blind = Scenario { seed, plant, sensors, filters: vec![], ..Scenario::default() };
    simulate(&Scenario { dt, duration: 60.0, hold: Hold::First, force, ..blind })
}

/// Its values at these milliseconds.
fn text(seed: u64, wanted: &[usize]) -> String {
    let record = chirped(seed, 1e-3, 4.0, 30.0, 0.01);
    let row = |k: &usize| format!("{:.3},{},{}\n", *k as f64 * 1e-3, record.input()[*k], record.measured(0)[*k]);
    "t [s],force,displacement\n".to_owned() + &wanted.iter().map(row).collect::<String>()
}

fn import(text: &str, even: bool) -> Imported {
    let table = read(text.as_bytes(), None).expect("it is a table");
    let (mut mapping, kind) = Mapping::guess(&table);
    mapping.time.even = even;
    build(&table, &mapping, kind, Hold::First, &[]).expect("it is a record")
}

fn ends(run: &Run, truth: [f64; 2]) -> [f64; 2] {
    let ends = [Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO].map(|channel| last(&run.estimates()[0], channel));
    [0, 1].map(|i| (ends[i].0 - truth[i]) / ends[i].1)
}

fn errors(record: &Record) -> [f64; 2] {
    ends(&run_on(&suggest(&scenario_for(record), record).scenario, record.clone()), [6.0, 0.05])
}

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
        assert!(remarks[0].starts_with("the times are irregular: the filters use each reading"), "{remarks:?}");
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

#[test]
fn a_file_of_a_record_keeps_its_times() {
    let base = scenario(FilterKind::KF, 3);
    let record = record(&told(&base, 3), 700).starting_at(12.5);
    let mut file = Vec::new();
    record.write_csv(&mut file).expect("it is written");
    let table = read(file, None).expect("it is a table");
    let (Imported { record: again, .. }, mapping) = imported(&table, Hold::Zero);
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
    let at_steps_of = |mapping: &Mapping| build(&table, mapping, InputKind::Force, Hold::Zero, &[]);
    let coarse = at_steps_of(&at_steps).expect("a record").record;
    assert!((coarse.dt(), coarse.time(0)) == (0.25, again.time(0)) || coarse.time(0) < again.time(0));
    let count = |record: &Record| record.clocks().map(|clocks| clocks.readings[0].times.len());
    assert!(count(&coarse) > Some(600) && coarse.len() < 40, "{:?} in {}", count(&coarse), coarse.len());
    at_steps.time.dt = Some(1e-12);
    let refused = at_steps_of(&at_steps).expect_err("it is too long").to_string();
    assert!(refused.contains("samples"), "{refused}");
}

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
        let moved = (k as f64 + jitter * every as f64 * (Random::new(k as u64).uniform() - 0.5)).max(0.0) as usize;
        let at = moved.min(values.len() - 1);
        writeln!(text, "{:.6},{}", at as f64 * dt + ahead, values[at]).expect("a text takes it");
        k += every;
    }
    read(text.into_bytes(), None).expect("it is a table")
}

#[test]
fn both_files_are_one_record_that_identifies_the_oscillator() {
    for (every, jitter) in [([2, 7], 0.0), ([5, 3], 0.4), ([4, 25], 0.6)] {
        let record = chirped(21, 0.002, 25.0, 60.0, 0.002);
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
    let record = chirped(2, 0.002, 25.0, 60.0, 0.002);
    let input = file(&record, record.input(), "force", (2, 0.0, 10.0, 0.0, 0.0));
    let sensor = file(&record, record.measured(0), "x [m]", (2, 20.0, 30.0, 0.0, 0.0));
    let apart = join(&input, &sensor, 0.0).expect_err("they do not overlap").to_string();
    assert!(apart.contains("one clock is from 0 to 10 s, the other from 20 to 30 s"), "{apart}");
    assert!(join(&input, &sensor, -15.0).is_ok());
    let without = read(b"force,x\n1,2\n3,4\n5,6\n", None).expect("it is a table");
    assert!(join(&without, &sensor, 0.0).expect_err("it has no times").to_string().contains("times"));
}

/// Files that LibreOffice 7.4 has written of 121 rows, with the German locale and without the reading in row 18:
/// `soffice --headless --convert-to 'csv:Text - txt - csv (StarCalc):…,1031,…'` with the charsets UTF-8, UTF-16 and Latin-1.
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
        let (Imported { record, remarks, .. }, _) = imported(&table, Hold::First);
        assert_eq!(record.input_kind(), InputKind::Force);
        assert_eq!(remarks, Vec::<String>::new());
        assert_eq!((record.len(), record.dt()), (121, 0.05));
        assert_eq!((record.input()[1], record.input()[120]), (0.005, 0.0));
        let displacement = record.measured_quantity(Quantity::DISPLACEMENT).unwrap();
        assert!((displacement[1] - 1.9098e-3).abs() < 1e-15, "{}", displacement[1]);
        let missing: Vec<usize> = (0..121).filter(|&k| displacement[k].is_nan()).collect();
        assert_eq!(missing, [17]);
    }
}

const FREQUENCY: f64 = 6.0;
const DAMPING: f64 = 0.03;

const NOISE: f64 = 0.01;

fn simulated(hold: Hold, per_swing: f64, samples: usize, seed: u64) -> String {
    let dt = TAU / FREQUENCY / per_swing;
    let (duration, plant) = (dt * (samples - 1) as f64, oscillator(FREQUENCY, DAMPING));
    let force = Force::WhiteNoise { std: 1.0 };
    let record = simulate(&Scenario { seed, dt, duration, hold, plant, force, filters: vec![], ..Scenario::default() });
    let displacement = record.truth(Channel::DISPLACEMENT).unwrap();
    table(dt, record.input(), displacement, seed)
}

fn simulated_slowly(per_swing: f64, samples: usize, seed: u64) -> String {
    let mut random = Random::new(seed);
    let dt = TAU / FREQUENCY / per_swing;
    let input: Vec<f64> = (0..samples).map(|k| (0.5 * FREQUENCY * dt * k as f64).sin()).collect();
    let displacement: Vec<f64> = input.iter().map(|u| 0.04 * (u + random.normal())).collect();
    table(dt, &input, &displacement, seed)
}

fn tones(per_swing: f64, samples: usize, seed: u64) -> String {
    let mut random = Random::new(seed);
    let dt = TAU / FREQUENCY / per_swing;
    let highest = 0.8 * std::f64::consts::PI / dt;
    let rate = DAMPING * FREQUENCY;
    let damped = FREQUENCY * (1.0 - DAMPING * DAMPING).sqrt();
    let all: Vec<[f64; 5]> = (0..60)
        .map(|k| {
            let w = highest * (f64::from(k) + random.uniform()) / 60.0;
            let phase = TAU * random.uniform();
            let (re, im) = (FREQUENCY * FREQUENCY - w * w, 2.0 * DAMPING * FREQUENCY * w);
            [w, phase, 0.2, 0.2 / re.hypot(im), phase - im.atan2(re)]
        })
        .collect();
    let forced = |t: f64| all.iter().map(|[w, _, _, a, p]| a * (w * t + p).cos()).sum::<f64>();
    let slope = -all.iter().map(|[w, _, _, a, p]| a * w * p.sin()).sum::<f64>();
    // It begins at rest.
    let (a, b) = (-forced(0.0), (-slope - rate * forced(0.0)) / damped);
    let free = |t: f64| (-rate * t).exp() * (a * (damped * t).cos() + b * (damped * t).sin());
    let times: Vec<f64> = (0..samples).map(|k| dt * k as f64).collect();
    let input: Vec<f64> =
        times.iter().map(|t| all.iter().map(|[w, phase, u, ..]| u * (w * t + phase).cos()).sum()).collect();
    let displacement: Vec<f64> = times.iter().map(|t| forced(*t) + free(*t)).collect();
    table(dt, &input, &displacement, seed)
}

fn table(dt: f64, input: &[f64], displacement: &[f64], seed: u64) -> String {
    let mut random = Random::new(seed + 1000);
    let size = rms(displacement);
    let mut text = "t [s],force,x\n".to_owned();
    for (k, (u, x)) in input.iter().zip(displacement).enumerate() {
        writeln!(text, "{},{u},{}", dt * k as f64, x + NOISE * size * random.normal()).unwrap();
    }
    text
}

fn suggested(text: &str) -> (Suggestion, [f64; 2]) {
    let one_filter = |scenario: &mut Scenario| scenario.filters.truncate(1);
    let (suggestion, run) = crate::run::suggested(&read(text.as_bytes(), None).unwrap(), |_| {}, one_filter);
    let (dt, expected) = (run.record().dt(), suggestion.scenario.dt);
    assert!((dt - expected).abs() < 1e-12, "{dt} {expected}");
    let errors = ends(&run, [FREQUENCY, DAMPING]);
    (suggestion, errors)
}

fn found(course: (Hold, usize), seeds: std::ops::Range<u64>, file: impl Fn(u64) -> String) -> [usize; 3] {
    let mut counts = [0; 3];
    for seed in seeds {
        let (suggestion, errors) = suggested(&file(seed));
        let Suggestion { scenario, reasons, .. } = &suggestion;
        let is_found = (scenario.hold, scenario.record.as_ref().unwrap().interpolate) == course;
        assert_eq!(reasons.iter().filter(|reason| reason.contains("between samples")).count(), 1, "{reasons:?}");
        for (count, is_so) in counts.iter_mut().zip([is_found, errors[0].abs() < 2.0, errors[1].abs() < 2.0]) {
            *count += usize::from(is_so);
        }
    }
    counts
}

#[test]
fn an_import_finds_the_course_of_an_input_between_samples() {
    for per_swing in [10.0, 25.0] {
        let samples = (150.0 * per_swing) as usize;
        let held = found((Hold::Zero, 1), 1..11, |seed| simulated(Hold::Zero, per_swing, samples, seed));
        let linear = found((Hold::First, 1), 1..11, |seed| simulated(Hold::First, per_swing, samples, seed));
        let limited = found((Hold::First, 4), 101..111, |seed| tones(per_swing, samples, seed));
        for (name, counts) in [("held", held), ("linear", linear), ("band-limited", limited)] {
            assert!(counts[0] == 10 && counts[1] >= 9 && counts[2] >= 9, "{name}, {per_swing} a swing: {counts:?}");
        }
    }
}

/// A force that hardly changes from sample to sample is the same in all three.
#[test]
fn a_course_that_the_readings_do_not_tell_stays_linear() {
    let (suggestion, _) = suggested(&simulated_slowly(400.0, 2000, 3));
    let Suggestion { scenario, reasons, .. } = &suggestion;
    assert_eq!((scenario.hold, scenario.record.as_ref().unwrap().interpolate), (Hold::First, 1));
    assert!(reasons.iter().any(|reason| reason.contains("input is linear between samples")), "{reasons:?}");
}

/// This includes a record whose columns have no meaning.
#[test]
fn what_is_stated_about_the_input_stays() {
    let table = read(simulated(Hold::Zero, 10.0, 1500, 1).as_bytes(), None).unwrap();
    let (mapping, kind) = Mapping::guess(&table);
    for (steps, is_known) in [(2, true), (1, false)] {
        let mapping = Mapping { interpolate: steps, ..mapping.clone() };
        let record = build(&table, &mapping, kind, Hold::First, &[]).unwrap().record;
        let mut scenario = scenario_for(&record);
        scenario.record = Some(mapping).filter(|_| is_known);
        let Suggestion { scenario, reasons, .. } = suggest(&scenario, &record);
        assert_eq!((scenario.hold, scenario.record.map_or(1, |mapping| mapping.interpolate)), (Hold::First, steps));
        assert!(!reasons.iter().any(|reason| reason.contains("between samples")), "{reasons:?}");
    }
}
