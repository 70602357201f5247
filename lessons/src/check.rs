//! Checks: what a lesson says, as numbers that a run must keep to.

use std::fmt;

use kalmanscope_core::{Channel, Quantity, Scenario};
use serde::Deserialize;

use crate::LessonError;
use crate::value::{Expected, Value};

/// The number of seeds that a check is tried with, of which it says how many must hold.
pub(crate) const SEEDS: usize = 10;

/// What is measured of a filter, over the samples of a range of time or at a single one. Errors are those of the canonical
/// form of the oscillator, whose natural frequency is not negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Measure {
    /// Root mean square error of a channel, in its unit.
    Rmse,
    /// The same over the true noise of the sensor that measures the channel.
    RmseOverSensor,
    /// Absolute value of the mean error of a channel over a range, in its unit.
    MeanError,
    /// Root mean square of a channel's error over its standard deviation: about 1 in a consistent filter.
    ErrorInStd,
    /// A channel's estimate at a time, in the filter's own form, which may be the mirrored one.
    Estimate,
    /// A channel's standard deviation at a time, in its unit.
    Std,
    /// The same over the posterior Cramér-Rao bound.
    StdOverBound,
    /// Share of the samples with the truth inside ±2σ of a channel.
    ShareInside,
    /// Mean normalised estimation error squared over the number of channels: 1 is expected.
    Nees,
    /// Mean normalised innovation squared over the number of sensors: 1 is expected.
    Nis,
    /// The largest autocorrelation of any sensor's innovations at lag 1, over the whole record.
    Autocorrelation,
    /// Mean absolute gain of a channel for a sensor.
    Gain,
    /// The time from `from`, or else the first sample, until a channel's estimate is within 5 % of the truth for good \[s\];
    /// infinite if it never is.
    Settled,
    /// Log likelihood per sample with a measurement.
    LogLikelihood,
    /// Evaluations of the plant's rate per predicted step: [`crate::evaluations_per_step`].
    Evaluations,
    /// The verdict on the whole record, in a word.
    Verdict,
    /// Whether the filter stopped.
    Stopped,
    /// The filter's remarks on the whole record, by keys such as `wind_up`; `none` if there are none.
    Remark,
}

/// Something that a lesson says, and what it means in numbers.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Check {
    /// The filter's name.
    pub filter: String,
    /// Of what the filter's smoother made of the whole record, instead of its estimates.
    #[serde(default)]
    pub smoothed: bool,
    /// What is measured.
    pub measure: Measure,
    /// Of which channel.
    pub channel: Option<Channel>,
    /// Of which sensor; the first if left out.
    pub sensor: Option<Quantity>,
    /// At which time \[s\]; the last sample if left out.
    pub at: Option<f64>,
    /// From which time on \[s\]; the first sample if left out.
    pub from: Option<f64>,
    /// Until which time \[s\], that excluded; the last sample if left out.
    pub to: Option<f64>,
    /// Divides by the same measure of another filter.
    pub than: Option<String>,
    /// Divides by the same measure of smoothed estimates, of the same filter unless `than` names another.
    #[serde(default)]
    pub than_smoothed: bool,
    /// Divides by the same measure before the step's change.
    #[serde(default)]
    pub before: bool,
    /// Divides by the same measure at another time.
    pub than_at: Option<f64>,
    /// Divides by the same measure over a range from another time on.
    pub than_from: Option<f64>,
    /// Divides by the same measure over a range until another time.
    pub than_to: Option<f64>,
    /// The number must be above this.
    pub above: Option<f64>,
    /// The number must be below this.
    pub below: Option<f64>,
    /// The answer must be this.
    pub is: Option<Expected>,
    /// In how many of ten seeds it must hold.
    #[serde(default = "all_seeds")]
    pub seeds: usize,
    /// The only seed with which it must hold, where a step is about one record.
    pub seed: Option<u64>,
}

fn all_seeds() -> usize {
    SEEDS
}

/// The samples that a measure is taken of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Times {
    /// At which time \[s\].
    pub at: Option<f64>,
    /// From which time on \[s\].
    pub from: Option<f64>,
    /// Until which time \[s\].
    pub to: Option<f64>,
}

impl Measure {
    /// The key in lesson files.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Rmse => "rmse",
            Self::RmseOverSensor => "rmse_over_sensor",
            Self::MeanError => "mean_error",
            Self::ErrorInStd => "error_in_std",
            Self::Estimate => "estimate",
            Self::Std => "std",
            Self::StdOverBound => "std_over_bound",
            Self::ShareInside => "share_inside",
            Self::Nees => "nees",
            Self::Nis => "nis",
            Self::Autocorrelation => "autocorrelation",
            Self::Gain => "gain",
            Self::Settled => "settled",
            Self::LogLikelihood => "log_likelihood",
            Self::Evaluations => "evaluations",
            Self::Verdict => "verdict",
            Self::Stopped => "stopped",
            Self::Remark => "remark",
        }
    }

    const fn needs_channel(self) -> bool {
        match self {
            Self::Rmse
            | Self::RmseOverSensor
            | Self::MeanError
            | Self::ErrorInStd
            | Self::Estimate
            | Self::Std
            | Self::StdOverBound
            | Self::ShareInside
            | Self::Gain
            | Self::Settled => true,
            Self::Nees
            | Self::Nis
            | Self::Autocorrelation
            | Self::LogLikelihood
            | Self::Evaluations
            | Self::Verdict
            | Self::Stopped
            | Self::Remark => false,
        }
    }

    const fn is_number(self) -> bool {
        !matches!(self, Self::Verdict | Self::Stopped | Self::Remark)
    }
}

