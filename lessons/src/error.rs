//! What can be wrong with a lesson.

use kalmanscope_core::{Quantity, RunError, ScenarioError};
use thiserror::Error;

/// Why a lesson cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum LessonError {
    /// The text is not a lesson: the message has line and key.
    #[error("{0}")]
    Syntax(String),
    /// The lesson begins with a scenario that does not come with the program.
    #[error("there is no built-in scenario `{0}`")]
    UnknownScenario(String),
    /// A change sets what is not there.
    #[error("the scenario has no setting `{0}`")]
    UnknownPath(String),
    /// A change or a check is about a filter that is not there.
    #[error("the scenario has no filter `{0}`")]
    UnknownFilter(String),
    /// A change adds a filter without a name, or with that of another.
    #[error("a filter is added as `{0}`, but must have a name that no other has")]
    AmbiguousFilter(String),
    /// A change or a check is about a sensor that is not there.
    #[error("the scenario has no sensor for {}", .0.key())]
    UnknownSensor(Quantity),
    /// A check does not say what its measure needs to know, or how large it may be.
    #[error("the check of `{measure}` {trouble}")]
    Check {
        /// The measure's key.
        measure: String,
        /// What is wrong.
        trouble: String,
    },
    /// The scenario that comes of it is impossible.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The scenario cannot be run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// As any of the others, with the step.
    #[error("step {number}: {error}")]
    Step {
        /// The step's number, from 1 on.
        number: usize,
        /// What is wrong there.
        error: Box<LessonError>,
    },
}

impl LessonError {
    /// The error with its step, counted from 0.
    pub(crate) fn in_step(self, step: usize) -> Self {
        Self::Step { number: step + 1, error: Box::new(self) }
    }
}
