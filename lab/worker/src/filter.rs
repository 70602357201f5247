//! Single filters in messages.

use js_sys::{Array, Float64Array};
use kalmanscope_core::{Document, Pass, Record, Scenario, Tape};
use wasm_bindgen::{JsCast as _, JsValue};

use crate::record::{filtered, measured};
use crate::scope::{Words, send};

/// A filter over a record, in a worker.
pub struct Filter {
    number: f64,
    record: Record,
    pass: Pass,
}

/// The message that gives a worker the filter at a place of a scenario.
pub fn filter_message(number: u32, scenario: &Scenario, place: usize, record: &Record) -> Array {
    let scenario = Document::json(scenario).unwrap_or_default();
    Array::of5(&"filter".into(), &number.into(), &scenario.into(), &(place as u32).into(), &filtered(record))
}

impl Filter {
    /// The filter of a message.
    ///
    /// # Errors
    /// The reason in words where it cannot be used.
    pub fn new(words: &Words) -> Result<Self, String> {
        let scenario: Scenario = Document::read_json(&words.text(2)).map_err(|error| error.to_string())?;
        let record = words.get(4).dyn_into::<Array>().ok().and_then(|record| measured(&record, &scenario));
        let record = record.ok_or("the record of the message is not one")?;
        let place = words.get(3).as_f64().unwrap_or(f64::NAN) as usize;
        let pass = Pass::new(&scenario, place, &record).map_err(|error| error.to_string())?;
        Ok(Self { number: words.job(), record, pass })
    }

    /// Its number on the page.
    pub fn number(&self) -> f64 {
        self.number
    }

    /// Computes the samples that a message asks for, and sends them.
    pub fn answer(&mut self, words: &Words) {
        let samples = self.pass.done() + words.get(2).as_f64().unwrap_or(0.0) as usize;
        let mut tape = Tape::default();
        self.pass.follow(&self.record, samples, &mut tape);
        let numbers = Float64Array::from(tape.numbers());
        let message = Array::of3(&"samples".into(), &self.number.into(), &numbers);
        send(&message, &numbers);
    }
}

/// The samples of a message.
pub fn tape(value: JsValue) -> Tape {
    Tape::from_numbers(value.dyn_into::<Float64Array>().map(|numbers| numbers.to_vec()).unwrap_or_default())
}
