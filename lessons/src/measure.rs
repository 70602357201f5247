//! The measures that a check can take of a filter.

use std::fmt;

use kalmanscope_core::Document;
use serde::{Deserialize, Serialize};

/// A measure of a filter, over a range of samples or at a single one. Errors are those of the canonical form of the
/// oscillator, whose natural frequency is not negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
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
    #[serde(alias = "share_inside")]
    Coverage,
    /// Mean normalised estimation error squared over the number of channels: 1 is expected.
    Nees,
    /// Mean normalised innovation squared over the number of sensors: 1 is expected.
    Nis,
    /// The largest autocorrelation of any sensor's innovations at lag 1, over the whole record.
    Autocorrelation,
    /// Mean absolute gain of a channel for a sensor.
    Gain,
    /// The standard deviation of a sensor's noise that the filter has learnt by a time, over the true one.
    LearntNoise,
    /// The standard deviation of that number over the number itself.
    LearntNoiseStd,
    /// Share of the samples with the true noise of a sensor inside ±2σ of the learnt one.
    LearntNoiseCoverage,
    /// The time from `from`, or else the first sample, until a channel's estimate stays within 5 % of the truth \[s\];
    /// infinite if it never does.
    Settled,
    /// Log likelihood per sample with a measurement.
    LogLikelihood,
    /// Probability of the filter as a model class among all filters at a time, from 0 to 1.
    Probability,
    /// Evaluations of the plant's rate per predicted step: [`crate::evaluations_per_step`].
    Evaluations,
    /// The verdict on the whole record, as a word.
    Verdict,
    /// Whether the filter stopped.
    Stopped,
    /// The filter's remarks on the whole record, by keys such as `wind_up`; `none` if there are none.
    Remark,
}

impl Measure {
    pub(crate) const fn needs_channel(self) -> bool {
        use Measure::{
            Coverage, ErrorInStd, Estimate, Gain, MeanError, Rmse, RmseOverSensor, Settled, Std, StdOverBound,
        };
        matches!(
            self,
            Rmse | RmseOverSensor | MeanError | ErrorInStd | Estimate | Std | StdOverBound | Coverage | Gain | Settled
        )
    }

    pub(crate) const fn is_number(self) -> bool {
        !matches!(self, Self::Verdict | Self::Stopped | Self::Remark)
    }
}

impl fmt::Display for Measure {
    /// Writes the key in lesson files.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match Document::of(self) {
            Ok(Document::Text(key)) => f.write_str(&key),
            _ => Err(fmt::Error),
        }
    }
}
