//! The expected values of measures.

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
