//! The elements of a list and the entries of a table, one after the other.

use std::slice;

use serde::de::{self, DeserializeSeed, MapAccess, SeqAccess, Visitor};

use super::key::Key;
use super::{Document, DocumentError};

pub(super) type Entry = (String, Document);

pub(super) fn list<'de, V: Visitor<'de>>(values: &'de [Document], visitor: V) -> Result<V::Value, DocumentError> {
    let mut elements = Elements { rest: values.iter(), place: 0 };
    let value = visitor.visit_seq(&mut elements)?;
    elements.end()?;
    Ok(value)
}

pub(super) fn sequence<'de, V: Visitor<'de>>(document: &'de Document, visitor: V) -> Result<V::Value, DocumentError> {
    match document {
        Document::List(values) => list(values, visitor),
        other => Err(other.mismatch(&visitor)),
    }
}

struct Elements<'de> {
    rest: slice::Iter<'de, Document>,
    place: usize,
}

impl Elements<'_> {
    /// The error where elements are left.
    fn end(self) -> Result<(), DocumentError> {
        match self.rest.len() {
            0 => Ok(()),
            left => Err(de::Error::invalid_length(self.place + left, &"fewer elements")),
        }
    }
}

impl<'de> SeqAccess<'de> for &mut Elements<'de> {
    type Error = DocumentError;

    fn next_element_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<Option<T::Value>, DocumentError> {
        let Some(element) = self.rest.next() else { return Ok(None) };
        let place = self.place;
        self.place += 1;
        seed.deserialize(element).map(Some).map_err(|error| error.at_element(place))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.rest.len())
    }
}

pub(super) struct Entries<'de> {
    rest: slice::Iter<'de, Entry>,
    /// The entry of the key that was read last.
    current: Option<&'de Entry>,
}

impl<'de> Entries<'de> {
    pub(super) fn of(entries: &'de [Entry]) -> Self {
        Self { rest: entries.iter(), current: None }
    }
}

impl<'de> MapAccess<'de> for Entries<'de> {
    type Error = DocumentError;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, DocumentError> {
        self.current = self.rest.next();
        let Some((key, _)) = self.current else { return Ok(None) };
        seed.deserialize(Key(key)).map(Some).map_err(|error| error.at_key(key))
    }

    fn next_value_seed<T: DeserializeSeed<'de>>(&mut self, seed: T) -> Result<T::Value, DocumentError> {
        let Some((key, value)) = self.current else { return Err(de::Error::custom("a value without a key")) };
        seed.deserialize(value).map_err(|error| error.at_key(key))
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.rest.len())
    }
}
