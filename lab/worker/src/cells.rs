//! Cells of ensembles in messages.

use std::sync::Arc;

use js_sys::{Array, Float64Array, Uint32Array};
use kalmanscope_core::Source;
use kalmanscope_lab::{Ensemble, Runner};
use wasm_bindgen::{JsCast as _, JsValue};

use crate::record::{in_message, measured};
use crate::scope::Words;
use crate::task::{Portioned, numbers};

/// The message that gives a worker an ensemble, of which it is to run cells.
pub fn cells_message(number: u32, runner: &Runner) -> Array {
    let record = in_message(runner.source());
    Array::of4(&"cells".into(), &number.into(), &runner.ensemble().to_json().into(), &record)
}

/// The runner of the ensemble in a message.
///
/// # Errors
/// The reason in words where it cannot be used.
pub fn runner(words: &Words) -> Result<Runner, String> {
    let ensemble = Ensemble::from_json(&words.text(2)).map_err(|error| error.to_string())?;
    let record = words.get(3);
    let source = if record.is_null() || record.is_undefined() {
        Source::Simulated
    } else {
        let record = measured(record.unchecked_ref(), ensemble.scenario());
        Source::Measured(Arc::new(record.ok_or("the record of the message is not one")?))
    };
    Runner::new(ensemble, source).map_err(|error| error.to_string())
}

pub(crate) struct Rows(pub(crate) Runner);

impl Portioned for Rows {
    fn go_on(&mut self, portion: &JsValue, handed_over: &Array) -> JsValue {
        let cells = cells(portion);
        rows_part(&cells, &self.0.rows(&cells), handed_over)
    }
}

/// A portion of cells.
pub fn portion_of(cells: &[usize]) -> JsValue {
    let cells: Vec<u32> = cells.iter().map(|&cell| cell as u32).collect();
    Uint32Array::from(cells.as_slice()).into()
}

/// The cells of a portion.
pub fn cells(portion: &JsValue) -> Vec<usize> {
    let cells = portion.dyn_ref::<Uint32Array>().map(Uint32Array::to_vec).unwrap_or_default();
    cells.into_iter().map(|cell| cell as usize).collect()
}

/// The part with the rows of some cells.
pub fn rows_part(cells: &[usize], rows: &[f64], handed_over: &Array) -> JsValue {
    Array::of2(&portion_of(cells), &numbers(rows, handed_over)).into()
}

/// The cells of a part, and their rows.
pub fn rows(part: &JsValue) -> Option<(Vec<usize>, Vec<f64>)> {
    let part: &Array = part.dyn_ref()?;
    Some((cells(&part.get(0)), part.get(1).dyn_into::<Float64Array>().ok()?.to_vec()))
}
