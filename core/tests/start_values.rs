//! Start values on records of many excitations, sensors and dampings, made here and not by the core: the guess, and the end
//! of the filter that begins with it.
#![expect(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

#[path = "common/excitation.rs"]
mod excitation;
#[path = "common/random.rs"]
mod random;

use std::collections::BTreeMap;

use excitation::{Excitation, Oscillator, record};
use kalmanscope_core::suggest::{Suggestion, scenario_for, suggest};
use kalmanscope_core::{Channel, Quantity, Record, Run};

const SENSORS: [Quantity; 3] = [Quantity::DISPLACEMENT, Quantity::VELOCITY, Quantity::ACCELERATION];

fn suggestion(record: &Record) -> Suggestion {
    suggest(&scenario_for(record), record)
}

/// Whether the guess is within a tenth, and the EKF ends within 1 % of ωₙ and 15 % of ζ.
fn outcome(record: &Record, truth: Oscillator) -> (bool, bool, String) {
    let suggestion = suggestion(record);
    let guess = suggestion.scenario.filters[0].initial_mean[Channel::NATURAL_FREQUENCY];
    let mut run = Run::on_record(&suggestion.scenario, record.clone().into()).unwrap();
    run.finish();
    let ekf = &run.estimates()[0];
    let last = |channel| ekf.mean(ekf.len() - 1)[ekf.place(channel).unwrap()];
    let error = |value: f64, truth: f64| (value / truth - 1.0).abs();
    let (wn, zeta) = (last(Channel::NATURAL_FREQUENCY), last(Channel::DAMPING_RATIO));
    let ends = error(wn, truth.natural_frequency) < 0.01 && error(zeta, truth.damping_ratio) < 0.15;
    let text = format!(
        "guess {:.3}, end {:.4} {:.4}, {:?}",
        guess / truth.natural_frequency,
        wn / truth.natural_frequency,
        zeta / truth.damping_ratio,
        ekf.stop()
    );
    (error(guess, truth.natural_frequency) < 0.1, ends && ekf.stop().is_none(), text)
}

/// The records of a part of a grid: those with a right guess, those with a right end, and all.
type Counts = [usize; 3];

/// The counts of a grid: of everything, and by excitation, sensor and damping.
fn grid(seeds: std::ops::Range<u64>, oscillators: &[(f64, f64)], verbose: bool) -> (Counts, BTreeMap<String, Counts>) {
    let (mut all, mut parts) = ([0; 3], BTreeMap::<String, Counts>::new());
    for excitation in Excitation::ALL {
        for sensor in SENSORS {
            for damping_ratio in [0.005, 0.02, 0.1] {
                for seed in seeds.clone() {
                    let (hertz, rate) = oscillators[seed as usize % oscillators.len()];
                    let truth = Oscillator { natural_frequency: std::f64::consts::TAU * hertz, damping_ratio };
                    let record = record(truth, excitation, sensor, 1.0 / rate, 8192, seed);
                    let (is_right, is_end, text) = outcome(&record, truth);
                    if verbose && !(is_right && is_end) {
                        println!("{excitation:?} {} ζ {damping_ratio} seed {seed}: {text}", sensor.key());
                    }
                    let names = [format!("{excitation:?}"), sensor.key().to_owned(), format!("ζ {damping_ratio}")];
                    let add = |counts: &mut Counts| {
                        *counts = [counts[0] + usize::from(is_right), counts[1] + usize::from(is_end), counts[2] + 1];
                    };
                    names.into_iter().for_each(|name| add(parts.entry(name).or_default()));
                    add(&mut all);
                }
            }
        }
    }
    (all, parts)
}

/// Percentages of right guesses and right ends.
fn shares([right, ends, all]: Counts) -> [f64; 2] {
    [right, ends].map(|count| 100.0 * count as f64 / all as f64)
}

#[test]
fn the_guess_is_right_under_every_excitation() {
    let [right, ends] = shares(grid(0..1, &[(9.0, 200.0)], true).0);
    assert!(right >= 95.0 && ends >= 95.0, "{right:.1} % of the guesses and {ends:.1} % of the ends are right");
}

/// All seeds and other oscillators: `cargo test -p kalmanscope-core --test start_values -- --ignored --nocapture`.
#[test]
#[ignore = "a measurement of minutes"]
fn the_whole_grid() {
    let (all, parts) = grid(400..410, &[(9.0, 200.0), (2.3, 50.0), (35.0, 750.0)], true);
    for (name, counts) in parts.into_iter().chain([("all".to_owned(), all)]) {
        let [right, ends] = shares(counts);
        println!("{name}: {right:.1} % of the guesses and {ends:.1} % of the ends of {} are right", counts[2]);
    }
}

#[test]
fn rounding_stops_no_filter_of_a_motion_that_has_died_out() {
    for (hertz, rate, seed) in [(2.3, 50.0, 403), (35.0, 750.0, 401)] {
        let truth = Oscillator { natural_frequency: std::f64::consts::TAU * hertz, damping_ratio: 0.02 };
        let record = record(truth, Excitation::Step, Quantity::DISPLACEMENT, 1.0 / rate, 8192, seed);
        let (is_right, ends, text) = outcome(&record, truth);
        assert!(is_right && ends, "{hertz} Hz: {text}");
    }
}

/// Whether a sample is lost.
type Losses = Box<dyn Fn(usize) -> bool>;

