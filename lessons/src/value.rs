//! Values of measures, measured and expected.

use std::fmt;

use kalmanscope_core::Document;
use serde::Deserialize;

/// The expected result of a measure that is not a number.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(try_from = "Document")]
pub enum Expected {
    /// Yes or no.
    Flag(bool),
    /// A verdict or a remark.
    Word(String),
    /// One of several verdicts or remarks.
    OneOf(Vec<String>),
}

impl TryFrom<Document> for Expected {
    type Error = &'static str;

    fn try_from(document: Document) -> Result<Self, Self::Error> {
        match document {
            Document::Flag(flag) => Ok(Self::Flag(flag)),
            Document::Text(word) => Ok(Self::Word(word)),
            other => other.read().map(Self::OneOf).map_err(|_| "expected `true`, `false`, a word or a list of words"),
        }
    }
}

/// The result of a measure.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number, or a ratio of two.
    Number(f64),
    /// Yes or no.
    Flag(bool),
    /// A verdict, or every remark.
    Words(Vec<&'static str>),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(x) if *x == 0.0 || (0.01..1e4).contains(&x.abs()) => write!(f, "{x:.3}"),
            Self::Number(x) => write!(f, "{x:.2e}"),
            Self::Flag(flag) => write!(f, "{flag}"),
            Self::Words(words) => f.write_str(&words.join(" + ")),
        }
    }
}
