//! The saved state of the lessons: the place of the bookmark, and the finished ones.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use crate::request::Answer;

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Studies {
    pub(crate) bookmark: Option<Bookmark>,
    pub(crate) finished: BTreeSet<String>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Bookmark {
    pub(crate) lesson: String,
    pub(crate) step: usize,
    pub(crate) changed: bool,
    #[serde(default)]
    pub(crate) answer: Option<Answer>,
}
