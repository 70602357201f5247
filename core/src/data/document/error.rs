//! The reason why a document cannot be read or written.

use std::fmt;

use serde_path_to_error::Segment;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::Document;

/// The reason, the path of the key and, for a text of TOML, the line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DocumentError(Box<Fault>);

#[derive(Clone, Debug, PartialEq, Eq)]
struct Fault {
    reason: String,
    path: Vec<Step>,
    line: Option<usize>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Step {
    Key(String),
    /// Counted from 0.
    Element(usize),
}

impl DocumentError {
    pub(crate) fn new(reason: impl fmt::Display) -> Self {
        Self(Box::new(Fault { reason: reason.to_string(), path: Vec::new(), line: None }))
    }

    /// The same error, as seen from one step further out.
    pub(crate) fn at_key(mut self, key: &str) -> Self {
        self.0.path.insert(0, Step::Key(key.to_owned()));
        self
    }

    /// The error with its line in the text of TOML that the document was read from: that of the last key of its path that the text has.
    #[must_use]
    pub fn in_toml(mut self, text: &str) -> Self {
        if let Ok(root) = DeTable::parse(text) {
            let before = &text.as_bytes()[..start(root, &self.0.path)];
            self.0.line = Some(1 + before.iter().filter(|&&byte| byte == b'\n').count());
        }
        self
    }
}

/// The place in the text at which the last existing key of a path begins.
fn start(root: Spanned<DeTable<'_>>, path: &[Step]) -> usize {
    let mut start = root.span().start;
    let root = DeValue::Table(root.into_inner());
    let mut value = &root;
    for step in path {
        let next = match (step, value) {
            (Step::Key(key), DeValue::Table(table)) => {
                table.iter().find(|(name, _)| name.get_ref() == key).map(|(name, value)| (name.span(), value))
            }
            (Step::Element(place), DeValue::Array(array)) => array.get(*place).map(|value| (value.span(), value)),
            _ => None,
        };
        let Some((span, inner)) = next else { break };
        (start, value) = (span.start, inner.get_ref());
    }
    start
}

/// The error for the first null of a document from TOML, which has no null: there stands a number that is not finite.
pub(crate) fn not_finite(document: &Document) -> Option<DocumentError> {
    let at = |step, inner| {
        let mut error = not_finite(inner)?;
        error.0.path.insert(0, step);
        Some(error)
    };
    match document {
        Document::Null => Some(DocumentError::new("must be a finite number")),
        Document::Object(entries) => entries.iter().find_map(|(key, inner)| at(Step::Key(key.clone()), inner)),
        Document::Array(values) => values.iter().enumerate().find_map(|(place, inner)| at(Step::Element(place), inner)),
        _ => None,
    }
}

impl fmt::Display for DocumentError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Fault { reason, path, line } = &*self.0;
        if let Some(line) = line {
            write!(f, "line {line}: ")?;
        }
        let mut keys = String::new();
        for step in path {
            match step {
                Step::Key(key) if keys.is_empty() => keys.push_str(key),
                Step::Key(key) => keys += &format!(".{key}"),
                Step::Element(place) => keys += &format!("[{place}]"),
            }
        }
        match (path.is_empty(), line) {
            (false, _) => write!(f, "`{keys}`: {reason}"),
            (true, Some(_)) => write!(f, "`.`: {reason}"),
            (true, None) => f.write_str(reason),
        }
    }
}

impl std::error::Error for DocumentError {}

impl From<serde_json::Error> for DocumentError {
    fn from(error: serde_json::Error) -> Self {
        Self::new(error)
    }
}

impl From<serde_path_to_error::Error<serde_json::Error>> for DocumentError {
    fn from(error: serde_path_to_error::Error<serde_json::Error>) -> Self {
        let steps = error.path().iter().filter_map(|segment| match segment {
            Segment::Seq { index } => Some(Step::Element(*index)),
            Segment::Map { key } | Segment::Enum { variant: key } => Some(Step::Key(key.clone())),
            Segment::Unknown => None,
        });
        let path = steps.collect();
        let reason = error.into_inner().to_string();
        let reason = reason.replace("string or map", "a word, or a table with exactly one key");
        let reason = reason.replace("map with a single key", "a table with exactly one key");
        Self(Box::new(Fault { reason, path, line: None }))
    }
}
