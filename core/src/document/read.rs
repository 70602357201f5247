//! Reads types from a document, and notes the path to what cannot be read.

use std::slice;

use serde::de::{
    self, DeserializeSeed, Deserializer, EnumAccess, Expected, IntoDeserializer, MapAccess, SeqAccess, Unexpected,
    VariantAccess, Visitor,
};

use super::key::Key;
use super::{Document, DocumentError};

type Entry = (String, Document);

impl Document {
    /// The error for a value of another type.
    #[inline(never)]
    fn mismatch(&self, expected: &dyn Expected) -> DocumentError {
        de::Error::invalid_type(self.unexpected(), expected)
    }

    fn unexpected(&self) -> Unexpected<'_> {
        match self {
            Self::Null => Unexpected::Other("null"),
            Self::Flag(value) => Unexpected::Bool(*value),
            Self::Integer(value) => Unexpected::Signed(*value),
            Self::Large(value) => match u64::try_from(*value) {
                Ok(value) => Unexpected::Unsigned(value),
                Err(_) => Unexpected::Other("a large integer"),
            },
            Self::Single(value) => Unexpected::Float(f64::from(*value)),
            Self::Number(value) => Unexpected::Float(*value),
            Self::Text(value) => Unexpected::Str(value),
            Self::List(_) => Unexpected::Seq,
            Self::Table(_) => Unexpected::Map,
        }
    }
}

fn list<'de, V: Visitor<'de>>(values: &'de [Document], visitor: V) -> Result<V::Value, DocumentError> {
    let mut elements = Elements { rest: values.iter(), place: 0 };
    let value = visitor.visit_seq(&mut elements)?;
    elements.end()?;
    Ok(value)
}

fn integer<'de, V: Visitor<'de>>(document: &'de Document, visitor: V) -> Result<V::Value, DocumentError> {
    match document {
        Document::Integer(value) => visitor.visit_i64(*value),
        Document::Large(value) => match u64::try_from(*value) {
            Ok(value) => visitor.visit_u64(value),
            Err(_) => visitor.visit_i128(*value),
        },
        other => Err(other.mismatch(&visitor)),
    }
}

fn number<'de, V: Visitor<'de>>(document: &'de Document, visitor: V) -> Result<V::Value, DocumentError> {
    match document {
        Document::Number(value) => visitor.visit_f64(*value),
        Document::Single(value) => visitor.visit_f32(*value),
        _ => integer(document, visitor),
    }
}

fn text<'de, V: Visitor<'de>>(document: &'de Document, visitor: V) -> Result<V::Value, DocumentError> {
    match document {
        Document::Text(value) => visitor.visit_str(value),
        other => Err(other.mismatch(&visitor)),
    }
}

fn sequence<'de, V: Visitor<'de>>(document: &'de Document, visitor: V) -> Result<V::Value, DocumentError> {
    match document {
        Document::List(values) => list(values, visitor),
        other => Err(other.mismatch(&visitor)),
    }
}

/// Types whose values look alike in a file.
macro_rules! alike {
    ($($method:ident $(($($name:ident: $argument:ty),*))? $by:ident)*) => {$(
        fn $method<V: Visitor<'de>>(self, $($($name: $argument,)*)? visitor: V) -> Result<V::Value, DocumentError> {
            $($(let _ = $name;)*)?
            $by(self, visitor)
        }
    )*};
}

impl<'de> Deserializer<'de> for &'de Document {
    type Error = DocumentError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DocumentError> {
        match self {
            Document::Null => visitor.visit_unit(),
            Document::Flag(value) => visitor.visit_bool(*value),
            Document::Text(value) => visitor.visit_str(value),
            Document::List(values) => list(values, visitor),
            Document::Table(entries) => visitor.visit_map(Entries::of(entries)),
            _ => number(self, visitor),
        }
    }

    alike! {
        deserialize_i8 integer
        deserialize_i16 integer
        deserialize_i32 integer
        deserialize_i64 integer
        deserialize_i128 integer
        deserialize_u8 integer
        deserialize_u16 integer
        deserialize_u32 integer
        deserialize_u64 integer
        deserialize_u128 integer
        deserialize_f32 number
        deserialize_f64 number
        deserialize_char text
        deserialize_str text
        deserialize_string text
        deserialize_identifier text
        deserialize_bytes sequence
        deserialize_byte_buf sequence
        deserialize_seq sequence
        deserialize_tuple(len: usize) sequence
        deserialize_tuple_struct(name: &'static str, len: usize) sequence
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DocumentError> {
        match self {
            Document::Flag(value) => visitor.visit_bool(*value),
            other => Err(other.mismatch(&visitor)),
        }
    }

    fn deserialize_unit<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DocumentError> {
        match self {
            Document::Null => visitor.visit_unit(),
            other => Err(other.mismatch(&visitor)),
        }
    }

    fn deserialize_unit_struct<V: Visitor<'de>>(self, _: &'static str, visitor: V) -> Result<V::Value, DocumentError> {
        self.deserialize_unit(visitor)
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DocumentError> {
        match self {
            Document::Null => visitor.visit_none(),
            some => visitor.visit_some(some),
        }
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, DocumentError> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_map<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DocumentError> {
        match self {
            Document::Table(entries) => visitor.visit_map(Entries::of(entries)),
            other => Err(other.mismatch(&visitor)),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, DocumentError> {
        match self {
            Document::List(values) => list(values, visitor),
            _ => self.deserialize_map(visitor),
        }
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, DocumentError> {
        match self {
            Document::Text(name) => visitor.visit_enum(name.as_str().into_deserializer()),
            Document::Table(entries) => match entries.as_slice() {
                [entry] => visitor.visit_enum(Variant(entry)),
                _ => Err(de::Error::invalid_value(Unexpected::Map, &"a table with exactly one key")),
            },
            other => Err(other.mismatch(&"a word, or a table with exactly one key")),
        }
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DocumentError> {
        visitor.visit_unit()
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

struct Entries<'de> {
    rest: slice::Iter<'de, Entry>,
    /// The entry whose key was read last.
    current: Option<&'de Entry>,
}

impl<'de> Entries<'de> {
    fn of(entries: &'de [Entry]) -> Self {
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

/// A variant with contents: a table of one key.
struct Variant<'de>(&'de Entry);

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
            other => sequence(other, visitor),
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
