//! A kind of long work, and the numbers that it sends.

use js_sys::Array;
use wasm_bindgen::JsValue;

/// A kind of long work on one thing.
pub(crate) trait Work {
    /// Does the next `count` portions, and returns the part to send. The browser does not copy buffers in `handed_over`.
    fn go_on(&mut self, count: usize, handed_over: &Array) -> JsValue;
}

/// Numbers for a message. Their buffer is handed over, not copied.
pub(crate) fn numbers(values: &[f64], handed_over: &Array) -> JsValue {
    let values = js_sys::Float64Array::from(values);
    handed_over.push(&values.buffer());
    values.into()
}
