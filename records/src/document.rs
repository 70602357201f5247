//! The contents of a file of settings, in no format.
//!
//! Only a [`Document`] is read from TOML and JSON: a program has the code of each type and of each format once, not that of each pair.

use std::fmt;

use serde::Serialize;
use serde::de::DeserializeOwned;
pub use serde_json::{Value as Document, json};
use serde_path_to_error::Segment;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The value as a document. Numbers that are not finite become null.
///
/// # Errors
/// [`DocumentError`] where a key is not a word or a number, or the value's type refuses.
pub fn of<T: Serialize + ?Sized>(value: &T) -> Result<Document, DocumentError> {
    serde_json::to_value(value).map_err(DocumentError::new)
}

/// Reads a value of a type. Keys of channels are those of [`kalmanscope_filters::Channel::all`].
///
/// # Errors
/// [`DocumentError`] with the path of the key and the reason.
pub fn read<T: DeserializeOwned>(document: &Document) -> Result<T, DocumentError> {
    serde_path_to_error::deserialize(document).map_err(at_path)
}

/// The document in a text of JSON.
///
/// # Errors
/// [`DocumentError`] where the text is not JSON.
pub fn from_json(text: &str) -> Result<Document, DocumentError> {
    serde_json::from_str(text).map_err(DocumentError::new)
}

/// The text of a value as JSON, in one line.
///
/// # Errors
/// As [`of`].
pub fn to_json<T: Serialize + ?Sized>(value: &T) -> Result<String, DocumentError> {
    Ok(of(value)?.to_string())
}

/// As [`to_json`], with a line for each key and each element.
///
/// # Errors
/// As [`of`].
pub fn to_json_lines<T: Serialize + ?Sized>(value: &T) -> Result<String, DocumentError> {
    Ok(format!("{:#}", of(value)?))
}

/// The document in a text of TOML.
///
/// # Errors
/// [`DocumentError`] where the text is not TOML, with the line, the column and the text there, or has a number that is not finite.
pub fn from_toml(text: &str) -> Result<Document, DocumentError> {
    let table = text.parse().map_err(|error: toml::de::Error| DocumentError::new(error.to_string().trim_end()))?;
    let document = of_toml(toml::Value::Table(table));
    not_finite(&document).map_or(Ok(document), |error| Err(error.in_toml(text)))
}

/// The text of a value as TOML. Tables come after other values, so that each has a header.
///
/// # Errors
/// As [`to_table`].
pub fn to_toml<T: Serialize + ?Sized>(value: &T) -> Result<String, DocumentError> {
    Ok(to_table(value)?.to_string())
}

/// A value as a table of TOML, to be changed or written. TOML has no word for null, whose key is left out.
///
/// # Errors
/// As [`of`], and [`DocumentError`] where TOML cannot express the value.
pub fn to_table<T: Serialize + ?Sized>(value: &T) -> Result<toml::Table, DocumentError> {
    match in_toml(of(value)?)? {
        Some(toml::Value::Table(table)) => Ok(table),
        _ => Err(DocumentError::new("is not a table")),
    }
}

// Both ways between values of TOML and of JSON are written out: by serde they would be ten times the code, and integers
// above 2⁶³, which TOML has not, would be read.
fn of_toml(value: toml::Value) -> Document {
    match value {
        toml::Value::String(text) => text.into(),
        toml::Value::Integer(number) => number.into(),
        toml::Value::Float(number) => number.into(),
        toml::Value::Boolean(flag) => flag.into(),
        toml::Value::Datetime(time) => time.to_string().into(),
        toml::Value::Array(values) => Document::Array(values.into_iter().map(of_toml).collect()),
        toml::Value::Table(entries) => {
            Document::Object(entries.into_iter().map(|(key, value)| (key, of_toml(value))).collect())
        }
    }
}

