//! Checks: the claims of a lesson as limits on numbers of a run.

use std::fmt;

use kalmanscope_core::{Channel, Quantity, Scenario};
use kalmanscope_diagnosis::{MeasureKind, Times, Value, ValueKind};
use serde::Deserialize;

use crate::LessonError;
use crate::grid::{GridCells, is_within};

/// The share of all records in which a check holds that states none.
pub(crate) const NEARLY_ALL: f64 = 0.98;

/// A claim of a lesson as a limit on a number.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Check {
    /// The filter's name.
    pub filter: String,
    /// Whether the smoothed estimates of the whole record are measured.
    #[serde(default)]
    pub smoothed: bool,
    /// The measure.
    pub measure: MeasureKind,
    /// The channel to measure.
    pub channel: Option<Channel>,
    /// The sensor to measure; the first if left out.
    pub sensor: Option<Quantity>,
    /// The time of the sample to measure \[s\]; the last sample if left out.
    pub at: Option<f64>,
    /// The beginning of the range to measure \[s\]; the first sample if left out.
    pub from: Option<f64>,
    /// The end of the range, excluded \[s\]; the record's end if left out.
    pub to: Option<f64>,
    /// Divides by the same measure of another filter.
    pub than: Option<String>,
    /// Divides by the same measure before the step's change.
    #[serde(default)]
    pub before: bool,
    /// Divides by the same measure at another time.
    pub than_at: Option<f64>,
    /// Measures the share of the cells of a grid in which the measure keeps within limits.
    pub cells: Option<GridCells>,
    /// The measured number must be above this.
    pub above: Option<f64>,
    /// The measured number must be below this.
    pub below: Option<f64>,
    /// The word must be one of these, for a measure that is none of numbers.
    #[serde(default)]
    pub is: Vec<String>,
    /// The share of all records in which the check holds; nearly all if left out: 98 %. The text of the step must state
    /// a lower share.
    #[serde(default = "nearly_all")]
    pub share: f64,
    /// The only seed to check, for a step about one particular record.
    pub seed: Option<u64>,
}

fn nearly_all() -> f64 {
    NEARLY_ALL
}

impl Check {
    /// The samples that are measured.
    pub fn times(&self) -> Times {
        Times { at: self.at, from: self.from, to: self.to }
    }

    /// The samples to compare with.
    pub fn reference_times(&self) -> Times {
        self.than_at.map_or_else(|| self.times(), |at| Times { at: Some(at), ..Times::default() })
    }

    /// The filter to compare with, and whether its smoothed estimates are meant.
    pub(crate) fn reference_filter(&self) -> (&str, bool) {
        self.than.as_ref().map_or((&self.filter, self.smoothed), |than| (than, false))
    }

    /// Whether it is about a verdict.
    pub fn is_of_verdict(&self) -> bool {
        self.measure.info().kind == ValueKind::Verdict
    }

    /// Whether the result is a ratio.
    pub fn is_relative(&self) -> bool {
        self.before || self.than.is_some() || self.than_at.is_some()
    }

    /// Whether a value meets the check; of a check over cells, a share of them.
    pub fn holds(&self, value: &Value) -> bool {
        is_within(value, (self.above, self.below), &self.is)
    }

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
        if let Some(cells) = &self.cells {
            cells.validate(scenario)?;
        }
        let own = (self.above.or(self.below).is_some(), !self.is.is_empty());
        // Those of the measure; a check over cells has others for their share.
        let (number, word) =
            self.cells.as_ref().map_or(own, |cells| (cells.above.or(cells.below).is_some(), !cells.is.is_empty()));
        let kind = self.measure.info().kind;
        let is_word = matches!(kind, ValueKind::Verdict | ValueKind::Words);
        let wrong = if matches!(kind, ValueKind::Cause | ValueKind::Flag) {
            "must be of a number, a verdict or a remark"
        } else if self.measure.needs_channel() && self.channel.is_none() {
            "lacks a `channel`"
        } else if self.measure.needs_sensor() && self.sensor.is_none() {
            "lacks a `sensor`"
        } else if !is_word && (!number || word) {
            "needs `above` or `below`"
        } else if is_word && (!word || number || self.is_relative()) {
            "needs `is`, and nothing to compare with"
        } else if self.cells.is_some() && (self.before || own != (true, false)) {
            "over cells needs `above` or `below` for their share, and cannot compare with `before`"
        } else if !(self.share > 0.0 && self.share <= 1.0) {
            "needs a `share` above 0 and up to 1"
        } else {
            return Ok(());
        };
        Err(self.trouble(wrong))
    }

    pub(crate) fn trouble(&self, what: &str) -> LessonError {
        LessonError::Check { measure: self.measure.to_string(), trouble: what.to_owned() }
    }
}

impl fmt::Display for Check {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let time = |Times { at, from, to }: Times| {
            let one = |word: &str, t: Option<f64>| t.map_or(String::new(), |t| format!(" {word} {t} s"));
            one("at", at) + &one("from", from) + &one("to", to)
        };
        let hindsight = if self.smoothed { ", smoothed" } else { "" };
        write!(f, "{} of {}{hindsight}", self.measure, self.filter)?;
        if let Some(channel) = self.channel {
            write!(f, " in {}", channel.key())?;
        }
        write!(f, "{}", time(self.times()))?;
        if self.is_relative() {
            let before = if self.before { " before" } else { "" };
            let other = self.than.as_deref().unwrap_or("that");
            let at = self.than_at.map_or(String::new(), |_| time(self.reference_times()));
            write!(f, ", over {other}{before}{at}")?;
        }
        if let Some(GridCells { x, y, above, below, is }) = &self.cells {
            limits(f, (*above, *below), is)?;
            write!(f, "; share of the cells of {x}")?;
            if let Some(y) = y {
                write!(f, " and {y}")?;
            }
        }
        limits(f, (self.above, self.below), &self.is)
    }
}

/// Writes the limits of a number or the expected words.
fn limits(f: &mut fmt::Formatter<'_>, (above, below): (Option<f64>, Option<f64>), is: &[String]) -> fmt::Result {
    for (word, limit) in [("above", above), ("below", below)] {
        if let Some(limit) = limit {
            write!(f, ", {word} {limit:?}")?;
        }
    }
    if is.is_empty() { Ok(()) } else { write!(f, ", {}", is.join(" or ")) }
}
