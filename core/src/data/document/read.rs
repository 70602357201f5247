//! Reads types from a document, and notes the path to an unreadable value.

use serde::de::{self, Deserializer, Expected, IntoDeserializer, Unexpected, Visitor};

use super::access::{Entries, list, sequence};
use super::variant::Variant;
use super::{Document, DocumentError};

impl Document {
    /// The error for a value of another type.
    #[inline(never)]
    pub(crate) fn mismatch(&self, expected: &dyn Expected) -> DocumentError {
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

/// Types that look alike in a file.
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

    /// Refuses a list in place of a table: reading one would add 20 kB to a page, and its numbers would have no names.
    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, DocumentError> {
        self.deserialize_map(visitor)
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
