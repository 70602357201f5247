//! Ensembles and cells in messages.

use std::sync::Arc;

use js_sys::Uint32Array;
use kalmanscope_core::Source;
use kalmanscope_lab::{Ensemble, Runner};
use wasm_bindgen::{JsCast as _, JsValue};

use crate::record::measured;

/// The runner of the ensemble in a message.
///
/// # Errors
/// The reason in words where it cannot be used.
pub fn runner(ensemble: &str, record: &JsValue) -> Result<Runner, String> {
    let ensemble = Ensemble::from_json(ensemble).map_err(|error| error.to_string())?;
    let source = if record.is_null() || record.is_undefined() {
        Source::Simulated
    } else {
        let record = measured(record.unchecked_ref(), ensemble.scenario());
        Source::Measured(Arc::new(record.ok_or("the record of the message is not one")?))
    };
    Runner::new(ensemble, source).map_err(|error| error.to_string())
}

/// The cells of a message.
pub fn cells(value: JsValue) -> Vec<usize> {
    let cells = value.dyn_into::<Uint32Array>().map(|cells| cells.to_vec()).unwrap_or_default();
    cells.into_iter().map(|cell| cell as usize).collect()
}
