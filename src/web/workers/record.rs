//! Records in messages to workers.

use js_sys::{Array, Float64Array};
use kalmanscope_core::{Channel, Source};
use wasm_bindgen::JsValue;

/// A given record as `[dt, input, [key, column], …]`; null for a simulation.
pub(super) fn in_message(source: &Source) -> JsValue {
    let Source::Measured(record) = source else { return JsValue::NULL };
    let numbers = |values: &[f64]| JsValue::from(Float64Array::from(values));
    let message = Array::of2(&record.dt().into(), &numbers(record.input()));
    let push = |key: &str, values: &[f64]| {
        message.push(&Array::of2(&key.into(), &numbers(values)));
    };
    for (place, quantity) in record.sensors().iter().enumerate() {
        push(quantity.key(), record.measured(place));
    }
    for channel in Channel::all() {
        if let Some(truth) = record.truth(*channel) {
            push(&format!("true_{}", channel.key()), truth);
        }
    }
    message.into()
}
