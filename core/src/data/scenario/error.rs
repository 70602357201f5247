//! Errors of scenarios.

use thiserror::Error;

use crate::data::document::DocumentError;

/// The reason why a scenario cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ScenarioError {
    /// The text is not a scenario: the message has the line, the key and the reason.
    #[error("{0}")]
    Syntax(String),
    /// A value is impossible.
    #[error("`{key}` is {value}, but must be {allowed}")]
    Value {
        /// The key's path in the file.
        key: String,
        /// The value.
        value: String,
        /// The allowed values.
        allowed: String,
    },
}

impl From<DocumentError> for ScenarioError {
    fn from(error: DocumentError) -> Self {
        Self::Syntax(error.to_string())
    }
}
