//! Measures: numbers, words and flags about a filter's run, each with a word as its name.

mod info;
mod observed;
mod rows;

use std::fmt;
use std::str::FromStr;

use kalmanscope_core::internals::KnownChannels;
use kalmanscope_core::{Channel, Diagnostics, Estimates, Quantity, Record, Scenario, Task};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::{CAUSES, Diagnosis, Search};

pub use info::{Best, MeasureInfo, Value, ValueKind};
pub use observed::{Observed, Times, Whole};
pub use rows::MeasureKind;

use info::MeasureSubject;
use observed::{ObservedSums, Part};
use rows::ROWS;

/// A measure of one filter's run over one record: a number, or one of the few with a word or a flag.
///
/// In text it is a word, with the channel or the sensor behind a dot where it has one: `nis`, `error.natural_frequency`,
/// `free_run.displacement`. Each is one row of a table, with its formula. [`Scenario::knowing`] reads those of an equation's channels.
///
/// ```
/// use kalmanscope_core::Channel;
/// use kalmanscope_diagnosis::Measure;
/// # fn main() -> Result<(), kalmanscope_diagnosis::UnknownMeasure> {
/// let measure: Measure = "error.natural_frequency".parse()?;
/// assert_eq!(measure, Measure::error(Channel::NATURAL_FREQUENCY));
/// assert_eq!(measure.name(), "last error of ωₙ");
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Measure {
    kind: MeasureKind,
    channel: Option<Channel>,
    sensor: Option<Quantity>,
}

/// The reason why a text is no measure.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{0}` is no score; there are {plain}, and with a channel behind a dot {of_channels}, with a sensor {of_sensors}",
    plain = words(|of| matches!(of, MeasureSubject::Filter)),
    of_channels = words(|of| matches!(of, MeasureSubject::Channel(_) | MeasureSubject::Gain)),
    of_sensors = words(|of| matches!(of, MeasureSubject::Sensor(_))))]
pub struct UnknownMeasure(pub String);

fn words(is_it: fn(&MeasureSubject) -> bool) -> String {
    let infos = ROWS.iter().map(|kind| kind.info()).filter(|info| is_it(&info.of));
    infos.map(|info| info.word).collect::<Vec<_>>().join(", ")
}

impl Measure {
    /// Mean normalised innovation squared over its degrees of freedom: 1 is expected.
    pub const NIS: Self = Self::row(MeasureKind::Nis, None, None);
    /// Mean normalised estimation error squared over its degrees of freedom: 1 is expected.
    pub const NEES: Self = Self::row(MeasureKind::Nees, None, None);
    /// The distance of the mean NIS from its expectation, in standard deviations of the mean of white innovations.
    pub const CONSISTENCY: Self = Self::row(MeasureKind::Consistency, None, None);
    /// Log likelihood of all measurements.
    pub const LOG_LIKELIHOOD: Self = Self::row(MeasureKind::LogLikelihood, None, None);
    /// Whether the filter stopped or lost the truth.
    pub const DIVERGED: Self = Self::row(MeasureKind::Diverged, None, None);
    /// Whether the filter stopped.
    pub const STOPPED: Self = Self::row(MeasureKind::Stopped, None, None);
    /// The verdict.
    pub const VERDICT: Self = Self::row(MeasureKind::Verdict, None, None);
    /// The first cause of a bad verdict, of the whole run. To find it takes up to seconds ([`FirstCause`]).
    pub const CAUSE: Self = Self::row(MeasureKind::Cause, None, None);

    const fn row(kind: MeasureKind, channel: Option<Channel>, sensor: Option<Quantity>) -> Self {
        Self { kind, channel, sensor }
    }

    /// The last error of a channel, estimate minus truth, in its unit.
    pub const fn error(channel: Channel) -> Self {
        Self::row(MeasureKind::Error, Some(channel), None)
    }

    /// Root mean square error of a channel over all samples.
    pub const fn rmse(channel: Channel) -> Self {
        Self::row(MeasureKind::Rmse, Some(channel), None)
    }

    /// The last estimate of a channel.
    pub const fn estimate(channel: Channel) -> Self {
        Self::row(MeasureKind::Estimate, Some(channel), None)
    }

    /// The last standard deviation of a channel.
    pub const fn std(channel: Channel) -> Self {
        Self::row(MeasureKind::Std, Some(channel), None)
    }

    /// Root mean square error of the identified model's free run, for one sensor in its unit.
    pub const fn free_run(sensor: Quantity) -> Self {
        Self::row(MeasureKind::FreeRun, None, Some(sensor))
    }

    /// A measure of a channel or a sensor, as far as its kind has one. `None` if it needs a channel or a sensor that is not given.
    pub fn new(kind: MeasureKind, channel: Option<Channel>, sensor: Option<Quantity>) -> Option<Self> {
        let (channel, sensor) = match kind.info().of {
            MeasureSubject::Filter => (None, None),
            MeasureSubject::Channel(_) => (Some(channel?), None),
            MeasureSubject::Sensor(_) => (None, Some(sensor?)),
            MeasureSubject::Gain => (Some(channel?), sensor),
        };
        Some(Self { kind, channel, sensor })
    }

