//! Files of records in messages.

use js_sys::{Array, Float64Array, Uint8Array};
use kalmanscope_core::document;
use kalmanscope_core::import::{ImportError, Loaded, Loading, Table};
use wasm_bindgen::{JsCast as _, JsValue};

use crate::scope::Words;
use crate::task::numbers;

/// The message that gives a worker the bytes of a file.
pub fn file_message(number: u32, bytes: &[u8]) -> Array {
    Array::of3(&"file".into(), &number.into(), &Uint8Array::from(bytes))
}

/// The file of a message.
pub(crate) fn file(words: &Words) -> Loading {
    Loading::new(words.get(2).dyn_into::<Uint8Array>().map(|bytes| bytes.to_vec()).unwrap_or_default())
}

/// A file that has been read as `[hash, table, column, …]`, or a text with the reason why it cannot be read.
pub(crate) fn loaded_message(loaded: &Result<Loaded, ImportError>, handed_over: &Array) -> JsValue {
    match loaded {
        Ok(Loaded { hash, table }) => {
            let message = Array::of2(&hash.into(), &document::to_json(table).unwrap_or_default().into());
            for column in &table.columns {
                message.push(&numbers(&column.values, handed_over));
            }
            message.into()
        }
        Err(error) => error.to_string().into(),
    }
}

/// The file of a worker's message, or the reason why it cannot be read. `None` if the message is not one of a file.
pub fn loaded(value: &JsValue) -> Option<Result<Loaded, String>> {
    if let Some(reason) = value.as_string() {
        return Some(Err(reason));
    }
    let message: &Array = value.dyn_ref()?;
    let hash = message.get(0).as_string()?;
    let mut table: Table = document::read_json(&message.get(1).as_string()?).ok()?;
    for (column, values) in table.columns.iter_mut().zip(message.iter().skip(2)) {
        column.values = values.dyn_into::<Float64Array>().ok()?.to_vec();
    }
    Some(Ok(Loaded { hash, table }))
}
