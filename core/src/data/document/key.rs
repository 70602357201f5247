//! Keys of tables. Formats have text alone, and types may have numbers.

use serde::de::value::StrDeserializer;
use serde::de::{self, Deserializer, IntoDeserializer, Visitor};
use serde::forward_to_deserialize_any;

use super::{Document, DocumentError};

/// The key that a value is written as.
pub(super) fn written(key: Document) -> Result<String, DocumentError> {
    match key {
        Document::Text(key) => Ok(key),
        Document::Integer(key) => Ok(key.to_string()),
        Document::Large(key) => Ok(key.to_string()),
        _ => Err(de::Error::custom("a key must be a word or an integer")),
    }
}

/// A key to be read.
pub(super) struct Key<'de>(pub(super) &'de str);

impl<'de> Key<'de> {
    fn text(self) -> StrDeserializer<'de, DocumentError> {
        self.0.into_deserializer()
    }

    fn unsigned<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DocumentError> {
        match self.0.parse() {
            Ok(number) => visitor.visit_u64(number),
            Err(_) => visitor.visit_str(self.0),
        }
    }

    fn signed<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DocumentError> {
        match self.0.parse() {
            Ok(number) => visitor.visit_i64(number),
            Err(_) => visitor.visit_str(self.0),
        }
    }
}

macro_rules! integers {
    ($($method:ident $as:ident)*) => {$(
        fn $method<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DocumentError> {
            self.$as(visitor)
        }
    )*};
}

impl<'de> Deserializer<'de> for Key<'de> {
    type Error = DocumentError;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DocumentError> {
        visitor.visit_str(self.0)
    }

    integers! {
        deserialize_u8 unsigned
        deserialize_u16 unsigned
        deserialize_u32 unsigned
        deserialize_u64 unsigned
        deserialize_i8 signed
        deserialize_i16 signed
        deserialize_i32 signed
        deserialize_i64 signed
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, DocumentError> {
        visitor.visit_some(self)
    }

    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, DocumentError> {
        visitor.visit_newtype_struct(self)
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, DocumentError> {
        visitor.visit_enum(self.text())
    }

    forward_to_deserialize_any! {
        bool i128 u128 f32 f64 char str string bytes byte_buf unit unit_struct seq tuple tuple_struct map struct identifier
        ignored_any
    }
}
