//! Single filters in messages.

use js_sys::{Array, Float64Array};
use kalmanscope_core::document;
use kalmanscope_core::{Pass, Record, Scenario, Tape};
use wasm_bindgen::{JsCast as _, JsValue};

use crate::record::{filtered, scenario_and_record};
use crate::scope::Words;
use crate::task::{Portioned, count, numbers};

/// A filter over a record, in a worker.
pub(crate) struct Filter {
    record: Record,
    pass: Pass,
}

/// The message that gives a worker the filter at a place of a scenario.
pub fn filter_message(number: u32, scenario: &Scenario, place: usize, record: &Record) -> Array {
    let scenario = document::to_json(scenario).unwrap_or_default();
    Array::of5(&"filter".into(), &number.into(), &scenario.into(), &filtered(record), &(place as u32).into())
}

impl Filter {
    /// The filter of a message.
    ///
    /// # Errors
    /// The reason in words where it cannot be used.
    pub(crate) fn new(words: &Words) -> Result<Self, String> {
        let (scenario, record) = scenario_and_record(&words.text(2), words.get(3))?;
        let place = words.get(4).as_f64().unwrap_or(f64::NAN) as usize;
        let pass = Pass::new(&scenario, place, &record).map_err(|error| error.to_string())?;
        Ok(Self { record, pass })
    }
}

impl Portioned for Filter {
    fn go_on(&mut self, portion: &JsValue, handed_over: &Array) -> JsValue {
        let mut tape = Tape::default();
        self.pass.follow(&self.record, self.pass.done() + count(portion), &mut tape);
        numbers(tape.numbers(), handed_over)
    }
}

/// The samples of a message.
pub fn tape(value: &JsValue) -> Option<Tape> {
    value.dyn_ref::<Float64Array>().map(|numbers| Tape::from_numbers(numbers.to_vec()))
}
