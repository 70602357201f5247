//! Functions of time: parameters of the truth, and the input, a force over mass or the acceleration of the ground.

use std::f64::consts::TAU;
use std::fmt;

use kalmanscope_filters::random::Normal;
use serde::de::{self, Deserializer, MapAccess, Visitor};
use serde::{Deserialize, Serialize};

/// A value over time. In a file a number, or a table as `{ step = { from = 6.0, to = 4.8, at = 30.0 } }`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Signal {
    /// One sudden change.
    Step(Step),
    /// A change at a constant rate.
    Ramp(Ramp),
    /// A periodic change.
    Sine(Sine),
    /// A constant value.
    #[serde(untagged)]
    Constant(f64),
}

/// `from` before the time `at`, `to` from then on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct Step {
    /// Value before.
    pub from: f64,
    /// Value after.
    pub to: f64,
    /// Time of the change \[s\].
    pub at: f64,
}

/// `from` until `start`, then linear, `to` from `end` on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct Ramp {
    /// Value before.
    pub from: f64,
    /// Value after.
    pub to: f64,
    /// Time at which the change begins \[s\].
    pub start: f64,
    /// Time at which the change is complete \[s\].
    pub end: f64,
}

/// `mean + amplitude sin(2π t / period)`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct Sine {
    /// Mean value.
    pub mean: f64,
    /// Amplitude.
    pub amplitude: f64,
    /// Time of one cycle \[s\].
    pub period: f64,
}

#[derive(Deserialize)]
#[serde(field_identifier, rename_all = "snake_case")]
enum ShapeKey {
    Step,
    Ramp,
    Sine,
}

impl Signal {
    /// The value at the time `t` \[s\].
    pub fn at(&self, t: f64) -> f64 {
        match *self {
            Self::Constant(value) => value,
            Self::Step(Step { from, at, .. }) if t < at => from,
            Self::Ramp(Ramp { from, start, .. }) if t < start => from,
            Self::Step(Step { to, .. }) => to,
            Self::Ramp(Ramp { to, end, .. }) if t >= end => to,
            Self::Ramp(Ramp { from, to, start, end }) => from + (to - from) * (t - start) / (end - start),
            Self::Sine(Sine { mean, amplitude, period }) => mean + amplitude * libm::sin(TAU * t / period),
        }
    }

    /// The smallest value that the signal can take.
    pub fn minimum(&self) -> f64 {
        match *self {
            Self::Constant(value) => value,
            Self::Step(Step { from, to, .. }) | Self::Ramp(Ramp { from, to, .. }) => from.min(to),
            Self::Sine(Sine { mean, amplitude, .. }) => mean - amplitude.abs(),
        }
    }

    /// Each number: its key behind that of the parameter, and its value.
    pub fn numbers(&self) -> Vec<(&'static str, f64)> {
        let mut own = *self;
        own.numbers_mut().into_iter().map(|(name, number)| (name, *number)).collect()
    }

    pub(crate) fn numbers_mut(&mut self) -> Vec<(&'static str, &mut f64)> {
        match self {
            Self::Constant(value) => vec![("", value)],
            Self::Step(Step { from, to, at }) => vec![(".step.from", from), (".step.to", to), (".step.at", at)],
            Self::Ramp(Ramp { from, to, start, end }) => {
                vec![(".ramp.from", from), (".ramp.to", to), (".ramp.start", start), (".ramp.end", end)]
            }
            Self::Sine(Sine { mean, amplitude, period }) => {
                vec![(".sine.mean", mean), (".sine.amplitude", amplitude), (".sine.period", period)]
            }
        }
    }
}

impl From<f64> for Signal {
    fn from(value: f64) -> Self {
        Self::Constant(value)
    }
}

impl<'de> Deserialize<'de> for Signal {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct SignalVisitor;

        impl<'de> Visitor<'de> for SignalVisitor {
            type Value = Signal;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number, or a table with exactly one of `step`, `ramp`, `sine`")
            }

            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Signal, E> {
                Ok(Signal::Constant(value))
            }

            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Signal, E> {
                Ok(Signal::Constant(value as f64))
            }

            fn visit_u64<E: de::Error>(self, value: u64) -> Result<Signal, E> {
                Ok(Signal::Constant(value as f64))
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Signal, A::Error> {
                let not_one = || de::Error::invalid_value(de::Unexpected::Map, &self);
                let signal = match map.next_key()?.ok_or_else(not_one)? {
                    ShapeKey::Step => Signal::Step(map.next_value()?),
                    ShapeKey::Ramp => Signal::Ramp(map.next_value()?),
                    ShapeKey::Sine => Signal::Sine(map.next_value()?),
                };
                if map.next_key::<de::IgnoredAny>()?.is_some() {
                    return Err(not_one());
                }
                Ok(signal)
            }
        }

