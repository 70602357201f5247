//! Points of a posterior in messages.

use js_sys::Array;
use kalmanscope_core::document;
use kalmanscope_core::{Record, Scenario};
use kalmanscope_lab::posterior::{Posterior, Sampled};
use wasm_bindgen::JsValue;

use crate::record::{filtered, scenario_and_record};
use crate::scope::Words;

/// The message that asks a worker for the posterior of the first filter of a scenario, given a record.
pub fn posterior_message(number: u32, scenario: &Scenario, record: &Record) -> Array {
    let scenario = document::to_json(scenario).unwrap_or_default();
    Array::of4(&"posterior".into(), &number.into(), &scenario.into(), &filtered(record))
}

/// The search that a message asks for.
///
/// # Errors
/// The reason in words if it cannot begin.
pub(crate) fn posterior(words: &Words) -> Result<Posterior, String> {
    let (scenario, record) = scenario_and_record(&words.text(2), words.get(3))?;
    Posterior::new(&scenario, 0, &record).map_err(|reason| reason.to_string())
}

/// The points as JSON, null if there are none.
pub(crate) fn sampled_message(sampled: &Option<Sampled>, _: &Array) -> JsValue {
    document::to_json(sampled).unwrap_or_default().into()
}

/// The points of a worker's message. `None` if it is none.
pub fn sampled(value: &JsValue) -> Option<Option<Sampled>> {
    document::read_json(&value.as_string()?).ok()
}
