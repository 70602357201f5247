//! The saved state of the lessons: the place of the bookmark, and the finished ones.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use crate::request::Answer;

/// The user's progress in the lessons. Each is known by its title.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Studies {
    /// The place in the current lesson.
    pub(crate) bookmark: Option<Bookmark>,
    /// The titles of the finished lessons.
    pub(crate) finished: BTreeSet<String>,
}

/// A place in a lesson.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Bookmark {
    /// The lesson's title.
    pub(crate) lesson: String,
    /// The step, from 0 on.
    pub(crate) step: usize,
    /// Whether the step's change is made.
    pub(crate) changed: bool,
    /// The answer to the step's question.
    #[serde(default)]
    pub(crate) answer: Option<Answer>,
}
