//! Start values on records of many excitations, sensors and dampings, on free decays without an input, and on short records under a
//! force whose column has another unit, made here and not by the core: the guess, and the end of the filter that begins with it.

use std::collections::BTreeMap;

use kalmanscope_core::suggest::{Suggestion, scenario_for, suggest};
use kalmanscope_core::{Channel, FilterSettings, Hold, Quantity, Record};
use nalgebra::Vector2;

use crate::numbers::{Random, largest, rms, runge_kutta, transition};
use crate::run::{finished_on, forced, last};

#[derive(Clone, Copy)]
pub(crate) struct Oscillator {
    pub(crate) natural_frequency: f64,
    pub(crate) damping_ratio: f64,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Excitation {
    White,
    Hammer,
    Prbs,
    Multisine,
    LowPassed,
    WideSweep,
    NarrowSweep,
    Step,
}

impl Excitation {
    pub(crate) const ALL: [Self; 8] = {
        use Excitation::{Hammer, LowPassed, Multisine, NarrowSweep, Prbs, Step, White, WideSweep};
        [White, Hammer, Prbs, Multisine, LowPassed, WideSweep, NarrowSweep, Step]
    };

    /// The force at each sample, of the size of one [m/s²].
    fn force(self, truth: Oscillator, dt: f64, samples: usize, random: &mut Random) -> Vec<f64> {
        let hertz = truth.natural_frequency / std::f64::consts::TAU;
        let tau = std::f64::consts::TAU;
        let sweep = |low: f64, high: f64| -> Vec<f64> {
            let whole = samples as f64 * dt;
            let at = |k: usize| {
                let t = k as f64 * dt;
                (tau * (low * t + 0.5 * (high - low) * t * t / whole)).sin()
            };
            (0..samples).map(at).collect()
        };
        // A fifth of the Nyquist frequency.
        let fifth = 0.1 / dt;
        match self {
            Self::White => (0..samples).map(|_| random.normal()).collect(),
            Self::Hammer => {
                let mut force = vec![0.0; samples];
                for hit in 0..6 {
                    let begin = 20 + hit * samples / 6;
                    for (i, share) in [0.4, 1.0, 1.0, 0.4].into_iter().enumerate() {
                        force[begin + i] = 30.0 * share;
                    }
                }
                force
            }
            Self::Prbs => {
                let mut value = 1.0;
                let next = |k: usize| {
                    if k.is_multiple_of(3) {
                        value = if random.uniform() < 0.5 { -1.0 } else { 1.0 };
                    }
                    value
                };
                (0..samples).map(next).collect()
            }
            Self::Multisine => {
                let lines: Vec<(f64, f64)> =
                    (1..=80).map(|i| (fifth * f64::from(i) / 80.0, tau * random.uniform())).collect();
                let at = |k: usize| {
                    let sum: f64 = lines.iter().map(|(f, phase)| (tau * f * k as f64 * dt + phase).sin()).sum();
                    sum / 80.0_f64.sqrt()
                };
                (0..samples).map(at).collect()
            }
            Self::LowPassed => {
                let share = 1.0 - (-tau * fifth * dt).exp();
                let mut states = [0.0; 4];
                let next = |_| {
                    let mut value = random.normal();
                    for state in &mut states {
                        *state += share * (value - *state);
                        value = *state;
                    }
                    3.0 * value
                };
                (0..samples).map(next).collect()
            }
            Self::WideSweep => sweep(0.1 * hertz, fifth.max(2.0 * hertz)),
            Self::NarrowSweep => sweep(0.6 * hertz, 1.5 * hertz),
            Self::Step => (0..samples).map(|k| if k < samples / 8 { 0.0 } else { 1.0 }).collect(),
        }
    }
}

pub(crate) fn record(
    truth: Oscillator,
    excitation: Excitation,
    sensor: Quantity,
    dt: f64,
    samples: usize,
    seed: u64,
) -> Record {
    let mut random = Random::new(seed);
    let force = excitation.force(truth, dt, samples, &mut random);
    let Oscillator { natural_frequency: wn, damping_ratio: zeta } = truth;
    let transition = transition([wn, zeta], dt);
    let mut state = Vector2::zeros();
    let mut signal = Vec::with_capacity(samples);
    for &f in &force {
        signal.push(reading(sensor, state.into(), f - 2.0 * zeta * wn * state[1] - wn * wn * state[0]));
        let rest = Vector2::new(f / (wn * wn), 0.0);
        state = transition * (state - rest) + rest;
    }
    let size = rms(&signal);
    let measured = signal.iter().map(|y| y + 0.01 * size * random.normal()).collect();
    forced(dt, Hold::Zero, force, vec![(sensor, measured)])
}

pub(crate) const SENSORS: [Quantity; 3] = [Quantity::DISPLACEMENT, Quantity::VELOCITY, Quantity::ACCELERATION];

pub(crate) fn reading(sensor: Quantity, [x, v]: [f64; 2], acceleration: f64) -> f64 {
    [x, v, acceleration][SENSORS.iter().position(|one| *one == sensor).unwrap()]
}

pub(crate) fn suggestion(record: &Record) -> Suggestion {
    suggest(&scenario_for(record), record)
}

/// Whether the guess is within a tenth, and the EKF ends within 1 % of ωₙ and 15 % of ζ.
pub(crate) fn outcome(record: &Record, truth: Oscillator) -> (bool, bool, String) {
    let suggestion = suggestion(record);
    let guess = suggestion.scenario.filters[0].initial_mean[Channel::NATURAL_FREQUENCY];
    let run = finished_on(&suggestion.scenario, record.clone());
    let ekf = &run.estimates()[0];
    let error = |value: f64, truth: f64| (value / truth - 1.0).abs();
    let (wn, zeta) = (last(ekf, Channel::NATURAL_FREQUENCY).0, last(ekf, Channel::DAMPING_RATIO).0);
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

pub(crate) type Counts = [usize; 3];

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

pub(crate) fn shares([right, ends, all]: Counts) -> [f64; 2] {
    [right, ends].map(|count| 100.0 * count as f64 / all as f64)
}

fn gain(filter: &FilterSettings) -> f64 {
    if filter.augment.contains(&Channel::INPUT_GAIN) { filter.initial_mean[Channel::INPUT_GAIN] } else { 1.0 }
}

type Losses = Box<dyn Fn(usize) -> bool>;

pub(crate) fn worst_of_losses(
    sensor: Quantity,
    excitation: Excitation,
    damping_ratio: f64,
    seed: u64,
) -> (f64, String) {
    let mut worst = (0.0, String::new());
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
        let [wn, zeta] = [Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO].map(|c| filter.initial_mean[c]);
        [filter.sensor_std[0], wn, zeta, gain(filter)]
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
    worst
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct RingDown {
    /// ωₙ \[rad/s\] and ζ.
    pub(crate) natural_frequency: f64,
    pub(crate) damping_ratio: f64,
    /// Samples in a period, and periods in the record.
    pub(crate) rate: f64,
    pub(crate) periods: f64,
    pub(crate) sensor: Quantity,
    /// The noise over the largest reading.
    pub(crate) noise: f64,
    pub(crate) seed: u64,
}

impl RingDown {
    fn of(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let mut log = |low: f64, high: f64| low * (high / low).powf(random.uniform());
        Self {
            natural_frequency: log(1.0, 60.0),
            damping_ratio: log(0.005, 0.1),
            rate: log(8.0, 80.0),
            periods: log(12.0, 80.0),
            sensor: SENSORS[seed as usize % 3],
            noise: log(0.01, 0.1),
            seed,
        }
    }

    fn record(&self) -> Record {
        let Self { natural_frequency: wn, damping_ratio: zeta, rate, periods, sensor, noise, seed } = *self;
        let dt = std::f64::consts::TAU / wn / rate;
        let clean = |k: usize| {
            let [x, v]: [f64; 2] = (transition([wn, zeta], k as f64 * dt) * Vector2::new(1.0, 0.0)).into();
            reading(sensor, [x, v], -wn * wn * x - 2.0 * zeta * wn * v)
        };
        let clean: Vec<f64> = (0..(rate * periods) as usize).map(clean).collect();
        let (size, mut random) = (largest(&clean), Random::new(seed + 100_000));
        let measured: Vec<f64> = clean.iter().map(|y| y + noise * size * random.normal()).collect();
        forced(dt, Hold::First, vec![0.0; clean.len()], vec![(sensor, measured)])
    }

    /// Whether the start values are within 10 % of ωₙ and a factor of 1.3 of ζ, and in words.
    pub(crate) fn outcome(&self) -> (bool, String) {
        let filter = &suggestion(&self.record()).scenario.filters[0];
        let guess = filter.initial_mean[Channel::NATURAL_FREQUENCY] / self.natural_frequency;
        let damping = filter.initial_mean[Channel::DAMPING_RATIO] / self.damping_ratio;
        let is_white = filter.augment.contains(&Channel::WHITE_FORCE);
        let is_right = (guess - 1.0).abs() < 0.1 && (1.0 / 1.3..1.3).contains(&damping);
        (is_right, format!("{self:?}: ωₙ {guess:.3}, ζ {damping:.2}, white force {is_white}"))
    }
}

pub(crate) fn right(seeds: std::ops::Range<u64>) -> f64 {
    let all = seeds.end - seeds.start;
    let outcomes = seeds.map(|seed| RingDown::of(seed).outcome());
    let wrong: Vec<String> = outcomes.filter(|(is_right, _)| !is_right).map(|(_, text)| text).collect();
    wrong.iter().for_each(|text| println!("{text}"));
    1.0 - wrong.len() as f64 / all as f64
}

/// A short record of an oscillator under a force whose column has another unit, drawn from its seed.
#[derive(Clone, Copy, Debug)]
struct Short {
    samples: usize,
    /// \[Hz\]
    rate: f64,
    /// The force over the number that is recorded for it.
    gain: f64,
    is_coloured: bool,
    per_period: f64,
    damping_ratio: f64,
    sensor: Quantity,
    noise: f64,
    hold: Hold,
    seed: u64,
}

const FINE: usize = 8;

impl Short {
    fn of(samples: usize, rate: f64, gain: f64, seed: u64) -> Self {
        let mut random = Random::new(seed);
        let mut log = |low: f64, high: f64| low * (high / low).powf(random.uniform());
        Self {
            samples,
            rate,
            gain,
            // From 3 samples a period on, and 8 periods at least.
            per_period: log(3.0, 40.0_f64.min(samples as f64 / 8.0)),
            damping_ratio: log(0.005, 0.1),
            noise: log(0.005, 0.1),
            is_coloured: seed % 2 == 1,
            hold: if seed / 2 % 2 == 1 { Hold::Zero } else { Hold::First },
            sensor: SENSORS[(seed / 4 % 3) as usize],
            seed,
        }
    }

    fn natural_frequency(&self) -> f64 {
        std::f64::consts::TAU * self.rate / self.per_period
    }

    fn record(&self) -> Record {
        let Self { samples, rate, gain, is_coloured, damping_ratio: zeta, sensor, noise, hold, seed, .. } = *self;
        let (wn, dt, mut random) = (self.natural_frequency(), 1.0 / rate, Random::new(seed + 200_000));
        let (mut state, share) = (0.0, 1.0 - (-0.7 * wn * dt).exp());
        let mut draw = || {
            state += if is_coloured { share } else { 1.0 } * (random.normal() - state);
            state
        };
        let input: Vec<f64> = (0..samples).map(|_| draw()).collect();
        let (mut y, h) = (Vector2::zeros(), dt / FINE as f64);
        let mut signal = Vec::with_capacity(samples);
        for k in 0..samples {
            let next = if hold == Hold::First { input[(k + 1).min(samples - 1)] } else { input[k] };
            let force = |t: f64| gain * (input[k] + t / dt * (next - input[k]));
            let rate = |y: Vector2<f64>, t: f64| Vector2::new(y[1], force(t) - 2.0 * zeta * wn * y[1] - wn * wn * y[0]);
            signal.push(reading(sensor, y.into(), rate(y, 0.0)[1]));
            y = (0..FINE).fold(y, |y, i| runge_kutta(y, i as f64 * h, h, rate));
        }
        let size = rms(&signal);
        let measured = signal.iter().map(|y| y + noise * size * random.normal()).collect();
        forced(dt, hold, input, vec![(sensor, measured)])
    }

    fn outcome(&self) -> (bool, String) {
        let filter = &suggestion(&self.record()).scenario.filters[0];
        let guess = filter.initial_mean[Channel::NATURAL_FREQUENCY] / self.natural_frequency();
        let text = format!("{self:?}: ωₙ {guess:.3}, gain {:.3}", gain(filter) / self.gain);
        ((guess - 1.0).abs() < 0.1, text)
    }
}

/// The records of a grid of lengths, rates and gains whose start values are right, and all. The others are printed.
pub(crate) fn right_of_short(lengths: impl Iterator<Item = usize>, rates: &[f64], gains: &[f64]) -> [usize; 2] {
    let mut counts = [0; 2];
    for samples in lengths {
        for &rate in rates {
            for &gain in gains {
                let (is_right, text) = Short::of(samples, rate, gain, counts[1] as u64).outcome();
                counts = [counts[0] + usize::from(is_right), counts[1] + 1];
                if !is_right {
                    println!("{text}");
                }
            }
        }
    }
    counts
}
