//! Start values on records of many excitations, sensors and dampings: the guess, and the end of the filter that begins with it.

use std::collections::BTreeMap;

use kalmanscope_core::suggest::{Suggestion, scenario_for, suggest};
use kalmanscope_core::{Channel, Quantity, Record, Run};

use crate::excitation::{Excitation, Oscillator, record};
use crate::random::Random;

pub(crate) const SENSORS: [Quantity; 3] = [Quantity::DISPLACEMENT, Quantity::VELOCITY, Quantity::ACCELERATION];

pub(crate) fn suggestion(record: &Record) -> Suggestion {
    suggest(&scenario_for(record), record)
}

/// Whether the guess is within a tenth, and the EKF ends within 1 % of ωₙ and 15 % of ζ.
pub(crate) fn outcome(record: &Record, truth: Oscillator) -> (bool, bool, String) {
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
pub(crate) type Counts = [usize; 3];

/// The counts of a grid: of everything, and by excitation, sensor and damping.
pub(crate) fn grid(
    seeds: std::ops::Range<u64>,
    oscillators: &[(f64, f64)],
    verbose: bool,
) -> (Counts, BTreeMap<String, Counts>) {
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
pub(crate) fn shares([right, ends, all]: Counts) -> [f64; 2] {
    [right, ends].map(|count| 100.0 * count as f64 / all as f64)
}

/// Whether a sample is lost.
type Losses = Box<dyn Fn(usize) -> bool>;

/// The largest relative change of a start value by four kinds of losses, and in words.
pub(crate) fn worst_of_losses(
    sensor: Quantity,
    excitation: Excitation,
    damping_ratio: f64,
    seed: u64,
) -> (f64, String) {
    let mut worst = (0.0, String::new());
    {
        let truth = Oscillator { natural_frequency: 19.5, damping_ratio };
        let whole = record(truth, excitation, sensor, 0.01, 8000, seed);
        let mut random = Random::new(seed + 1000);
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
            let after = values(&whole.clone().with_gaps(|_, k| is_lost(k)));
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
