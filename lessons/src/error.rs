//! Errors of lessons.

use kalmanscope_core::document::DocumentError;
use kalmanscope_core::setting::UnknownSetting;
use kalmanscope_core::{Quantity, RunError, ScenarioError};
use thiserror::Error;

/// The reason why a lesson cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum LessonError {
    /// The text is not a lesson: the message has line and key.
    #[error("{0}")]
    Syntax(String),
    /// The lesson begins with a scenario that is not built in.
    #[error("there is no built-in scenario `{0}`")]
    UnknownScenario(String),
    /// An axis varies something that the scenario lacks.
    #[error(transparent)]
    Setting(#[from] UnknownSetting),
    /// A change or a check names a filter that the scenario lacks.
    #[error("the scenario has no filter `{0}`")]
    UnknownFilter(String),
    /// A change adds a filter without a name, or with the name of another.
    #[error("a filter is added as `{0}`, but must have a name that no other has")]
    AmbiguousFilter(String),
    /// A change or a check names a sensor that the scenario lacks.
    #[error("the scenario has no sensor for {}", .0.key())]
    UnknownSensor(Quantity),
    /// An axis of a map or of a check's cells is none.
    #[error("`{0}` is not an axis: write KEY=FROM:TO:COUNT with 2 to 256 values, and :log for equal ratios")]
    Axis(String),
    /// A check lacks a setting or a limit.
    #[error("the check of `{measure}` {trouble}")]
    Check {
        /// The measure's key.
        measure: String,
        /// The problem.
        trouble: String,
    },
    /// A question lacks something, or its answer is none of its choices.
    #[error("the question {0}")]
    Question(String),
    /// A picture shows what its lesson lacks.
    #[error("the picture needs a {0} that the lesson lacks")]
    Picture(&'static str),
    /// A record is not built in.
    #[error("the record `{0}` does not come along")]
    UnknownRecord(String),
    /// A record cannot be used.
    #[error("the record `{file}`: {reason}")]
    Record {
        /// The file's name.
        file: String,
        /// The reason.
        reason: String,
    },
    /// The button of a change has no text.
    #[error("the change has no `label`")]
    NoLabel,
    /// The lesson has no step.
    #[error("the lesson has no step")]
    NoStep,
    /// The changed scenario is impossible.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The scenario cannot be run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// Another error, with its step.
    #[error("step {number}: {error}")]
    Step {
        /// The step's number, from 1 on.
        number: usize,
        /// The error.
        error: Box<LessonError>,
    },
}

impl From<DocumentError> for LessonError {
    fn from(error: DocumentError) -> Self {
        Self::Syntax(error.to_string())
    }
}

impl LessonError {
    /// The error with its step, counted from 0.
    pub(crate) fn in_step(self, step: usize) -> Self {
        Self::Step { number: step + 1, error: Box::new(self) }
    }
}
