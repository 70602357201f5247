//! Start values on records of many excitations, sensors and dampings, made here and not by the core: the guess, and the end
//! of the filter that begins with it.
#![expect(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

#[path = "common/excitation.rs"]
mod excitation;

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

/// The shares of a grid with a right guess and a right end, and the number of its records.
fn grid(seeds: std::ops::Range<u64>, oscillators: &[(f64, f64)], verbose: bool) -> (f64, f64, usize) {
    let (mut right, mut ends, mut all) = (0, 0, 0);
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
                    (right, ends, all) = (right + usize::from(is_right), ends + usize::from(is_end), all + 1);
                }
            }
        }
    }
    (right as f64 / all as f64, ends as f64 / all as f64, all)
}

#[test]
fn the_guess_is_right_under_every_excitation() {
    let (right, ends, all) = grid(0..1, &[(9.0, 200.0)], true);
    println!("{right:.3} {ends:.3} of {all}");
    assert!(right >= 0.95 && ends >= 0.95, "{right:.3} of the guesses and {ends:.3} of the ends are right");
}

/// All seeds and other oscillators: `cargo test -p kalmanscope-core --test start_values -- --ignored --nocapture`.
#[test]
#[ignore = "a measurement of minutes"]
fn the_whole_grid() {
    let (right, ends, all) = grid(100..110, &[(9.0, 200.0), (2.3, 50.0), (35.0, 750.0)], true);
    println!("of {all} records {:.1} % of the guesses are right, and {:.1} % of the ends", 100.0 * right, 100.0 * ends);
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
    for sensor in SENSORS {
        let truth = Oscillator { natural_frequency: 19.5, damping_ratio: 0.02 };
        let whole = record(truth, Excitation::White, sensor, 0.01, 8000, 7);
        let mut state = 9_u64;
        let random: Vec<bool> = (0..8000)
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (state >> 33).is_multiple_of(100)
            })
            .collect();
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
            // R comes from shorter windows, and the width of a peak from what is left of each.
            let most = [0.1, 0.01, 0.1, 0.05];
            let after = values(&with_losses(&whole, is_lost));
            for (((what, before), after), most) in ["R", "ωₙ", "ζ", "gain"].iter().zip(before).zip(after).zip(most)
            {
                assert!((after / before - 1.0).abs() < most, "{} {name}: {what} {before} {after}", sensor.key());
            }
        }
    }
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
