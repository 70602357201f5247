//! The limits of a measured value.

use kalmanscope_core::Value;
use kalmanscope_core::document::{self, Document};
use serde::Deserialize;

/// The limits of a value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Limits<'a> {
    pub(crate) above: Option<f64>,
    pub(crate) below: Option<f64>,
    pub(crate) is: Option<&'a Expected>,
}

impl Limits<'_> {
    /// Whether a value keeps within the limits.
    pub(crate) fn hold(self, value: &Value) -> bool {
        match (value, self.is) {
            (Value::Number(value), _) => {
                !value.is_nan()
                    && self.above.is_none_or(|limit| *value > limit)
                    && self.below.is_none_or(|limit| *value < limit)
            }
            (Value::Flag(value), Some(Expected::Flag(expected))) => value == expected,
            (Value::Flag(_), _) | (_, None | Some(Expected::Flag(_))) => false,
            (words, Some(Expected::Word(expected))) => words.words().contains(&expected.as_str()),
            (words, Some(Expected::OneOf(all))) => words.words().iter().any(|word| all.iter().any(|one| one == word)),
        }
    }
}

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
            Document::Bool(flag) => Ok(Self::Flag(flag)),
            Document::String(word) => Ok(Self::Word(word)),
            other => document::read(&other)
                .map(Self::OneOf)
                .map_err(|_| "expected `true`, `false`, a word or a list of words"),
        }
    }
}
