//! The contents of a file of settings, in no format.
//!
//! Types are read from a [`Document`] and written to one; only documents are read from TOML and JSON and written to them.
//! So a program has the code of each type once and that of each format once, and not that of each pair.

mod access;
mod error;
mod format;
mod json;
mod key;
mod omission;
mod read;
mod toml;
mod variant;
mod write;

pub use error::DocumentError;
pub(crate) use omission::{is_default, is_one};
use serde::{Deserialize, Serialize};

/// A value of a file, with all that it contains.
#[derive(Clone, Debug, PartialEq)]
pub enum Document {
    /// Nothing. TOML has no word for it, and leaves out the key.
    Null,
    /// Yes or no.
    Flag(bool),
    /// An integer.
    Integer(i64),
    /// An integer that is no `i64`.
    Large(i128),
    /// A number in single precision, which has fewer digits when it is written.
    Single(f32),
    /// A number.
    Number(f64),
    /// A text.
    Text(String),
    /// Values in order.
    List(Vec<Self>),
    /// Keys with their values, in the order of the file.
    Table(Vec<(String, Self)>),
}

impl Document {
    /// The value as a document.
    ///
    /// # Errors
    /// [`DocumentError`] where a key is not a word, or the value's type refuses.
    pub fn of<T: Serialize + ?Sized>(value: &T) -> Result<Self, DocumentError> {
        value.serialize(write::Writer)
    }

    /// Reads a value of a type.
    ///
    /// # Errors
    /// [`DocumentError`] with the path of the key and the reason.
    pub fn read<'de, T: Deserialize<'de>>(&'de self) -> Result<T, DocumentError> {
        T::deserialize(self)
    }

    /// A table of keys with their values.
    pub fn of_entries<K: Into<String>>(entries: impl IntoIterator<Item = (K, Self)>) -> Self {
        Self::Table(entries.into_iter().map(|(key, value)| (key.into(), value)).collect())
    }

    /// A list of numbers.
    pub fn of_numbers(numbers: impl IntoIterator<Item = f64>) -> Self {
        Self::List(numbers.into_iter().map(Self::Number).collect())
    }

    /// The value of a key. `None` if this is not a table or has no such key.
    pub fn get(&self, key: &str) -> Option<&Self> {
        let Self::Table(entries) = self else { return None };
        entries.iter().find(|(name, _)| name == key).map(|(_, value)| value)
    }

    /// Puts a value at a path of keys and places from 0 on, with dots between them; [`Self::Null`] takes an entry of a table away.
    /// Returns whether the path leads to a table, or to a place of a list.
    pub fn put(&mut self, path: &str, value: &Self) -> bool {
        let (first, rest) = path.split_once('.').map_or((path, None), |(first, rest)| (first, Some(rest)));
        let place = match self {
            Self::Table(entries) => {
                let place = entries.iter().position(|(key, _)| key == first);
                match (place, rest, value) {
                    (_, None, Self::Null) => {
                        entries.retain(|(key, _)| key != first);
                        return true;
                    }
                    (None, None, _) => {
                        entries.push((first.to_owned(), value.clone()));
                        return true;
                    }
                    _ => place.map(|place| &mut entries[place].1),
                }
            }
            Self::List(items) => first.parse().ok().and_then(|at: usize| items.get_mut(at)),
            _ => None,
        };
        match (place, rest) {
            (Some(place), Some(rest)) => place.put(rest, value),
            (Some(place), None) => {
                place.clone_from(value);
                true
            }
            (None, _) => false,
        }
    }

    /// The values of a table or a list, in order; empty for anything else.
    pub fn children(&self) -> impl Iterator<Item = &Self> {
        let (entries, values): (&[_], &[_]) = match self {
            Self::Table(entries) => (entries, &[]),
            Self::List(values) => (&[], values),
            _ => (&[], &[]),
        };
        entries.iter().map(|(_, value)| value).chain(values)
    }
}

impl From<&str> for Document {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl<T: Into<Document>> From<Option<T>> for Document {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Null, Into::into)
    }
}

#[cfg(test)]
mod tests;
