//! Start values and ends of filters on records of many excitations, free decays, and short records whose force has another unit.

use kalmanscope_core::suggest::{Suggestion, scenario_for, suggest};
use kalmanscope_core::{Channel, FilterSettings, Hold, Quantity, Record};

use crate::numbers::{Random, largest, motion, rms};
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
    let motion = motion([truth.natural_frequency, truth.damping_ratio], dt, Hold::Zero, &force, [0.0; 2]);
    forced(dt, Hold::Zero, force, measured(sensor, &motion, 0.01, rms, &mut random))
}

pub(crate) const SENSORS: [Quantity; 3] = [Quantity::DISPLACEMENT, Quantity::VELOCITY, Quantity::ACCELERATION];

/// With noise that is this share of the size of the readings.
fn measured(
    sensor: Quantity,
    motion: &[[f64; 3]],
    noise: f64,
    size: fn(&[f64]) -> f64,
    random: &mut Random,
) -> Vec<(Quantity, Vec<f64>)> {
    let place = SENSORS.iter().position(|one| *one == sensor).unwrap();
    let clean: Vec<f64> = motion.iter().map(|motion| motion[place]).collect();
    let std = noise * size(&clean);
    vec![(sensor, clean.iter().map(|y| y + std * random.normal()).collect())]
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

fn gain(filter: &FilterSettings) -> f64 {
    if filter.augment.contains(&Channel::INPUT_GAIN) { filter.initial_mean[Channel::INPUT_GAIN] } else { 1.0 }
}

type Losses = Box<dyn Fn(usize) -> bool>;

pub(crate) fn worst_of_losses(sensor: Quantity, excitation: Excitation, seed: u64) -> (f64, String) {
    let mut worst = (0.0, String::new());
    let truth = Oscillator { natural_frequency: 19.5, damping_ratio: 0.02 };
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
    pub(crate) fn of(seed: u64) -> Self {
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
        let force = vec![0.0; (rate * periods) as usize];
        let motion = motion([wn, zeta], dt, Hold::Zero, &force, [1.0, 0.0]);
        let columns = measured(sensor, &motion, noise, largest, &mut Random::new(seed + 100_000));
        forced(dt, Hold::First, force, columns)
    }

    /// Whether the start values are within 10 % of ωₙ and a factor of 1.3 of ζ and need no force, and in words.
    pub(crate) fn outcome(&self) -> (bool, String) {
        let filter = &suggestion(&self.record()).scenario.filters[0];
        let guess = filter.initial_mean[Channel::NATURAL_FREQUENCY] / self.natural_frequency;
        let damping = filter.initial_mean[Channel::DAMPING_RATIO] / self.damping_ratio;
        let is_white = filter.augment.contains(&Channel::WHITE_FORCE);
        let is_right = !is_white && (guess - 1.0).abs() < 0.1 && (1.0 / 1.3..1.3).contains(&damping);
        (is_right, format!("{self:?}: ωₙ {guess:.3}, ζ {damping:.2}, white force {is_white}"))
    }
}

/// Whether the guess is right for a short record, drawn from its seed, whose input has another unit: the force is `force_gain` times it.
pub(crate) fn outcome_of_short(samples: usize, rate: f64, force_gain: f64, seed: u64) -> (bool, String) {
    let mut random = Random::new(seed);
    let mut log = |low: f64, high: f64| low * (high / low).powf(random.uniform());
    // From 3 samples a period on, and 8 periods at least.
    let per_period = log(3.0, 40.0_f64.min(samples as f64 / 8.0));
    let (damping_ratio, noise) = (log(0.005, 0.1), log(0.005, 0.1));
    let (sensor, is_coloured) = (SENSORS[(seed / 4 % 3) as usize], seed % 2 == 1);
    let hold = if seed / 2 % 2 == 1 { Hold::Zero } else { Hold::First };
    let (wn, dt, mut random) = (std::f64::consts::TAU * rate / per_period, 1.0 / rate, Random::new(seed + 200_000));
    let (mut state, share) = (0.0, 1.0 - (-0.7 * wn * dt).exp());
    let mut draw = || {
        state += if is_coloured { share } else { 1.0 } * (random.normal() - state);
        state
    };
    let input: Vec<f64> = (0..samples).map(|_| draw()).collect();
    let force: Vec<f64> = input.iter().map(|input| force_gain * input).collect();
    let motion = motion([wn, damping_ratio], dt, hold, &force, [0.0; 2]);
    let record = forced(dt, hold, input, measured(sensor, &motion, noise, rms, &mut random));
    let filter = &suggestion(&record).scenario.filters[0];
    let guess = filter.initial_mean[Channel::NATURAL_FREQUENCY] / wn;
    let text = format!("{samples} at {rate} Hz, {seed}: ωₙ {guess:.3}, gain {:.3}", gain(filter) / force_gain);
    ((guess - 1.0).abs() < 0.1, text)
}
