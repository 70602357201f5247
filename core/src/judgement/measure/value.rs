//! Values of measures.

use std::fmt;

use crate::VerdictKind;
use crate::judgement::diagnosis::CAUSES;

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
    /// The value as a number: 1 for yes and 0 for no; the place of the verdict in [`VerdictKind::ALL`], and of the
    /// cause in [`CAUSES`]. NaN for words, and where there is none.
    pub fn number(&self) -> f64 {
        match self {
            Self::Number(number) => *number,
            Self::Flag(flag) => f64::from(u8::from(*flag)),
            Self::Verdict(kind) => {
                let place = kind.and_then(|kind| VerdictKind::ALL.iter().position(|other| *other == kind));
                place.map_or(f64::NAN, |place| place as f64)
            }
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
