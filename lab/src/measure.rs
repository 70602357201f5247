//! The scores of a run.

use std::fmt;
use std::str::FromStr;

use kalmanscope_core::{Channel, Quantity};
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A number about one filter's run over one record.
///
/// In text it is a word, with the channel or the sensor behind a dot where it has one: `nis`, `error.natural_frequency`,
/// `free_run.displacement`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Measure {
    /// Mean normalised innovation squared over its degrees of freedom: 1 is expected.
    Nis,
    /// Mean normalised estimation error squared over its degrees of freedom: 1 is expected.
    Nees,
    /// The distance of the mean NIS from its expectation, in standard deviations of the mean of white innovations.
    Consistency,
    /// Log likelihood of all measurements.
    LogLikelihood,
    /// 1 where the filter stopped or lost the truth, else 0.
    Diverged,
    /// 1 where the filter stopped, else 0.
    Stopped,
    /// The place of the verdict in [`VerdictKind::ALL`](kalmanscope_core::VerdictKind::ALL); NaN where there are too few
    /// measurements for one.
    Verdict,
    /// The last error of a channel, estimate minus truth, in its unit.
    Error(Channel),
    /// Root mean square error of a channel over all samples.
    Rmse(Channel),
    /// The last estimate of a channel.
    Estimate(Channel),
    /// The last standard deviation of a channel.
    Std(Channel),
    /// The time after which a channel has stayed within 5 % of the truth \[s\]; infinite if it has not.
    Settled(Channel),
    /// The share of samples with a channel's truth inside ±2σ.
    Coverage(Channel),
    /// Root mean square error of the identified model's free run, for one sensor in its unit.
    FreeRun(Quantity),
    /// Root mean square of the innovations of one sensor, in its unit.
    OneStep(Quantity),
}

/// The reason why a text is no measure.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{0}` is no score; there are {words}, and with a channel behind a dot {channels}, with a sensor {sensors}",
    words = WORDS.map(|(word, _)| word).join(", "),
    channels = OF_CHANNELS.map(|(word, _)| word).join(", "),
    sensors = OF_SENSORS.map(|(word, _)| word).join(", "))]
pub struct UnknownMeasure(pub String);

const WORDS: [(&str, Measure); 7] = [
    ("nis", Measure::Nis),
    ("nees", Measure::Nees),
    ("consistency", Measure::Consistency),
    ("log_likelihood", Measure::LogLikelihood),
    ("diverged", Measure::Diverged),
    ("stopped", Measure::Stopped),
    ("verdict", Measure::Verdict),
];

type OfChannel = fn(Channel) -> Measure;
const OF_CHANNELS: [(&str, OfChannel); 6] = [
    ("error", Measure::Error),
    ("rmse", Measure::Rmse),
    ("estimate", Measure::Estimate),
    ("std", Measure::Std),
    ("settled", Measure::Settled),
    ("coverage", Measure::Coverage),
];

type OfSensor = fn(Quantity) -> Measure;
const OF_SENSORS: [(&str, OfSensor); 2] = [("free_run", Measure::FreeRun), ("one_step", Measure::OneStep)];

impl Measure {
    /// Whether the measure needs every estimate of the run; sums are not enough.
    pub fn needs_history(self) -> bool {
        matches!(self, Self::Verdict | Self::FreeRun(_) | Self::OneStep(_))
    }

    /// Whether the measure needs the truth.
    pub fn needs_truth(self) -> bool {
        matches!(self, Self::Nees | Self::Error(_) | Self::Rmse(_) | Self::Settled(_) | Self::Coverage(_))
    }

    /// The unit, empty for a pure number.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Error(channel) | Self::Rmse(channel) | Self::Estimate(channel) | Self::Std(channel) => channel.unit(),
            Self::Settled(_) => "s",
            Self::FreeRun(sensor) | Self::OneStep(sensor) => sensor.unit(),
            _ => "",
        }
    }

    /// All measures from sums alone, of filters with these channels.
    pub fn of_sums(channels: &[Channel]) -> Vec<Self> {
        let plain = WORDS.map(|(_, measure)| measure).into_iter();
        let of_channels = channels.iter().flat_map(|&channel| OF_CHANNELS.map(|(_, measure)| measure(channel)));
        plain.chain(of_channels).filter(|measure| !measure.needs_history()).collect()
    }
}

impl fmt::Display for Measure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((word, _)) = WORDS.iter().find(|(_, measure)| measure == self) {
            return f.write_str(word);
        }
        let (key, word) = match *self {
            Self::FreeRun(sensor) | Self::OneStep(sensor) => {
                (sensor.key(), OF_SENSORS.iter().find(|(_, of)| of(sensor) == *self).map(|(word, _)| word))
            }
            Self::Error(c)
            | Self::Rmse(c)
            | Self::Estimate(c)
            | Self::Std(c)
            | Self::Settled(c)
            | Self::Coverage(c) => (c.key(), OF_CHANNELS.iter().find(|(_, of)| of(c) == *self).map(|(word, _)| word)),
            _ => ("", None),
        };
        write!(f, "{}.{key}", word.unwrap_or(&""))
    }
}

impl FromStr for Measure {
    type Err = UnknownMeasure;

    fn from_str(text: &str) -> Result<Self, UnknownMeasure> {
        let unknown = || UnknownMeasure(text.to_owned());
        let Some((word, key)) = text.split_once('.') else {
            return WORDS.iter().find(|(word, _)| *word == text).map(|(_, measure)| *measure).ok_or_else(unknown);
        };
        // An older word.
        let word = if word == "inside" { "coverage" } else { word };
        let channel = || {
            let (_, of) = OF_CHANNELS.iter().find(|(name, _)| *name == word)?;
            Channel::from_key(key).map(of)
        };
        let sensor = || {
            let (_, of) = OF_SENSORS.iter().find(|(name, _)| *name == word)?;
            Quantity::from_key(key).map(of)
        };
        channel().or_else(sensor).ok_or_else(unknown)
    }
}

impl TryFrom<String> for Measure {
    type Error = UnknownMeasure;

    fn try_from(text: String) -> Result<Self, UnknownMeasure> {
        text.parse()
    }
}

impl From<Measure> for String {
    fn from(measure: Measure) -> Self {
        measure.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measures_are_written_and_read() {
        let mut all = Measure::of_sums(&[Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO]);
        assert_eq!(all.len(), 6 + 12);
        all.extend([Measure::Verdict, Measure::FreeRun(Quantity::DISPLACEMENT), Measure::OneStep(Quantity::VELOCITY)]);
        for measure in all {
            assert_eq!(measure.to_string().parse(), Ok(measure));
        }
        assert_eq!("inside.damping_ratio".parse(), Ok(Measure::Coverage(Channel::DAMPING_RATIO)));
        assert_eq!(Measure::Rmse(Channel::NATURAL_FREQUENCY).to_string(), "rmse.natural_frequency");
    }

    #[test]
    fn other_words_are_refused_with_those_that_there_are() {
        for text in ["", "nis.velocity", "rmse", "rmse.speed", "free_run.damping_ratio", "verdicts"] {
            let error = text.parse::<Measure>().unwrap_err().to_string();
            assert!(error.contains("log_likelihood") && error.contains("free_run"), "{error}");
        }
    }
}
