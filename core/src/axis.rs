//! The values of one setting, equally spaced: an axis of a map, of a sweep, or of a check in a lesson.

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::Scenario;
use crate::setting::{Address, FADING, RECORD_GAIN, SEED};

pub(crate) const MAX_COUNT: usize = 1_000_000;

/// Equally spaced values of one setting, both ends included.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// The setting's key, as in [`Address`].
    pub key: String,
    /// The first value, in the setting's unit.
    pub from: f64,
    /// The last value.
    pub to: f64,
    /// The number of values.
    pub count: usize,
    /// The spacing.
    #[serde(default)]
    pub spacing: Spacing,
}

/// The spacing of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Spacing {
    /// Equal differences.
    #[default]
    Linear,
    /// Equal ratios.
    Logarithmic,
}

/// The reason why an axis is impossible.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum AxisError {
    /// An end is not a number.
    #[error("the axis of `{0}` must have finite ends")]
    Infinite(String),
    /// The number of values is not allowed: the setting's key, and that number.
    #[error("the axis of `{0}` has {1} values, but may have 1 to {MAX_COUNT}")]
    Count(String, usize),
    /// Ratios need positive ends.
    #[error("the logarithmic axis of `{0}` must have ends above zero")]
    NotPositive(String),
    /// The text is not an axis.
    #[error("`{0}` is not an axis: write KEY=FROM:TO:COUNT, and add :log for equal ratios")]
    Syntax(String),
}

impl Axis {
    /// The axis written as `KEY=FROM:TO:COUNT`, with `:log` behind it for equal ratios.
    ///
    /// ```
    /// use kalmanscope_core::{Axis, Spacing};
    ///
    /// let axis = Axis::parse("filters.EKF.process_std=0.01:100:5:log").unwrap();
    /// assert_eq!((axis.count, axis.spacing), (5, Spacing::Logarithmic));
    /// assert_eq!(axis.value(2), 1.0);
    /// ```
    ///
    /// # Errors
    /// [`AxisError`] where the text is none, or the axis is impossible.
    pub fn parse(text: &str) -> Result<Self, AxisError> {
        let syntax = || AxisError::Syntax(text.to_owned());
        let (key, range) = text.rsplit_once('=').ok_or_else(syntax)?;
        let parts: Vec<&str> = range.split(':').map(str::trim).collect();
        let ([from, to, count], spacing) = match parts[..] {
            [from, to, count] => ([from, to, count], Spacing::Linear),
            [from, to, count, "log"] => ([from, to, count], Spacing::Logarithmic),
            _ => return Err(syntax()),
        };
        let number = |text: &str| text.parse::<f64>().map_err(|_| syntax());
        let count = count.parse().map_err(|_| syntax())?;
        let axis = Self { key: key.trim().to_owned(), from: number(from)?, to: number(to)?, count, spacing };
        axis.check()?;
        Ok(axis)
    }

    /// Checks the axis: [`AxisError`] where it is impossible.
    pub fn check(&self) -> Result<(), AxisError> {
        let Self { key, from, to, count, spacing } = self;
        if !(from.is_finite() && to.is_finite()) {
            return Err(AxisError::Infinite(key.clone()));
        }
        if !(1..=MAX_COUNT).contains(count) {
            return Err(AxisError::Count(key.clone(), *count));
        }
        if *spacing == Spacing::Logarithmic && (*from <= 0.0 || *to <= 0.0) {
            return Err(AxisError::NotPositive(key.clone()));
        }
        Ok(())
    }

    /// The value at a place, from 0 on.
    pub fn value(&self, place: usize) -> f64 {
        let Self { from, to, count, spacing, .. } = self;
        if place == 0 {
            return *from;
        }
        if place + 1 >= *count {
            return *to;
        }
        let (place, last) = (place as f64, (count - 1) as f64);
        match spacing {
            // Multiplies first: this keeps seeds whole.
            Spacing::Linear => from + place * (to - from) / last,
            Spacing::Logarithmic => self.at_share(place / last),
        }
    }

    /// The value at a share of the axis, from 0 at its beginning to 1 at its end.
    pub fn at_share(&self, share: f64) -> f64 {
        let (from, to) = (self.from, self.to);
        match self.spacing {
            Spacing::Linear => from + share * (to - from),
            // A power keeps decades round, if the ratio of the ends is a normal number.
            Spacing::Logarithmic if (to / from).is_normal() => from * libm::pow(to / from, share),
            Spacing::Logarithmic => libm::exp(libm::log(from) + share * (libm::log(to) - libm::log(from))),
        }
    }

    /// The share of the axis at which a value lies, 0 at its beginning and 1 at its end; NaN if a logarithmic axis cannot have it.
    pub fn share_of(&self, value: f64) -> f64 {
        let (from, to) = (self.from, self.to);
        if from == to {
            return if value == from { 0.5 } else { f64::NAN };
        }
        match self.spacing {
            Spacing::Linear => (value - from) / (to - from),
            Spacing::Logarithmic => (libm::log(value) - libm::log(from)) / (libm::log(to) - libm::log(from)),
        }
    }

    /// The place with the value nearest to `value`, if `value` lies on the axis or at most half a step beyond its ends.
    pub fn place_of(&self, value: f64) -> Option<usize> {
        let last = (self.count.max(1) - 1) as f64;
        let place = libm::round(self.share_of(value) * last);
        (place >= 0.0 && place <= last).then_some(place as usize)
    }

    /// A usual axis around the present value: two decades each way for a std or a factor, 0 to three times the value for a guess.
    pub fn usual(setting: &Address, scenario: &Scenario, count: usize) -> Self {
        let key = setting.to_string();
        let now = setting.get(scenario);
        let linear = |from: f64, to: f64| Self { key: key.clone(), from, to, count, spacing: Spacing::Linear };
        let ratios = |from: f64, to: f64| Self { key: key.clone(), from, to, count, spacing: Spacing::Logarithmic };
        if key == SEED.key {
            return linear(1.0, count as f64);
        }
        if setting.is_of(&FADING) {
            return linear(1.0, if now > 1.02 { 2.0 * now - 1.0 } else { 1.02 });
        }
        if key == RECORD_GAIN.key && now > 0.0 {
            return ratios(now / 10.0, now * 10.0);
        }
        if setting.is_std {
            let centre = if now > 0.0 { now } else { setting.channel.map_or(1e-3, |c| c.usual().std / 100.0) };
            return ratios(centre / 100.0, centre * 100.0);
        }
        match setting.channel {
            Some(channel) => {
                let (low, high) = channel.usual().slider;
                linear(low, high.max(1.5 * now))
            }
            None if now > 0.0 => linear(0.0, 3.0 * now),
            None => linear(now - 5.0, now + 5.0),
        }
    }
}