fn in_toml(document: Document) -> Result<Option<toml::Value>, DocumentError> {
    Ok(Some(match document {
        Document::Null => return Ok(None),
        Document::Bool(flag) => flag.into(),
        Document::String(text) => text.into(),
        Document::Number(number) => match (number.as_i64(), number.as_f64()) {
            (Some(whole), _) => whole.into(),
            (None, Some(float)) if number.is_f64() => float.into(),
            _ => return Err(DocumentError::new(format!("TOML has no integer as large as {number}"))),
        },
        Document::Array(values) => {
            let no_null = || DocumentError::new("a list of TOML cannot hold null");
            toml::Value::Array(
                values.into_iter().map(|value| in_toml(value)?.ok_or_else(no_null)).collect::<Result<_, _>>()?,
            )
        }
        Document::Object(entries) => {
            let entry = |(key, value)| Some((key, in_toml(value).transpose()?));
            let entries = entries.into_iter().filter_map(entry).map(|(key, value)| Ok((key, value?)));
            toml::Value::Table(entries.collect::<Result<_, DocumentError>>()?)
        }
    }))
}

/// Puts a value at a path of keys and places from 0 on, joined by dots; null removes an entry. Returns whether there is such a path.
pub fn put(document: &mut Document, path: &str, value: &Document) -> bool {
    let (outer, last) = path.rsplit_once('.').unwrap_or(("", path));
    let pointer: String =
        outer.split_terminator('.').map(|key| format!("/{}", key.replace('~', "~0").replace('/', "~1"))).collect();
    match document.pointer_mut(&pointer) {
        Some(Document::Object(entries)) => {
            match value {
                Document::Null => entries.shift_remove(last),
                value => entries.insert(last.to_owned(), value.clone()),
            };
            true
        }
        Some(Document::Array(items)) => {
            let place = last.parse().ok().and_then(|place: usize| items.get_mut(place));
            place.map(|item| item.clone_from(value)).is_some()
        }
        _ => false,
    }
}

/// Whether a value is the default, which files leave out.
pub fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// Whether a number is one.
pub fn is_one<T: From<u8> + PartialEq>(number: &T) -> bool {
    *number == T::from(1)
}

/// The reason why a document cannot be read or written, the path of the key and, for a text of TOML, the line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DocumentError {
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
    /// An error without a place in the text.
    pub fn new(reason: impl fmt::Display) -> Self {
        Self { reason: reason.to_string(), path: Vec::new(), line: None }
    }

    fn within(mut self, step: Step) -> Self {
        self.path.insert(0, step);
        self
    }

    /// The error with its line in the text of TOML that the document was read from: that of the last key of its path that the text has.
    #[must_use]
    pub fn in_toml(mut self, text: &str) -> Self {
        if let Ok(root) = DeTable::parse(text) {
            let before = &text.as_bytes()[..start(root, &self.path)];
            self.line = Some(1 + before.iter().filter(|&&byte| byte == b'\n').count());
        }
        self
    }
}

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
pub fn not_finite(document: &Document) -> Option<DocumentError> {
    let at = |step, inner| Some(not_finite(inner)?.within(step));
    match document {
        Document::Null => Some(DocumentError::new("must be a finite number")),
        Document::Object(entries) => entries.iter().find_map(|(key, inner)| at(Step::Key(key.clone()), inner)),
        Document::Array(values) => values.iter().enumerate().find_map(|(place, inner)| at(Step::Element(place), inner)),
        _ => None,
    }
}

impl fmt::Display for DocumentError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { reason, path, line } = self;
        if let Some(line) = line {
            write!(f, "line {line}: ")?;
        }
        let step = |step: &Step| match step {
            Step::Key(key) => format!(".{key}"),
            Step::Element(place) => format!("[{place}]"),
        };
        let keys: String = path.iter().map(step).collect();
        let keys = keys.strip_prefix('.').unwrap_or(&keys);
        match (path.is_empty(), line) {
            (false, _) => write!(f, "`{keys}`: {reason}"),
            (true, Some(_)) => write!(f, "`.`: {reason}"),
            (true, None) => f.write_str(reason),
        }
    }
}

impl std::error::Error for DocumentError {}

fn at_path(error: serde_path_to_error::Error<serde_json::Error>) -> DocumentError {
    let steps = error.path().iter().filter_map(|segment| match segment {
        Segment::Seq { index } => Some(Step::Element(*index)),
        Segment::Map { key } | Segment::Enum { variant: key } => Some(Step::Key(key.clone())),
        Segment::Unknown => None,
    });
    let path = steps.collect();
    let reason = error.into_inner().to_string();
    let reason = reason.replace("string or map", "a word, or a table with exactly one key");
    let reason = reason.replace("map with a single key", "a table with exactly one key");
    DocumentError { reason, path, line: None }
}