    /// Its description.
    pub fn info(self) -> &'static MeasureInfo {
        self.kind.info()
    }

    /// The channel that it is of.
    pub fn channel(self) -> Option<Channel> {
        self.channel
    }

    /// The sensor that it is of.
    pub fn sensor(self) -> Option<Quantity> {
        self.sensor
    }

    /// Its name in a menu: `last error of ωₙ`.
    pub fn name(self) -> String {
        let of = self.channel.map(Channel::symbol).or(self.sensor.map(Quantity::symbol)).unwrap_or_default();
        self.info().name.replace('@', of)
    }

    /// The unit, empty for a pure number.
    pub fn unit(self) -> &'static str {
        match (self.info().of, self.channel, self.sensor) {
            (MeasureSubject::Channel(unit), Some(channel), _) => unit.unwrap_or(channel.unit()),
            (MeasureSubject::Sensor(unit), _, Some(sensor)) => unit.unwrap_or(sensor.unit()),
            _ => "",
        }
    }

    /// All measures with a number of filters with these channels, beside these sensors.
    pub fn all(channels: &[Channel], sensors: &[Quantity]) -> Vec<Self> {
        let mut all = Vec::new();
        let mut add = |is_it: fn(&MeasureSubject) -> bool, channel: Option<Channel>, sensor: Option<Quantity>| {
            let rows = ROWS.iter().filter(|row| row.info().is_number() && is_it(&row.info().of));
            all.extend(rows.map(|row| Self::row(*row, channel, sensor)));
        };
        add(|of| matches!(of, MeasureSubject::Filter), None, None);
        channels.iter().for_each(|channel| {
            add(|of| matches!(of, MeasureSubject::Channel(_) | MeasureSubject::Gain), Some(*channel), None);
        });
        sensors.iter().for_each(|sensor| add(|of| matches!(of, MeasureSubject::Sensor(_)), None, Some(*sensor)));
        all
    }

    /// All measures from sums alone, of filters with these channels.
    pub fn of_sums(channels: &[Channel]) -> Vec<Self> {
        Self::all(channels, &[]).into_iter().filter(|measure| !measure.info().needs_history()).collect()
    }

    /// The number of a run from its sums; NaN where it needs more than they have, or is not known.
    pub fn of_whole(self, whole: &Whole<'_>) -> f64 {
        self.info().whole.map_or(f64::NAN, |of| of(&ObservedSums { whole, channel: self.channel }))
    }

    /// Computes the value over a part of a run, from all its estimates. A number that does not exist is NaN.
    pub fn of(self, run: &Observed<'_>, times: Times) -> Value {
        let Self { kind, channel, sensor } = self;
        kind.within(&Part { run, channel, sensor, times })
    }
}

impl MeasureKind {
    /// Every kind, in the order of tables.
    pub fn all() -> impl Iterator<Item = Self> {
        ROWS.iter().copied()
    }

    /// The kind of this word.
    pub fn from_word(word: &str) -> Option<Self> {
        Self::all().find(|kind| kind.info().word == word)
    }

    /// Whether it is of a channel.
    pub fn needs_channel(self) -> bool {
        matches!(self.info().of, MeasureSubject::Channel(_) | MeasureSubject::Gain)
    }

    /// Whether it is of a sensor.
    pub fn needs_sensor(self) -> bool {
        matches!(self.info().of, MeasureSubject::Sensor(_))
    }
}

impl fmt::Display for MeasureKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.info().word)
    }
}

impl TryFrom<String> for MeasureKind {
    type Error = UnknownMeasure;

    fn try_from(word: String) -> Result<Self, UnknownMeasure> {
        Self::from_word(&word).ok_or(UnknownMeasure(word))
    }
}

impl From<MeasureKind> for String {
    fn from(kind: MeasureKind) -> Self {
        kind.to_string()
    }
}

impl fmt::Display for Measure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.kind)?;
        for key in self.channel.map(Channel::key).into_iter().chain(self.sensor.map(Quantity::key)) {
            write!(f, ".{key}")?;
        }
        Ok(())
    }
}

impl FromStr for Measure {
    type Err = UnknownMeasure;

    fn from_str(text: &str) -> Result<Self, UnknownMeasure> {
        let mut parts = text.split('.');
        let mut read = || {
            let kind = MeasureKind::from_word(parts.next()?)?;
            let channel = if kind.needs_channel() { Some(KnownChannels::channel(parts.next()?)?) } else { None };
            let sensor = parts.next().map(|key| Quantity::from_key(key).ok_or(())).transpose().ok()?;
            let measure = Self::new(kind, channel, sensor)?;
            (measure.sensor == sensor && parts.next().is_none()).then_some(measure)
        };
        read().ok_or_else(|| UnknownMeasure(text.to_owned()))
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

/// A search for the causes of the verdict on a filter, of which the first one counts. It takes up to seconds.
pub struct FirstCause(Option<Box<Search>>);

impl FirstCause {
    /// Before a search. There is none where the verdict is good or not known.
    pub fn new(scenario: &Scenario, place: usize, estimates: &Estimates, record: &Record) -> Self {
        let diagnostics = Diagnostics::new(estimates, record);
        let diagnosis = Diagnosis::new(&diagnostics, estimates, record);
        let is_bad = |diagnosis: &Diagnosis| diagnosis.verdict.as_ref().is_some_and(|verdict| !verdict.kind.is_good());
        let diagnosis = diagnosis.filter(is_bad);
        let search = diagnosis.and_then(|one| one.search(scenario, place, &diagnostics, estimates, record).ok());
        Self(search.map(Box::new))
    }
}

impl Task for FirstCause {
    /// The place of the cause in [`CAUSES`].
    type Outcome = Option<usize>;

    fn progress(&self) -> f64 {
        self.0.as_ref().map_or(1.0, |search| search.progress())
    }

    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        self.0.as_mut().is_none_or(|search| search.advance(while_time))
    }

    fn finish(self) -> Option<usize> {
        let remedies = self.0?.finish();
        let key = remedies.first()?.first.cause.key;
        CAUSES.iter().position(|cause| cause.key == key)
    }
}