        deserializer.deserialize_any(SignalVisitor)
    }
}

/// A force over mass f(t) \[m/s²\], held over each step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Force {
    /// No force: free vibration.
    None,
    /// Independent normal numbers, one per sample.
    WhiteNoise {
        /// Standard deviation \[m/s²\].
        std: f64,
    },
    /// `amplitude sin(frequency t)`.
    Sine {
        /// \[m/s²\]
        amplitude: f64,
        /// \[rad/s\]
        frequency: f64,
    },
    /// A sine with a frequency that rises linearly from `from` to `to` within `sweep`, then begins again.
    Chirp {
        /// \[m/s²\]
        amplitude: f64,
        /// \[rad/s\]
        from: f64,
        /// \[rad/s\]
        to: f64,
        /// Duration of one sweep \[s\].
        sweep: f64,
    },
    /// Hammer blows: the first sample of every period carries the whole impulse.
    ImpulseTrain {
        /// Change of velocity at each blow \[m/s\].
        impulse: f64,
        /// Time between blows \[s\].
        period: f64,
    },
    /// A constant force from the time `at` on.
    Step {
        /// \[m/s²\]
        amplitude: f64,
        /// \[s\]
        at: f64,
    },
}

impl Default for Force {
    fn default() -> Self {
        Self::WhiteNoise { std: 10.0 }
    }
}

impl Force {
    /// Held over `[k dt, (k + 1) dt)`. Draws one number per sample from `noise` if the force is random.
    pub(crate) fn sample(&self, k: usize, dt: f64, noise: &mut Normal) -> f64 {
        let t = k as f64 * dt;
        match *self {
            Self::None => 0.0,
            Self::WhiteNoise { std } => std * noise.sample(),
            Self::Sine { amplitude, frequency } => amplitude * libm::sin(frequency * t),
            Self::Chirp { amplitude, from, to, sweep } => {
                let s = libm::fmod(t, sweep);
                amplitude * libm::sin((from + (to - from) * s / (2.0 * sweep)) * s)
            }
            Self::ImpulseTrain { impulse, period } => {
                // The half step absorbs the rounding of k dt where the period is a multiple of dt.
                let cycle = |t: f64| libm::floor((t + 0.5 * dt) / period);
                if k == 0 || cycle(t) > cycle(t - dt) { impulse / dt } else { 0.0 }
            }
            Self::Step { at, .. } if t < at => 0.0,
            Self::Step { amplitude, .. } => amplitude,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kalmanscope_filters::random::Purpose;

    fn samples(force: Force, n: usize, dt: f64) -> Vec<f64> {
        let mut noise = Normal::new(1, Purpose::Force);
        (0..n).map(|k| force.sample(k, dt, &mut noise)).collect()
    }

    #[test]
    fn impulses_come_once_a_period_and_carry_the_impulse() {
        for dt in [0.01, 0.005, 0.1 / 3.0] {
            let n = (20.0 / dt) as usize;
            let train = samples(Force::ImpulseTrain { impulse: 2.0, period: 2.0 }, n, dt);
            let blows: Vec<usize> = (0..n).filter(|&k| train[k] != 0.0).collect();
            let expected: Vec<usize> = (0..10).map(|i| (2.0 * f64::from(i) / dt).round() as usize).collect();
            assert_eq!(blows, expected, "dt = {dt}");
            assert!((train.iter().sum::<f64>() * dt - 20.0).abs() < 1e-9);
        }
    }

    #[test]
    fn chirp_has_its_frequencies_at_its_ends() {
        let dt = 1e-4;
        let chirp = samples(Force::Chirp { amplitude: 1.0, from: 1.0, to: 20.0, sweep: 20.0 }, 400_000, dt);
        let slope = |k: usize| (chirp[k + 1] - chirp[k]) / dt;
        assert!((slope(0) - 1.0).abs() < 1e-3);
        assert_eq!(chirp[0], chirp[200_000], "the sweep begins again");
        let crossings = (190_000..199_999).filter(|&k| chirp[k] < 0.0 && chirp[k + 1] >= 0.0).count();
        assert!((crossings as f64 - 20.0 / TAU).abs() < 1.0);
    }
}
