//! What is said of a measure beside its formulas, and its values.

use std::fmt;

use super::observed::ObservedSums;
use crate::{CAUSES, VerdictKind};

/// The description of a measure.
#[derive(Debug)]
pub struct MeasureInfo {
    /// Its word in text.
    pub word: &'static str,
    /// Its name in a menu, with `@` for the symbol of its channel or sensor.
    pub name: &'static str,
    /// The kind of its values.
    pub kind: ValueKind,
    /// Its best value.
    pub best: Best,
    /// Whether it needs the truth.
    pub needs_truth: bool,
    /// Whether it needs the other filters of the run.
    pub needs_others: bool,
    /// Whether it is for tables and lessons, and in no menu of a map.
    pub is_special: bool,
    pub(super) of: MeasureSubject,
    pub(super) whole: Option<fn(&ObservedSums<'_>) -> f64>,
}

/// The kind of a measure's values, by which they are compared and drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ValueKind {
    /// Yes or no.
    Flag,
    /// The place of a verdict.
    Verdict,
    /// The place of a cause.
    Cause,
    /// Words.
    Words,
    /// A share of all, from 0 to 1.
    Share,
    /// A ratio to what is expected.
    Ratio,
    /// A distance in standard deviations, to either side.
    Distance,
    /// A logarithm of a likelihood, of which differences count.
    LogLikelihood,
    /// A time \[s\], which may never come.
    Time,
    /// A number of either sign.
    Signed,
    /// A number of either sign, of which the size counts.
    Error,
    /// A number that is not negative.
    Size,
}

impl ValueKind {
    /// Whether it is one of several kinds, and no size: numbers stand for their places.
    pub const fn is_of_kinds(self) -> bool {
        matches!(self, Self::Verdict | Self::Cause)
    }

    /// Whether two values are compared by their ratio, not by their difference.
    pub const fn is_ratio(self) -> bool {
        matches!(self, Self::Ratio | Self::Time | Self::Error | Self::Size)
    }
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

#[derive(Clone, Copy, Debug)]
pub(super) enum MeasureSubject {
    Filter,
    Channel(Option<&'static str>),
    Sensor(Option<&'static str>),
    Gain,
}

pub(super) const fn row(word: &'static str, name: &'static str, kind: ValueKind, of: MeasureSubject) -> MeasureInfo {
    let [needs_truth, needs_others, is_special] = [false; 3];
    MeasureInfo { word, name, kind, best: Best::None, needs_truth, needs_others, is_special, of, whole: None }
}

impl MeasureInfo {
    pub(super) const fn best(self, best: Best) -> Self {
        Self { best, ..self }
    }

    pub(super) const fn with_truth(self) -> Self {
        Self { needs_truth: true, ..self }
    }

    pub(super) const fn special(self) -> Self {
        Self { is_special: true, ..self }
    }

    pub(super) const fn with_sums(self, whole: fn(&ObservedSums<'_>) -> f64) -> Self {
        Self { whole: Some(whole), ..self }
    }

    /// Whether its value is a number, or can be written as one ([`Value::number`](crate::Value::number)).
    pub fn is_number(&self) -> bool {
        self.kind != ValueKind::Words
    }

    /// Whether it needs every estimate of the run; sums are not enough.
    pub const fn needs_history(&self) -> bool {
        self.whole.is_none()
    }
}

/// The value of a measure.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number, or a ratio of two.
    Number(f64),
    /// Yes or no.
    Flag(bool),
    /// A verdict, if there is one.
    Verdict(Option<VerdictKind>),
    /// The place of a cause in [`CAUSES`], if there is one.
    Cause(Option<usize>),
    /// Every remark.
    Words(Vec<&'static str>),
}

impl Value {
    /// As a number: 1 for yes, 0 for no, the place in [`VerdictKind::ALL`] or [`CAUSES`]; NaN for words, and where there is none.
    pub fn number(&self) -> f64 {
        match self {
            Self::Number(number) => *number,
            Self::Flag(flag) => f64::from(u8::from(*flag)),
            Self::Verdict(kind) => kind.map_or(f64::NAN, |kind| kind as usize as f64),
            Self::Cause(place) => place.map_or(f64::NAN, |place| place as f64),
            Self::Words(_) => f64::NAN,
        }
    }

    /// The words, `none` where there are none; empty for a number and a flag.
    pub fn words(&self) -> Vec<&'static str> {
        let words = match self {
            Self::Number(_) | Self::Flag(_) => return Vec::new(),
            Self::Verdict(kind) => kind.iter().map(|kind| kind.name()).collect(),
            Self::Cause(place) => place.iter().map(|place| CAUSES[*place].name).collect(),
            Self::Words(words) => words.clone(),
        };
        if words.is_empty() { vec!["none"] } else { words }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(x) if *x == 0.0 || (0.01..1e4).contains(&x.abs()) => write!(f, "{x:.3}"),
            Self::Number(x) => write!(f, "{x:.2e}"),
            Self::Flag(flag) => write!(f, "{flag}"),
            words => f.write_str(&words.words().join(" + ")),
        }
    }
}
