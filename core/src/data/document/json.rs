//! Documents as JSON.

use serde::{Deserialize, Serialize, de};

use super::{Document, DocumentError};

impl Document {
    /// The document in a text of JSON.
    ///
    /// # Errors
    /// [`DocumentError`] where the text is not JSON.
    pub fn from_json(text: &str) -> Result<Self, DocumentError> {
        serde_json::from_str(text).map_err(de::Error::custom)
    }

    /// The text of a value as JSON, in one line. Numbers that are not finite are `null`.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub fn json<T: Serialize + ?Sized>(value: &T) -> Result<String, DocumentError> {
        serde_json::to_string(&Self::of(value)?).map_err(de::Error::custom)
    }

    /// As [`Self::json`], with a line for each key and each element.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub fn json_lines<T: Serialize + ?Sized>(value: &T) -> Result<String, DocumentError> {
        serde_json::to_string_pretty(&Self::of(value)?).map_err(de::Error::custom)
    }

    /// Reads a value from a text of JSON.
    ///
    /// # Errors
    /// [`DocumentError`] where the text is not JSON, or not a value of this type.
    pub fn read_json<T: for<'de> Deserialize<'de>>(text: &str) -> Result<T, DocumentError> {
        Self::from_json(text)?.read()
    }
}
