//! Trials: the results of several records of one oscillator, or of many alike.
//!
//! ```text
//! Run ──last estimates──▶ Trial ─┬─▶ Spring   T² against the added mass: stiffness, and what swings beside it
//!                                └─▶ Spread   the differences among trials, beside the σ of each filter
//! ```

mod spread;
mod spring;

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};

pub use spread::Spread;
pub use spring::Spring;

/// A number with its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimated {
    /// The mean.
    pub mean: f64,
    /// Its standard deviation.
    pub std: f64,
}

impl Estimated {
    /// The band: two standard deviations.
    pub fn band(&self) -> f64 {
        2.0 * self.std
    }

    /// The same in another unit.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self { mean: self.mean * factor, std: self.std * factor }
    }
}

/// Limits σ of a natural frequency over its mean, and the size of a damping ratio and its σ.
const SHARES: std::ops::RangeInclusive<f64> = 1e-12..=1e3;
const LARGEST: f64 = 1e6;

/// The results of one record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Trial {
    /// The name that the user gives it, such as a student's.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// The mass that was added to the oscillator \[kg\].
    #[serde(default)]
    pub mass: f64,
    /// ωₙ \[rad/s\]
    pub frequency: Estimated,
    /// ζ
    pub damping: Estimated,
    /// Whether the verdict on the filter lets one believe its bands.
    #[serde(default = "yes", skip_serializing_if = "is_true")]
    pub is_believed: bool,
}

const fn yes() -> bool {
    true
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks by reference")]
const fn is_true(it: &bool) -> bool {
    *it
}

impl Trial {
    /// Limits the trials of a table.
    pub const MOST: usize = 200;

    /// Limits the characters of a name.
    pub const LONGEST_NAME: usize = 40;

    /// Limits the mass that is added \[kg\].
    pub const HEAVIEST: f64 = 1e6;

    /// The undamped period `T = 2π / ωₙ` \[s\].
    pub fn period(&self) -> Estimated {
        let Estimated { mean, std } = self.frequency;
        Estimated { mean: TAU / mean, std: TAU / mean * (std / mean) }
    }

    /// The natural frequency in Hz.
    pub fn hertz(&self) -> Estimated {
        self.frequency.times(TAU.recip())
    }

    /// T² \[s²\], by which a spring's stiffness is found.
    pub fn period_squared(&self) -> Estimated {
        let Estimated { mean, std } = self.period();
        Estimated { mean: mean * mean, std: 2.0 * mean * std }
    }

    /// Whether the numbers are possible; they may come from outside.
    ///
    /// # Errors
    /// A sentence that says what is wrong.
    pub fn check(&self) -> Result<(), String> {
        let Self { name, mass, frequency, damping, .. } = self;
        if name.chars().count() > Self::LONGEST_NAME || name.chars().any(char::is_control) {
            return Err(format!("a trial's name must have at most {} usual characters", Self::LONGEST_NAME));
        }
        if !(0.0..=Self::HEAVIEST).contains(mass) {
            return Err(format!("a mass of {mass} kg was added, but it must be from 0 to {} kg", Self::HEAVIEST));
        }
        // Outside, squares of periods and of their σ are no numbers.
        let share = frequency.std / frequency.mean;
        if !((1e-9..=1e9).contains(&frequency.mean) && SHARES.contains(&share)) {
            return Err(format!(
                "a natural frequency of {} ± {} rad/s is impossible",
                frequency.mean,
                frequency.band()
            ));
        }
        if !(damping.mean.abs() <= LARGEST && (0.0..=LARGEST).contains(&damping.std)) {
            return Err(format!("a damping ratio of {} ± {} is impossible", damping.mean, damping.band()));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
