//! Ensembles and records in messages.

use std::sync::Arc;

use js_sys::{Array, Float64Array, Uint32Array};
use kalmanscope_core::record::Input;
use kalmanscope_core::{Channel, Quantity, Record, Scenario, Source};
use kalmanscope_lab::{Ensemble, Runner};
use wasm_bindgen::{JsCast as _, JsValue};

/// The columns of a message's truth begin with this.
const TRUE: &str = "true_";

/// The runner of the ensemble in a message.
///
/// # Errors
/// The reason in words where it cannot be used.
pub(crate) fn runner(ensemble: &str, record: &JsValue) -> Result<Runner, String> {
    let ensemble = Ensemble::from_json(ensemble).map_err(|error| error.to_string())?;
    let source = if record.is_null() || record.is_undefined() {
        Source::Simulated
    } else {
        let record = measured(record.unchecked_ref(), ensemble.scenario());
        Source::Measured(Arc::new(record.ok_or("the record of the message is not one")?))
    };
    Runner::new(ensemble, source).map_err(|error| error.to_string())
}

/// A measured record; its input is of the scenario's kind.
fn measured(record: &Array, scenario: &Scenario) -> Option<Record> {
    let numbers = |value: JsValue| Some(value.dyn_into::<Float64Array>().ok()?.to_vec());
    let dt = record.get(0).as_f64()?;
    let input = Input { kind: scenario.input, hold: scenario.hold, values: numbers(record.get(1))? };
    let (mut sensors, mut truth) = (Vec::new(), Vec::new());
    for column in record.iter().skip(2) {
        let column: Array = column.dyn_into().ok()?;
        let (key, values) = (column.get(0).as_string()?, numbers(column.get(1))?);
        match key.strip_prefix(TRUE) {
            Some(channel) => truth.push((Channel::from_key(channel)?, values)),
            None => sensors.push((Quantity::from_key(&key)?, values)),
        }
    }
    Record::new(dt, input, sensors).ok()?.with_truth(truth).ok()
}

/// The cells of a message.
pub(crate) fn cells(value: JsValue) -> Vec<usize> {
    let cells = value.dyn_into::<Uint32Array>().map(|cells| cells.to_vec()).unwrap_or_default();
    cells.into_iter().map(|cell| cell as usize).collect()
}