impl Check {
    /// The samples that the check is about.
    pub fn times(&self) -> Times {
        Times { at: self.at, from: self.from, to: self.to }
    }

    /// The samples that it is compared with.
    pub fn reference_times(&self) -> Times {
        let other = Times { at: self.than_at, from: self.than_from, to: self.than_to };
        if other == (Times { at: None, from: None, to: None }) { self.times() } else { other }
    }

    /// The filter that it is compared with, and whether with its smoothed estimates.
    pub(crate) fn reference_filter(&self) -> (&str, bool) {
        match &self.than {
            Some(than) => (than, self.than_smoothed),
            None => (&self.filter, self.smoothed || self.than_smoothed),
        }
    }

    /// Whether it is about a ratio.
    pub fn is_relative(&self) -> bool {
        self.before || self.than.is_some() || self.than_smoothed || self.reference_times() != self.times()
    }

    /// Whether it is to be made with a seed.
    pub(crate) fn is_about(&self, seed: u64) -> bool {
        self.seed.is_none_or(|only| only == seed)
    }

    /// Whether a value is as it must be.
    pub fn holds(&self, value: &Value) -> bool {
        match (value, &self.is) {
            (Value::Number(value), _) => {
                !value.is_nan()
                    && self.above.is_none_or(|limit| *value > limit)
                    && self.below.is_none_or(|limit| *value < limit)
            }
            (Value::Flag(value), Some(Expected::Flag(expected))) => value == expected,
            (Value::Words(words), Some(Expected::Word(expected))) => words.contains(&expected.as_str()),
            (Value::Words(words), Some(Expected::OneOf(all))) => all.iter().any(|one| words.contains(&one.as_str())),
            _ => false,
        }
    }

    /// Whether the check can be made of a scenario.
    ///
    /// # Errors
    /// [`LessonError`] where it names a filter that is not there, lacks what its measure needs, or sets no limit.
    pub(crate) fn validate(&self, scenario: &Scenario) -> Result<(), LessonError> {
        for (name, smoothed) in [(self.filter.as_str(), self.smoothed), self.reference_filter()] {
            if !scenario.filters.iter().any(|filter| filter.name == name && (filter.smoother || !smoothed)) {
                return Err(LessonError::UnknownFilter(name.to_owned()));
            }
        }
        if let Some(sensor) = self.sensor
            && !scenario.sensors.iter().any(|s| s.measures == sensor)
        {
            return Err(LessonError::UnknownSensor(sensor));
        }
        let number = self.above.is_some() || self.below.is_some();
        let word = matches!(self.is, Some(Expected::Word(_) | Expected::OneOf(_))) && self.measure != Measure::Stopped;
        let flag = matches!(self.is, Some(Expected::Flag(_))) && self.measure == Measure::Stopped;
        let wrong = if self.measure.needs_channel() && self.channel.is_none() {
            "lacks a `channel`"
        } else if self.measure.is_number() && !(number && self.is.is_none()) {
            "needs `above` or `below`"
        } else if !self.measure.is_number() && (number || self.is_relative() || !(word || flag)) {
            "needs `is`, and nothing to compare with"
        } else if !(1..=SEEDS).contains(&self.seeds) {
            "must hold in 1 to 10 `seeds`"
        } else {
            return Ok(());
        };
        Err(self.trouble(wrong))
    }

    pub(crate) fn trouble(&self, what: &str) -> LessonError {
        LessonError::Check { measure: self.measure.key().to_owned(), trouble: what.to_owned() }
    }
}

impl fmt::Display for Check {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let time = |Times { at, from, to }: Times| {
            let one = |word: &str, t: Option<f64>| t.map_or(String::new(), |t| format!(" {word} {t} s"));
            one("at", at) + &one("from", from) + &one("to", to)
        };
        let hindsight = |smoothed: bool| if smoothed { ", smoothed" } else { "" };
        write!(f, "{} of {}{}", self.measure.key(), self.filter, hindsight(self.smoothed))?;
        if let Some(channel) = self.channel {
            write!(f, " in {}", channel.key())?;
        }
        write!(f, "{}", time(self.times()))?;
        if self.is_relative() {
            let before = if self.before { " before" } else { "" };
            let other = self.than.as_deref().unwrap_or("that");
            write!(f, ", over {other}{}{before}", hindsight(self.than_smoothed))?;
            if self.reference_times() != self.times() {
                write!(f, "{}", time(self.reference_times()))?;
            }
        }
        for (word, limit) in [("above", self.above), ("below", self.below)] {
            if let Some(limit) = limit {
                write!(f, ", {word} {limit:?}")?;
            }
        }
        match &self.is {
            Some(Expected::Flag(flag)) => write!(f, ", {flag}"),
            Some(Expected::Word(word)) => write!(f, ", {word}"),
            Some(Expected::OneOf(words)) => write!(f, ", {}", words.join(" or ")),
            None => Ok(()),
        }
    }
}
