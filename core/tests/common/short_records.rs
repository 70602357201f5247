//! Short records of oscillators under a force whose column has another unit, made here and not by the core.

use kalmanscope_core::record::Input;
use kalmanscope_core::{Channel, Hold, InputKind, Quantity, Record};

use crate::random::Random;
use crate::start_values::{SENSORS, suggestion};

/// A short record of an oscillator under a force whose column has another unit, drawn from its seed.
#[derive(Clone, Copy, Debug)]
struct Short {
    samples: usize,
    /// \[Hz\]
    rate: f64,
    /// The force over the number that is recorded for it.
    gain: f64,
    /// Whether the force has most of its power below the natural frequency.
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
        let (mut x, mut v, h) = (0.0, 0.0, dt / FINE as f64);
        let mut signal = Vec::with_capacity(samples);
        for k in 0..samples {
            let next = if hold == Hold::First { input[(k + 1).min(samples - 1)] } else { input[k] };
            let force = |share: f64| gain * (input[k] + share * (next - input[k]));
            let rates = |f: f64, x: f64, v: f64| (v, f - 2.0 * zeta * wn * v - wn * wn * x);
            let felt = rates(force(0.0), x, v).1;
            signal.push([x, v, felt][SENSORS.iter().position(|one| *one == sensor).unwrap()]);
            for i in 0..FINE {
                let f = |part: f64| force((i as f64 + part) / FINE as f64);
                let a = rates(f(0.0), x, v);
                let b = rates(f(0.5), x + 0.5 * h * a.0, v + 0.5 * h * a.1);
                let c = rates(f(0.5), x + 0.5 * h * b.0, v + 0.5 * h * b.1);
                let d = rates(f(1.0), x + h * c.0, v + h * c.1);
                x += h / 6.0 * (a.0 + 2.0 * b.0 + 2.0 * c.0 + d.0);
                v += h / 6.0 * (a.1 + 2.0 * b.1 + 2.0 * c.1 + d.1);
            }
        }
        let size = (signal.iter().map(|y| y * y).sum::<f64>() / samples as f64).sqrt();
        let measured = signal.iter().map(|y| y + noise * size * random.normal()).collect();
        Record::new(dt, Input { kind: InputKind::Force, hold, values: input }, vec![(sensor, measured)]).unwrap()
    }

    fn outcome(&self) -> (bool, String) {
        let filter = &suggestion(&self.record()).scenario.filters[0];
        let guess = filter.initial_mean[Channel::NATURAL_FREQUENCY] / self.natural_frequency();
        let gain = filter.augment.contains(&Channel::INPUT_GAIN).then(|| filter.initial_mean[Channel::INPUT_GAIN]);
        let text = format!("{self:?}: ωₙ {guess:.3}, gain {:.3}", gain.unwrap_or(1.0) / self.gain);
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
