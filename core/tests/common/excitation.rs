//! Records of an oscillator under usual excitations, by a simulator of its own.

use kalmanscope_core::record::Input;
use kalmanscope_core::{Hold, InputKind, Quantity, Record};

use crate::random::Random;

/// The true oscillator.
#[derive(Clone, Copy)]
pub(crate) struct Oscillator {
    pub(crate) natural_frequency: f64,
    pub(crate) damping_ratio: f64,
}

/// The force on it; each has its power where a laboratory would put it.
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
    pub(crate) const ALL: [Self; 8] = [
        Self::White,
        Self::Hammer,
        Self::Prbs,
        Self::Multisine,
        Self::LowPassed,
        Self::WideSweep,
        Self::NarrowSweep,
        Self::Step,
    ];

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

/// A record of one sensor with noise of a hundredth of its signal.
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
    let wd = wn * (1.0 - zeta * zeta).sqrt();
    let (decay, cos, sin) = ((-zeta * wn * dt).exp(), (wd * dt).cos(), (wd * dt).sin());
    let (mut x, mut v) = (0.0, 0.0);
    let mut signal = Vec::with_capacity(samples);
    for &f in &force {
        signal.push(if sensor == Quantity::DISPLACEMENT {
            x
        } else if sensor == Quantity::VELOCITY {
            v
        } else {
            f - 2.0 * zeta * wn * v - wn * wn * x
        });
        let (rest, from) = (f / (wn * wn), x - f / (wn * wn));
        (x, v) = (
            decay * (cos * from + sin * (v + zeta * wn * from) / wd) + rest,
            decay * (cos * v - sin * (wn * wn * from + zeta * wn * v) / wd),
        );
    }
    let size = (signal.iter().map(|y| y * y).sum::<f64>() / samples as f64).sqrt();
    let measured = signal.iter().map(|y| y + 0.01 * size * random.normal()).collect();
    let input = Input { kind: InputKind::Force, hold: Hold::Zero, values: force };
    Record::new(dt, input, vec![(sensor, measured)]).unwrap()
}
