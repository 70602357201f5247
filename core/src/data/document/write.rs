//! Writes types to a document.

use serde::ser::{
    Serialize, SerializeMap, SerializeSeq, SerializeStruct, SerializeStructVariant, SerializeTuple,
    SerializeTupleStruct, SerializeTupleVariant, Serializer,
};

use super::{Document, DocumentError, key};

type Written = Result<Document, DocumentError>;

/// Writes a value.
pub(super) struct Writer;

macro_rules! as_they_are {
    ($($method:ident $from:ty => $variant:ident)*) => {$(
        fn $method(self, value: $from) -> Written {
            Ok(Document::$variant(value.into()))
        }
    )*};
}

impl Serializer for Writer {
    type Ok = Document;
    type Error = DocumentError;
    type SerializeSeq = List;
    type SerializeTuple = List;
    type SerializeTupleStruct = List;
    type SerializeTupleVariant = List;
    type SerializeMap = Table;
    type SerializeStruct = Table;
    type SerializeStructVariant = Table;

    as_they_are! {
        serialize_bool bool => Flag
        serialize_i8 i8 => Integer
        serialize_i16 i16 => Integer
        serialize_i32 i32 => Integer
        serialize_i64 i64 => Integer
        serialize_u8 u8 => Integer
        serialize_u16 u16 => Integer
        serialize_u32 u32 => Integer
        serialize_f32 f32 => Single
        serialize_f64 f64 => Number
        serialize_char char => Text
        serialize_str &str => Text
    }

    fn serialize_u64(self, value: u64) -> Written {
        Ok(value.into())
    }

    fn serialize_bytes(self, value: &[u8]) -> Written {
        Ok(Document::List(value.iter().map(|&byte| Document::Integer(byte.into())).collect()))
    }

    fn serialize_none(self) -> Written {
        Ok(Document::Null)
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Written {
        value.serialize(self)
    }

    fn serialize_unit(self) -> Written {
        Ok(Document::Null)
    }

    fn serialize_unit_struct(self, _: &'static str) -> Written {
        Ok(Document::Null)
    }

    fn serialize_unit_variant(self, _: &'static str, _: u32, variant: &'static str) -> Written {
        Ok(Document::Text(variant.to_owned()))
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: &'static str, value: &T) -> Written {
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: u32,
        variant: &'static str,
        value: &T,
    ) -> Written {
        value.serialize(self).map(|value| within(Some(variant), value))
    }

    fn serialize_seq(self, _: Option<usize>) -> Result<List, DocumentError> {
        Ok(List { variant: None, values: Vec::new() })
    }

    fn serialize_tuple(self, _: usize) -> Result<List, DocumentError> {
        self.serialize_seq(None)
    }

    fn serialize_tuple_struct(self, _: &'static str, _: usize) -> Result<List, DocumentError> {
        self.serialize_seq(None)
    }

    fn serialize_tuple_variant(
        self,
        _: &'static str,
        _: u32,
        variant: &'static str,
        _: usize,
    ) -> Result<List, DocumentError> {
        Ok(List { variant: Some(variant), values: Vec::new() })
    }

    fn serialize_map(self, _: Option<usize>) -> Result<Table, DocumentError> {
        Ok(Table { variant: None, entries: Vec::new(), key: String::new() })
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Table, DocumentError> {
        self.serialize_map(None)
    }

    fn serialize_struct_variant(
        self,
        _: &'static str,
        _: u32,
        variant: &'static str,
        _: usize,
    ) -> Result<Table, DocumentError> {
        Ok(Table { variant: Some(variant), entries: Vec::new(), key: String::new() })
    }
}

/// A variant with contents is a table of one key.
fn within(variant: Option<&'static str>, value: Document) -> Document {
    match variant {
        Some(variant) => Document::Table(vec![(variant.to_owned(), value)]),
        None => value,
    }
}

/// A list being written.
pub(super) struct List {
    variant: Option<&'static str>,
    values: Vec<Document>,
}

impl List {
    #[inline(never)]
    fn push(&mut self, value: Written) -> Result<(), DocumentError> {
        self.values.push(value?);
        Ok(())
    }

    fn finish(self) -> Written {
        Ok(within(self.variant, Document::List(self.values)))
    }
}

/// A table being written.
pub(super) struct Table {
    variant: Option<&'static str>,
    entries: Vec<(String, Document)>,
    /// The key of the next value.
    key: String,
}

impl Table {
    #[inline(never)]
    fn push(&mut self, key: &str, value: Written) -> Result<(), DocumentError> {
        self.entries.push((key.to_owned(), value?));
        Ok(())
    }

    fn finish(self) -> Written {
        Ok(within(self.variant, Document::Table(self.entries)))
    }
}

macro_rules! list {
    ($($name:ident $method:ident)*) => {$(
        impl $name for List {
            type Ok = Document;
            type Error = DocumentError;

            fn $method<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), DocumentError> {
                self.push(value.serialize(Writer))
            }

            fn end(self) -> Written {
                self.finish()
            }
        }
    )*};
}

list! {
    SerializeSeq serialize_element
    SerializeTuple serialize_element
    SerializeTupleStruct serialize_field
    SerializeTupleVariant serialize_field
}

macro_rules! table {
    ($($name:ident)*) => {$(
        impl $name for Table {
            type Ok = Document;
            type Error = DocumentError;

            fn serialize_field<T: Serialize + ?Sized>(
                &mut self,
                key: &'static str,
                value: &T,
            ) -> Result<(), DocumentError> {
                self.push(key, value.serialize(Writer))
            }

            fn end(self) -> Written {
                self.finish()
            }
        }
    )*};
}

table! { SerializeStruct SerializeStructVariant }

impl SerializeMap for Table {
    type Ok = Document;
    type Error = DocumentError;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, key: &T) -> Result<(), DocumentError> {
        self.key = key::written(key.serialize(Writer)?)?;
        Ok(())
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), DocumentError> {
        let key = std::mem::take(&mut self.key);
        self.push(&key, value.serialize(Writer))
    }

    fn end(self) -> Written {
        self.finish()
    }
}
