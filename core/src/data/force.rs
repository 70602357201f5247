//! The input: a force over mass, or the acceleration of the ground.

use serde::{Deserialize, Serialize};

use crate::mathematics::random::Normal;

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
    use std::f64::consts::TAU;

    use crate::mathematics::random::Purpose;

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

    #[test]
    fn a_step_waits_and_none_is_nothing() {
        assert_eq!(samples(Force::Step { amplitude: 3.0, at: 0.02 }, 4, 0.01), [0.0, 0.0, 3.0, 3.0]);
        assert_eq!(samples(Force::None, 3, 0.01), [0.0; 3]);
    }
}
