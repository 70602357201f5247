//! The reason why a document cannot be read or written.

use std::fmt;

use serde::{de, ser};

/// The reason, the path of the key and, for a text of TOML, the line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DocumentError(Box<Fault>);

#[derive(Clone, Debug, PartialEq, Eq)]
struct Fault {
    reason: String,
    /// From the innermost step to the outermost one.
    path: Vec<Step>,
    line: Option<usize>,
}

/// A step from a value to one inside it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// To the value of a key.
    Key(String),
    /// To an element of a list, counted from 0.
    Element(usize),
}

impl DocumentError {
    pub(super) fn new(reason: String) -> Self {
        Self(Box::new(Fault { reason, path: Vec::new(), line: None }))
    }

    /// The same error, as seen from one step further out.
    #[inline(never)]
    pub(crate) fn at_key(mut self, key: &str) -> Self {
        self.0.path.push(Step::Key(key.to_owned()));
        self
    }

    /// The same error, as seen from one step further out.
    #[inline(never)]
    pub(super) fn at_element(mut self, place: usize) -> Self {
        self.0.path.push(Step::Element(place));
        self
    }

    pub(super) fn at_line(mut self, line: usize) -> Self {
        self.0.line = Some(line);
        self
    }

    /// From the outermost step to the innermost one.
    pub(super) fn path(&self) -> impl Iterator<Item = &Step> {
        self.0.path.iter().rev()
    }
}

impl fmt::Display for DocumentError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Fault { reason, path, line } = &*self.0;
        if let Some(line) = line {
            write!(f, "line {line}: ")?;
        }
        let mut keys = String::new();
        for step in self.path() {
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

impl de::Error for DocumentError {
    fn custom<T: fmt::Display>(reason: T) -> Self {
        Self::new(reason.to_string())
    }
}

impl ser::Error for DocumentError {
    fn custom<T: fmt::Display>(reason: T) -> Self {
        Self::new(reason.to_string())
    }
}
