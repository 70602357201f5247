//! The contents of a file of settings, in no format.
//!
//! Types are read from a [`Document`] and written to one; only documents are read from TOML and JSON and written to them.
//! So a program has the code of each type once and that of each format once, and not that of each pair.

mod error;

pub use error::DocumentError;
pub(crate) use error::not_finite;
use serde::Serialize;
use serde::de::DeserializeOwned;
pub use serde_json::{Value as Document, json};

/// The value as a document. Numbers that are not finite become null.
///
/// # Errors
/// [`DocumentError`] where a key is not a word or a number, or the value's type refuses.
pub fn of<T: Serialize + ?Sized>(value: &T) -> Result<Document, DocumentError> {
    Ok(serde_json::to_value(value)?)
}

/// Reads a value of a type.
///
/// # Errors
/// [`DocumentError`] with the path of the key and the reason.
pub fn read<T: DeserializeOwned>(document: &Document) -> Result<T, DocumentError> {
    Ok(serde_path_to_error::deserialize(document)?)
}

/// The document in a text of JSON.
///
/// # Errors
/// [`DocumentError`] where the text is not JSON.
pub fn from_json(text: &str) -> Result<Document, DocumentError> {
    Ok(serde_json::from_str(text)?)
}

/// Reads a value from a text of JSON.
///
/// # Errors
/// [`DocumentError`] where the text is not JSON, or not a value of this type.
pub fn read_json<T: DeserializeOwned>(text: &str) -> Result<T, DocumentError> {
    read(&from_json(text)?)
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
    let document = toml::from_str(text).map_err(|error| DocumentError::new(error.to_string().trim_end()))?;
    match not_finite(&document) {
        Some(error) => Err(error.in_toml(text)),
        None => Ok(document),
    }
}

/// Reads a value from a text of TOML.
///
/// # Errors
/// As [`from_toml`], and [`DocumentError`] where it is not a value of this type: with the line, the path of the key and the
/// reason.
pub fn read_toml<T: DeserializeOwned>(text: &str) -> Result<T, DocumentError> {
    read(&from_toml(text)?).map_err(|error| error.in_toml(text))
}

/// The text of a value as TOML. Tables come after other values, so that each has a header.
///
/// # Errors
/// As [`to_table`].
pub fn to_toml<T: Serialize + ?Sized>(value: &T) -> Result<String, DocumentError> {
    toml::to_string(&to_table(value)?).map_err(DocumentError::new)
}

/// A value as a table of TOML, to be changed or written. TOML has no word for null, whose key is left out.
///
/// # Errors
/// As [`of`], and [`DocumentError`] where TOML cannot express the value.
pub fn to_table<T: Serialize + ?Sized>(value: &T) -> Result<toml::Table, DocumentError> {
    let mut document = of(value)?;
    leave_out_nulls(&mut document);
    toml::Table::try_from(document).map_err(DocumentError::new)
}

fn leave_out_nulls(document: &mut Document) {
    match document {
        Document::Object(entries) => {
            entries.retain(|_, value| !value.is_null());
            entries.values_mut().for_each(leave_out_nulls);
        }
        Document::Array(values) => values.iter_mut().for_each(leave_out_nulls),
        _ => {}
    }
}

/// Puts a value at a path of keys and places from 0 on, with dots between them; null takes an entry of a table away. Returns
/// whether the path leads to a table, or to a place of a list.
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

/// Whether a setting has its default, and need not be written.
pub(crate) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// Whether a number is one, and need not be written.
pub(crate) fn is_one<T: From<u8> + PartialEq>(number: &T) -> bool {
    *number == T::from(1)
}

#[cfg(test)]
mod tests;
