//! Documents as TOML.

use serde::Serialize;
use serde::de::{self, DeserializeOwned};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::Step;
use super::{Document, DocumentError};

impl Document {
    /// The document in a text of TOML.
    ///
    /// # Errors
    /// [`DocumentError`] where the text is not TOML, with the line, the column and the text there.
    pub fn from_toml(text: &str) -> Result<Self, DocumentError> {
        toml::from_str(text).map_err(|error| DocumentError::new(error.to_string().trim_end().to_owned()))
    }

    /// Reads a value from a text of TOML.
    ///
    /// # Errors
    /// As [`Self::from_toml`], and [`DocumentError`] where it is not a value of this type: with the line, the path of the
    /// key and the reason.
    pub fn read_toml<T: DeserializeOwned>(text: &str) -> Result<T, DocumentError> {
        Self::from_toml(text)?.read().map_err(|error: DocumentError| error.in_toml(text))
    }

    /// The text of a value as TOML. Tables come after other values, so that each has a header.
    ///
    /// # Errors
    /// As [`Self::table`].
    pub fn toml<T: Serialize + ?Sized>(value: &T) -> Result<String, DocumentError> {
        toml::to_string(&Self::table(value)?).map_err(de::Error::custom)
    }

    /// A value as a table of TOML, to be changed or written.
    ///
    /// # Errors
    /// As [`Self::of`], and [`DocumentError`] where TOML cannot express the value.
    pub fn table<T: Serialize + ?Sized>(value: &T) -> Result<toml::Table, DocumentError> {
        toml::Table::try_from(Self::of(value)?).map_err(de::Error::custom)
    }
}

impl DocumentError {
    /// The error with its line in the text of TOML that the document was read from.
    #[must_use]
    pub fn in_toml(self, text: &str) -> Self {
        match DeTable::parse(text) {
            Ok(root) => {
                let start = start(root, self.path());
                let line = 1 + text.bytes().take(start).filter(|&byte| byte == b'\n').count();
                self.at_line(line)
            }
            Err(_) => self,
        }
    }
}

/// The place in the text at which the last existing key of a path begins.
fn start<'a>(root: Spanned<DeTable<'_>>, path: impl Iterator<Item = &'a Step>) -> usize {
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
