//! Records and their files in messages.

use js_sys::{Array, Float64Array, Uint8Array};
use kalmanscope_core::import::{ImportError, Loaded, Loading, Table};
use kalmanscope_core::record::{Clocks, Input, Timed};
use kalmanscope_core::{Channel, Quantity, Record, Scenario, Source, document};
use wasm_bindgen::{JsCast as _, JsValue};

use crate::scope::Words;
use crate::task::numbers;

/// The keys of the truth's columns begin with this.
const TRUE: &str = "true_";

/// The keys of readings with their own times begin with this; that of the input is nothing more.
const TIMED: &str = "@";

/// A given record as `[dt, input, [key, column], …, [key, times, values], …]`; null for a simulation.
pub(crate) fn in_message(source: &Source) -> JsValue {
    let Some(record) = source.record() else { return JsValue::NULL };
    let message = filtered(record);
    for channel in Channel::all() {
        if let Some(truth) = record.truth(*channel) {
            push(&message, &format!("{TRUE}{}", channel.key()), truth);
        }
    }
    message.into()
}

pub(crate) fn filtered(record: &Record) -> Array {
    let message = Array::of2(&record.dt().into(), &Float64Array::from(record.input()));
    for (place, quantity) in record.sensors().iter().enumerate() {
        push(&message, quantity.key(), record.measured(place));
    }
    if let Some(Clocks { input, readings }) = record.clocks() {
        let sensors = record.sensors().iter().map(|quantity| quantity.key()).zip(readings);
        for (key, Timed { times, values }) in input.iter().map(|input| ("", input)).chain(sensors) {
            let [times, values] = [times, values].map(|numbers| Float64Array::from(&numbers[..]));
            message.push(&Array::of3(&format!("{TIMED}{key}").into(), &times, &values));
        }
    }
    message
}

fn push(message: &Array, key: &str, values: &[f64]) {
    message.push(&Array::of2(&key.into(), &Float64Array::from(values)));
}

/// The record of a message, if it is one; its input is of the scenario's kind.
pub(crate) fn measured(record: &Array, scenario: &Scenario) -> Option<Record> {
    let numbers = |value: JsValue| Some(value.dyn_into::<Float64Array>().ok()?.to_vec());
    let dt = record.get(0).as_f64()?;
    let input = Input { kind: scenario.input, hold: scenario.hold, values: numbers(record.get(1))? };
    let (mut sensors, mut truth, mut clocks) = (Vec::new(), Vec::new(), Clocks::default());
    for column in record.iter().skip(2) {
        let column: Array = column.dyn_into().ok()?;
        let (key, values) = (column.get(0).as_string()?, numbers(column.get(1))?);
        if let Some(sensor) = key.strip_prefix(TIMED) {
            let timed = Timed { times: values, values: numbers(column.get(2))? };
            match sensor {
                "" => clocks.input = Some(timed),
                _ => clocks.readings.push(timed),
            }
        } else if let Some(channel) = key.strip_prefix(TRUE) {
            truth.push((Channel::from_key(channel)?, values));
        } else {
            sensors.push((Quantity::from_key(&key)?, values));
        }
    }
    let record = Record::new(dt, input, sensors).ok()?.with_truth(truth).ok()?;
    if clocks.readings.is_empty() { Some(record) } else { record.with_clocks(clocks).ok() }
}

/// Fails where the text is no scenario, or the message has no record.
pub(crate) fn scenario_and_record(scenario: &str, record: JsValue) -> Result<(Scenario, Record), String> {
    let scenario: Scenario = document::read_json(scenario).map_err(|error| error.to_string())?;
    let record = record.dyn_into::<Array>().ok().and_then(|record| measured(&record, &scenario));
    Ok((scenario, record.ok_or("the record of the message is not one")?))
}

/// The message that gives a worker the bytes of a file.
pub fn file_message(number: u32, bytes: &[u8]) -> Array {
    Array::of3(&"file".into(), &number.into(), &Uint8Array::from(bytes))
}

pub(crate) fn file(words: &Words) -> Loading {
    Loading::new(words.get(2).dyn_into::<Uint8Array>().map(|bytes| bytes.to_vec()).unwrap_or_default())
}

/// A file that has been read as `[hash, table, column, …]`, or a text with the reason why it cannot be read.
pub(crate) fn loaded_message(loaded: &Result<Loaded, ImportError>, handed_over: &Array) -> JsValue {
    match loaded {
        Ok(Loaded { hash, table }) => {
            let message = Array::of2(&hash.into(), &document::to_json(table).unwrap_or_default().into());
            for column in &table.columns {
                message.push(&numbers(&column.values, handed_over));
            }
            message.into()
        }
        Err(error) => error.to_string().into(),
    }
}

/// The file of a worker's message, or the reason why it cannot be read. `None` if the message is not one of a file.
pub fn loaded(value: &JsValue) -> Option<Result<Loaded, String>> {
    if let Some(reason) = value.as_string() {
        return Some(Err(reason));
    }
    let message: &Array = value.dyn_ref()?;
    let hash = message.get(0).as_string()?;
    let mut table: Table = document::read_json(&message.get(1).as_string()?).ok()?;
    for (column, values) in table.columns.iter_mut().zip(message.iter().skip(2)) {
        column.values = values.dyn_into::<Float64Array>().ok()?.to_vec();
    }
    Some(Ok(Loaded { hash, table }))
}
