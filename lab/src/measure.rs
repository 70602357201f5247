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

/// The description of a measure: one row each.
#[derive(Debug)]
pub struct MeasureInfo {
    /// Its word in text.
    pub word: &'static str,
    /// Its name in a menu, with `@` for the symbol of its channel or sensor.
    pub name: &'static str,
    /// Whether it needs the truth.
    pub needs_truth: bool,
    /// Whether it needs every estimate of the run; sums are not enough.
    pub needs_history: bool,
    /// Its best value.
    pub best: Best,
    of: Of,
}

/// The best value that a measure can have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Best {
    /// A ratio of one.
    One,
    /// Nought, to either side.
    Zero,
    /// As small as can be.
    Smallest,
    /// As large as can be.
    Largest,
    /// This value.
    At(f64),
    /// None: it is no matter of good or bad.
    None,
}

impl Best {
    /// The distance of a value from the best one; smaller is better. `None` where there is no best one.
    pub fn distance(self, value: f64) -> Option<f64> {
        let distance = match self {
            Self::One => libm::log(value).abs(),
            Self::Zero => value.abs(),
            Self::Smallest => value,
            Self::Largest => -value,
            Self::At(best) => (value - best).abs(),
            Self::None => return None,
        };
        (!distance.is_nan()).then_some(distance)
    }
}

/// What a measure is of.
#[derive(Clone, Copy, Debug)]
enum Of {
    /// The filter.
    Filter(Measure),
    /// A channel, in its unit or another one.
    Channel(fn(Channel) -> Measure, Option<&'static str>),
    /// A sensor, in its unit.
    Sensor(fn(Quantity) -> Measure),
}

/// The share of samples inside ±2σ that a filter with the right σ has.
const EXPECTED_INSIDE: f64 = 0.954;

/// Every measure, in the order of tables.
static ALL: [MeasureInfo; 15] = [
    row("nis", "mean NIS, 1 expected", Best::One, Of::Filter(Measure::Nis)),
    row("nees", "mean NEES, 1 expected", Best::One, Of::Filter(Measure::Nees)).with_truth(),
    row("consistency", "mean NIS, distance in σ", Best::Zero, Of::Filter(Measure::Consistency)),
    row("log_likelihood", "log likelihood", Best::Largest, Of::Filter(Measure::LogLikelihood)),
    row("diverged", "lost the truth", Best::None, Of::Filter(Measure::Diverged)),
    row("stopped", "stopped", Best::None, Of::Filter(Measure::Stopped)),
    row("verdict", "verdict", Best::None, Of::Filter(Measure::Verdict)).with_history(),
    row("error", "last error of @", Best::Zero, Of::Channel(Measure::Error, None)).with_truth(),
    row("rmse", "RMS error of @", Best::Smallest, Of::Channel(Measure::Rmse, None)).with_truth(),
    row("estimate", "last estimate of @", Best::None, Of::Channel(Measure::Estimate, None)),
    row("std", "last σ of @", Best::None, Of::Channel(Measure::Std, None)),
    row("settled", "settling time of @", Best::Smallest, Of::Channel(Measure::Settled, Some("s"))).with_truth(),
    row("coverage", "share of @ inside ±2σ", Best::At(EXPECTED_INSIDE), Of::Channel(Measure::Coverage, Some("")))
        .with_truth(),
    row("free_run", "free-run error of @", Best::Smallest, Of::Sensor(Measure::FreeRun)).with_history(),
    row("one_step", "one-step error of @", Best::Smallest, Of::Sensor(Measure::OneStep)).with_history(),
];

const fn row(word: &'static str, name: &'static str, best: Best, of: Of) -> MeasureInfo {
    MeasureInfo { word, name, needs_truth: false, needs_history: false, best, of }
}

impl MeasureInfo {
    const fn with_truth(self) -> Self {
        Self { needs_truth: true, ..self }
    }

    const fn with_history(self) -> Self {
        Self { needs_history: true, ..self }
    }
}

/// The reason why a text is no measure.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{0}` is no score; there are {plain}, and with a channel behind a dot {of_channels}, with a sensor {of_sensors}",
    plain = words(|of| matches!(of, Of::Filter(_))),
    of_channels = words(|of| matches!(of, Of::Channel(..))),
    of_sensors = words(|of| matches!(of, Of::Sensor(_))))]
pub struct UnknownMeasure(pub String);

fn words(is_it: fn(&Of) -> bool) -> String {
    ALL.iter().filter(|info| is_it(&info.of)).map(|info| info.word).collect::<Vec<_>>().join(", ")
}

