//! Start values in messages.

use js_sys::Array;
use kalmanscope_core::document;
use kalmanscope_core::suggest::{Suggest, Suggestion};
use kalmanscope_core::{Record, Scenario};
use wasm_bindgen::JsValue;

use crate::record::{filtered, scenario_and_record};
use crate::scope::Words;

/// The message that asks a worker for start values of a scenario on a record.
pub fn suggest_message(number: u32, scenario: &Scenario, record: &Record) -> Array {
    let scenario = document::to_json(scenario).unwrap_or_default();
    Array::of4(&"suggest".into(), &number.into(), &scenario.into(), &filtered(record))
}

/// The search for start values that a message asks for.
///
/// # Errors
/// The reason in words if it cannot begin.
pub(crate) fn suggest(words: &Words) -> Result<Suggest, String> {
    let (scenario, record) = scenario_and_record(&words.text(2), words.get(3))?;
    Ok(Suggest::new(&scenario, record))
}

/// Start values as JSON.
pub(crate) fn suggestion_message(suggestion: &Suggestion, _: &Array) -> JsValue {
    document::to_json(suggestion).unwrap_or_default().into()
}

/// The start values of a worker's message. `None` if it has none.
pub fn suggestion(value: &JsValue) -> Option<Suggestion> {
    document::read_json(&value.as_string()?).ok()
}