/// The record with readings lost.
fn with_losses(record: &Record, is_lost: impl Fn(usize) -> bool) -> Record {
    let quantity = record.sensors()[0];
    let lost = |(k, value): (usize, &f64)| if is_lost(k) { f64::NAN } else { *value };
    let measured = record.measured(0).iter().enumerate().map(lost).collect();
    let input = kalmanscope_core::record::Input {
        kind: record.input_kind(),
        hold: record.hold(),
        values: record.input().to_vec(),
    };
    Record::new(record.dt(), input, vec![(quantity, measured)]).unwrap()
}

#[test]
fn lost_readings_change_no_start_value() {
    for (sensor, seed) in SENSORS.into_iter().zip([7, 8, 9]) {
        let (off, text) = worst_of_losses(sensor, Excitation::White, 0.02, seed);
        assert!(off < 0.05, "{text}");
    }
    for (excitation, seed) in [(Excitation::Multisine, 10), (Excitation::Hammer, 11)] {
        let (off, text) = worst_of_losses(Quantity::ACCELERATION, excitation, 0.02, seed);
        assert!(off < 0.05, "{text}");
    }
}

/// Other seeds, dampings and excitations: `cargo test -p kalmanscope-core --test start_values -- --ignored --nocapture`.
#[test]
#[ignore = "a measurement of minutes"]
fn lost_readings_of_many_records() {
    for excitation in Excitation::ALL {
        for sensor in SENSORS {
            let all =
                (200..204).map(|seed| worst_of_losses(sensor, excitation, [0.005, 0.02, 0.1][seed as usize % 3], seed));
            let worst = all.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
            println!("{excitation:?} {}: {:.1} %, {}", sensor.key(), 100.0 * worst.0, worst.1);
        }
    }
}

/// The largest relative change of a start value by four kinds of losses, and in words.
fn worst_of_losses(sensor: Quantity, excitation: Excitation, damping_ratio: f64, seed: u64) -> (f64, String) {
    let mut worst = (0.0, String::new());
    {
        let truth = Oscillator { natural_frequency: 19.5, damping_ratio };
        let whole = record(truth, excitation, sensor, 0.01, 8000, seed);
        let mut random = random::Random::new(seed + 1000);
        let random: Vec<bool> = (0..8000).map(|_| random.uniform() < 0.01).collect();
        let losses: [(&str, Losses); 4] = [
            ("1 % at random", Box::new(move |k| random[k])),
            ("one in 97", Box::new(|k| k % 97 == 50)),
            ("bursts", Box::new(|k| k % 400 > 380)),
            ("two long gaps", Box::new(|k| (1000..1120).contains(&k) || (5000..5300).contains(&k))),
        ];
        let values = |record: &Record| {
            let scenario = suggestion(record).scenario;
            let filter = &scenario.filters[0];
            let gain = filter.augment.contains(&Channel::INPUT_GAIN).then(|| filter.initial_mean[Channel::INPUT_GAIN]);
            [
                filter.sensor_std[0],
                filter.initial_mean[Channel::NATURAL_FREQUENCY],
                filter.initial_mean[Channel::DAMPING_RATIO],
                gain.unwrap_or(1.0),
            ]
        };
        let before = values(&whole);
        for (name, is_lost) in losses {
            let after = values(&with_losses(&whole, is_lost));
            for ((what, before), after) in ["R", "ωₙ", "ζ", "gain"].iter().zip(before).zip(after) {
                let change = (after / before - 1.0).abs();
                if change > worst.0 {
                    worst = (change, format!("{} {name}: {what} {before} {after}", sensor.key()));
                }
            }
        }
    }
    worst
}

#[test]
fn a_guess_that_is_not_found_is_said() {
    let truth = Oscillator { natural_frequency: 19.5, damping_ratio: 0.02 };
    let whole = record(truth, Excitation::White, Quantity::DISPLACEMENT, 0.01, 8000, 7);
    let half = suggestion(&with_losses(&whole, |k| k % 13 < 9));
    assert!(!half.is_guessed);
    let said = |text: &str| half.reasons.iter().any(|reason| reason.contains(text));
    assert!(said("no start values of ωₙ and ζ could be found, because too many readings"), "{:?}", half.reasons);
    assert!(!said("R as large"), "{:?}", half.reasons);
    assert!(suggestion(&whole).is_guessed);
}

/// The record with every input and every reading changed.
fn changed(record: &Record, input: impl Fn(f64) -> f64, reading: impl Fn(f64) -> f64) -> Record {
    let values = record.input().iter().map(|value| input(*value)).collect();
    let measured = record.measured(0).iter().map(|value| reading(*value)).collect();
    let input = kalmanscope_core::record::Input { kind: record.input_kind(), hold: record.hold(), values };
    Record::new(record.dt(), input, vec![(record.sensors()[0], measured)]).unwrap()
}

#[test]
fn offsets_of_arrays_are_no_motion() {
    let truth = Oscillator { natural_frequency: 6.0, damping_ratio: 0.05 };
    for (sensor, seed) in SENSORS.into_iter().zip(3..) {
        let whole = record(truth, Excitation::White, sensor, 0.02, 6000, seed);
        for gain in [1.0, 0.4] {
            let offset = changed(&whole, |f| (f + 3.0) / gain, |y| y + 0.5);
            let (is_right, ends, text) = outcome(&offset, truth);
            assert!(is_right && ends, "{} gain {gain}: {text}", sensor.key());
        }
    }
}