impl Measure {
    /// Its row, and the channel or the sensor that it is of.
    fn parts(self) -> (&'static MeasureInfo, Option<Channel>, Option<Quantity>) {
        let (channel, sensor) = match self {
            Self::Error(c)
            | Self::Rmse(c)
            | Self::Estimate(c)
            | Self::Std(c)
            | Self::Settled(c)
            | Self::Coverage(c) => (Some(c), None),
            Self::FreeRun(quantity) | Self::OneStep(quantity) => (None, Some(quantity)),
            _ => (None, None),
        };
        let is_own = |info: &&MeasureInfo| match (info.of, channel, sensor) {
            (Of::Filter(measure), None, None) => measure == self,
            (Of::Channel(of, _), Some(channel), None) => of(channel) == self,
            (Of::Sensor(of), None, Some(sensor)) => of(sensor) == self,
            _ => false,
        };
        (ALL.iter().find(is_own).unwrap_or(&ALL[0]), channel, sensor)
    }

    /// Its description.
    pub fn info(self) -> &'static MeasureInfo {
        self.parts().0
    }

    /// The channel that it is of.
    pub fn channel(self) -> Option<Channel> {
        self.parts().1
    }

    /// Its name in a menu: `last error of ωₙ`.
    pub fn name(self) -> String {
        let (info, channel, sensor) = self.parts();
        info.name.replace('@', channel.map(Channel::symbol).or(sensor.map(Quantity::symbol)).unwrap_or_default())
    }

    /// The unit, empty for a pure number.
    pub fn unit(self) -> &'static str {
        match self.parts() {
            (MeasureInfo { of: Of::Channel(_, unit), .. }, Some(channel), _) => unit.unwrap_or(channel.unit()),
            (_, _, Some(sensor)) => sensor.unit(),
            _ => "",
        }
    }

    /// All measures of filters with these channels, beside these sensors.
    pub fn all<'a>(channels: &'a [Channel], sensors: &'a [Quantity]) -> impl Iterator<Item = Self> + 'a {
        let of_filter = ALL.iter().filter_map(|info| match info.of {
            Of::Filter(measure) => Some(measure),
            _ => None,
        });
        let of_channels = channels.iter().flat_map(|&channel| {
            ALL.iter().filter_map(move |info| match info.of {
                Of::Channel(of, _) => Some(of(channel)),
                _ => None,
            })
        });
        let of_sensors = sensors.iter().flat_map(|&sensor| {
            ALL.iter().filter_map(move |info| match info.of {
                Of::Sensor(of) => Some(of(sensor)),
                _ => None,
            })
        });
        of_filter.chain(of_channels).chain(of_sensors)
    }

    /// All measures from sums alone, of filters with these channels.
    pub fn of_sums(channels: &[Channel]) -> Vec<Self> {
        Self::all(channels, &[]).filter(|measure| !measure.info().needs_history).collect()
    }
}

impl fmt::Display for Measure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (info, channel, sensor) = self.parts();
        f.write_str(info.word)?;
        channel.map(Channel::key).or(sensor.map(Quantity::key)).map_or(Ok(()), |key| write!(f, ".{key}"))
    }
}

impl FromStr for Measure {
    type Err = UnknownMeasure;

    fn from_str(text: &str) -> Result<Self, UnknownMeasure> {
        let (word, key) = text.split_once('.').map_or((text, None), |(word, key)| (word, Some(key)));
        // An older word.
        let word = if word == "inside" { "coverage" } else { word };
        let measure = ALL.iter().find(|info| info.word == word).and_then(|info| match (info.of, key) {
            (Of::Filter(measure), None) => Some(measure),
            (Of::Channel(of, _), Some(key)) => Channel::from_key(key).map(of),
            (Of::Sensor(of), Some(key)) => Quantity::from_key(key).map(of),
            _ => None,
        });
        measure.ok_or_else(|| UnknownMeasure(text.to_owned()))
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
        for measure in &all {
            assert_eq!(measure.to_string().parse(), Ok(*measure));
        }
        let rows: std::collections::BTreeSet<&str> = all.iter().map(|measure| measure.info().word).collect();
        assert_eq!(rows.len(), ALL.len(), "each has its own row");
        assert_eq!(Measure::Coverage(Channel::NATURAL_FREQUENCY).name(), "share of ωₙ inside ±2σ");
        let units =
            [Measure::Rmse, Measure::Settled, Measure::Coverage].map(|of| of(Channel::NATURAL_FREQUENCY).unit());
        assert_eq!(units, ["rad/s", "s", ""]);
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
