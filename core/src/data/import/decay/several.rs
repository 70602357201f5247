//! The decays of one oscillator that was plucked several times.

use std::fmt::Write as _;

use super::{Decay, NoDecay};

/// The cosine between the axes of two decays of one device that was not turned, at least.
const SAME_AXIS: f64 = 0.95;

/// Their swings in a second differ by this share at most, and by one swing over the length of the shorter.
const SAME_RATE: f64 = 0.03;

impl Decay {
    /// The longest free decay in readings ([`Self::of`]), and all others along its axis that swing as fast, in the order of time. A hand that
    /// takes the device away is none of them.
    ///
    /// # Errors
    /// [`NoDecay`].
    pub fn alike(readings: &[[f64; 4]]) -> Result<Vec<Self>, NoDecay> {
        let mut decays = Self::all(readings)?;
        let longest = decays.iter().max_by(|a, b| a.seconds().total_cmp(&b.seconds())).cloned();
        decays.retain(|decay| longest.as_ref().is_some_and(|longest| decay.is_like(longest)));
        Ok(decays)
    }

    /// The cosine between its axis and that of another decay.
    pub fn cos(&self, other: &Self) -> f64 {
        self.axis.iter().zip(&other.axis).map(|(a, b)| a * b).sum()
    }

    fn is_like(&self, longest: &Self) -> bool {
        let (own, other) = (self.swings(), longest.swings());
        let apart = (own / self.seconds() - other / longest.seconds()).abs();
        self.cos(longest).abs() >= SAME_AXIS && apart <= SAME_RATE * other / longest.seconds() + 1.0 / self.seconds()
    }

    /// The number of its swings: half of its changes of sign that are more than noise.
    fn swings(&self) -> f64 {
        let (mut sign, mut changes) = (0.0, 0);
        for x in self.acceleration.iter().filter(|x| x.abs() > 2.0 * self.noise) {
            changes += u32::from(sign * x < 0.0);
            sign = x.signum();
        }
        0.5 * f64::from(changes)
    }

    /// Decays of one oscillator as a CSV file that the importer reads: each reading with its own time after the beginning of the first one.
    /// What the hand does in between is left out.
    pub fn file(decays: &[Self]) -> String {
        let mut text = "t [s],acceleration [m/s²]\n".to_owned();
        let Some(first) = decays.first() else { return text };
        for decay in decays {
            // An axis has no sign of its own.
            let (sign, since) = (decay.cos(first).signum(), decay.begin - first.begin);
            for [time, acceleration] in &decay.readings {
                // A text takes whatever is written.
                let _ = writeln!(text, "{:.6},{:.6}", since + time, sign * acceleration);
            }
        }
        text
    }
}
