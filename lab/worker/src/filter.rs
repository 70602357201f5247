//! Single filters, points of a posterior and start values in messages.

use js_sys::{Array, Float64Array};
use kalmanscope_core::suggest::{Suggest, Suggestion};
use kalmanscope_core::{Pass, Record, Scenario, Tape, document};
use kalmanscope_lab::posterior::{Posterior, Sampled};
use wasm_bindgen::{JsCast as _, JsValue};

use crate::record::{filtered, scenario_and_record};
use crate::scope::Words;
use crate::task::{Portioned, count, numbers};

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

fn search_message(kind: &str, number: u32, scenario: &Scenario, record: &Record) -> Array {
    let scenario = document::to_json(scenario).unwrap_or_default();
    Array::of4(&kind.into(), &number.into(), &scenario.into(), &filtered(record))
}

/// The message that asks a worker for the posterior of the first filter of a scenario, given a record.
pub fn posterior_message(number: u32, scenario: &Scenario, record: &Record) -> Array {
    search_message("posterior", number, scenario, record)
}

pub(crate) fn posterior(words: &Words) -> Result<Posterior, String> {
    let (scenario, record) = scenario_and_record(&words.text(2), words.get(3))?;
    Posterior::new(&scenario, 0, &record).map_err(|reason| reason.to_string())
}

pub(crate) fn sampled_message(sampled: &Option<Sampled>, _: &Array) -> JsValue {
    document::to_json(sampled).unwrap_or_default().into()
}

/// The points of a worker's message. `None` if it is none.
pub fn sampled(value: &JsValue) -> Option<Option<Sampled>> {
    document::read_json(&value.as_string()?).ok()
}

/// The message that asks a worker for start values of a scenario on a record.
pub fn suggest_message(number: u32, scenario: &Scenario, record: &Record) -> Array {
    search_message("suggest", number, scenario, record)
}

pub(crate) fn suggest(words: &Words) -> Result<Suggest, String> {
    let (scenario, record) = scenario_and_record(&words.text(2), words.get(3))?;
    Ok(Suggest::new(&scenario, record))
}

pub(crate) fn suggestion_message(suggestion: &Suggestion, _: &Array) -> JsValue {
    document::to_json(suggestion).unwrap_or_default().into()
}

/// The start values of a worker's message. `None` if it has none.
pub fn suggestion(value: &JsValue) -> Option<Suggestion> {
    document::read_json(&value.as_string()?).ok()
}
