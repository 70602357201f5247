//! Reads the variants of an enum that have contents.

use serde::de::{self, DeserializeSeed, EnumAccess, VariantAccess, Visitor};

use super::access::{Entries, Entry, sequence};
use super::key::Key;
use super::{Document, DocumentError};

/// A variant with contents: a table of one key.
pub(super) struct Variant<'de>(pub(super) &'de Entry);

impl<'de> EnumAccess<'de> for Variant<'de> {
    type Error = DocumentError;
    type Variant = Self;

    fn variant_seed<K: DeserializeSeed<'de>>(self, seed: K) -> Result<(K::Value, Self), DocumentError> {
        let name = seed.deserialize(Key(&self.0.0)).map_err(|error| error.at_key(&self.0.0))?;
        Ok((name, self))
    }
}

impl<'de> Variant<'de> {
    fn within<T>(&self, result: Result<T, DocumentError>) -> Result<T, DocumentError> {
        result.map_err(|error| error.at_key(&self.0.0))
    }
}

impl<'de> VariantAccess<'de> for Variant<'de> {
    type Error = DocumentError;

    fn unit_variant(self) -> Result<(), DocumentError> {
        let is_empty = match &self.0.1 {
            Document::Null => true,
            Document::List(values) => values.is_empty(),
            Document::Table(entries) => entries.is_empty(),
            _ => false,
        };
        if is_empty { Ok(()) } else { self.within(Err(self.0.1.mismatch(&"an empty table"))) }
    }

    fn newtype_variant_seed<T: DeserializeSeed<'de>>(self, seed: T) -> Result<T::Value, DocumentError> {
        self.within(seed.deserialize(&self.0.1))
    }

    fn tuple_variant<V: Visitor<'de>>(self, _: usize, visitor: V) -> Result<V::Value, DocumentError> {
        self.within(sequence(&self.0.1, visitor))
    }

    fn struct_variant<V: Visitor<'de>>(
        self,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, DocumentError> {
        self.within(match &self.0.1 {
            Document::Table(entries) => known(entries, fields).and_then(|()| visitor.visit_map(Entries::of(entries))),
            other => Err(other.mismatch(&visitor)),
        })
    }
}

/// Checks that a table has no keys but these.
fn known(entries: &[Entry], fields: &'static [&'static str]) -> Result<(), DocumentError> {
    match entries.iter().find(|(key, _)| !fields.contains(&key.as_str())) {
        None => Ok(()),
        Some((key, _)) => Err(<DocumentError as de::Error>::unknown_field(key, fields).at_key(key)),
    }
}
