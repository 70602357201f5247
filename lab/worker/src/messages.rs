//! Messages of ensembles' cells, single filters, start values, records and files, and the page's program in one of its workers.

use std::sync::Arc;

use js_sys::{Array, Float64Array, Uint8Array, Uint32Array};
use kalmanscope_core::import::{ImportError, Loaded, Table, load};
use kalmanscope_core::record::{Clocks, Input, Timed};
use kalmanscope_core::suggest::{self, Suggestion};
use kalmanscope_core::{ForcedMass, Pass, Quantity, Record, Scenario, Source, Tape, document};
use kalmanscope_lab::{Ensemble, Runner};
use wasm_bindgen::{JsCast as _, JsValue};

use crate::scope::{Portions, Words, answer, count, fail, hear, in_portions, numbers};

/// The message that gives a worker an ensemble, of which it is to run cells.
pub fn cells_message(number: u32, runner: &Runner) -> Array {
    let record = in_message(&runner.source);
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

/// The message that gives a worker the filter at a place of a scenario.
pub fn filter_message(number: u32, scenario: &Scenario, place: usize, record: &Record) -> Array {
    let scenario = document::to_json(scenario).unwrap_or_default();
    Array::of5(&"filter".into(), &number.into(), &scenario.into(), &filtered(record), &(place as u32).into())
}

/// The samples of a message.
pub fn tape(value: &JsValue) -> Option<Tape> {
    value.dyn_ref::<Float64Array>().map(|numbers| Tape(numbers.to_vec()))
}

/// The message that asks a worker for start values of a scenario on a record.
pub fn suggest_message(number: u32, scenario: &Scenario, record: &Record) -> Array {
    let scenario = document::to_json(scenario).unwrap_or_default();
    Array::of4(&"suggest".into(), &number.into(), &scenario.into(), &filtered(record))
}

fn suggestion_message(suggestion: &Suggestion, _: &Array) -> JsValue {
    document::to_json(suggestion).unwrap_or_default().into()
}

/// The start values of a worker's message. `None` if it has none.
pub fn suggestion(value: &JsValue) -> Option<Suggestion> {
    document::read_json(&value.as_string()?).ok()
}

const TRUE: &str = "true_";

/// The keys of readings with their own times begin with this; that of the input is this alone.
const TIMED: &str = "@";

/// A given record as `[dt, input, [key, column], …, [key, times, values], …]`; null for a simulation.
fn in_message(source: &Source) -> JsValue {
    let Some(record) = source.record() else { return JsValue::NULL };
    let message = filtered(record);
    for channel in record.true_channels() {
        if let Some(truth) = record.truth(channel) {
            push(&message, &format!("{TRUE}{}", channel.key()), truth);
        }
    }
    message.into()
}

fn filtered(record: &Record) -> Array {
    let message = Array::of2(&record.dt().into(), &Float64Array::from(record.input()));
    for (mass, values) in record.forces() {
        push(&message, mass.key(), values);
    }
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

fn measured(record: &Array, scenario: &Scenario) -> Option<Record> {
    let numbers = |value: JsValue| Some(value.dyn_into::<Float64Array>().ok()?.to_vec());
    let dt = record.get(0).as_f64()?;
    let input = Input { kind: scenario.input, hold: scenario.hold, values: numbers(record.get(1))? };
    let (mut sensors, mut forces, mut truth, mut clocks) = (Vec::new(), Vec::new(), Vec::new(), Clocks::default());
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
            truth.push((scenario.channel(channel)?, values));
        } else if let Some(mass) = ForcedMass::from_key(&key) {
            forces.push((mass, values));
        } else {
            sensors.push((Quantity::from_key(&key)?, values));
        }
    }
    let record = Record::new(dt, input, sensors).ok()?.with_truth(truth).ok()?.with_forces(forces).ok()?;
    if clocks.readings.is_empty() { Some(record) } else { record.with_clocks(clocks).ok() }
}

fn scenario_and_record(words: &Words) -> Result<(Scenario, Record), String> {
    let scenario: Scenario = document::read_json(&words.text(2)).map_err(|error| error.to_string())?;
    let record = words.get(3).dyn_into::<Array>().ok().and_then(|record| measured(&record, &scenario));
    Ok((scenario, record.ok_or("the record of the message is not one")?))
}

/// The message that gives a worker the bytes of a file.
pub fn file_message(number: u32, bytes: &[u8]) -> Array {
    Array::of3(&"file".into(), &number.into(), &Uint8Array::from(bytes))
}

/// A file that has been read as `[hash, table, column, …]`, or a text with the reason why it cannot be read.
fn loaded_message(loaded: &Result<Loaded, ImportError>, handed_over: &Array) -> JsValue {
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

/// Does tasks for as long as the worker lives.
pub fn serve() {
    let mut tasks: Vec<(f64, Portions)> = Vec::new();
    hear(move |words| {
        let number = words.number();
        match words.text(0).as_str() {
            "more" => {
                if let Some((_, task)) = tasks.iter_mut().find(|(other, _)| *other == number) {
                    let handed_over = Array::new();
                    let part = task(&words.get(2), &handed_over);
                    answer(number, &part, &handed_over);
                }
            }
            "forget" => tasks.retain(|(other, _)| *other != number),
            kind => match begin(kind, words) {
                Ok(task) => tasks.push((number, task)),
                Err(reason) => fail(number, &reason),
            },
        }
    });
}

fn begin(kind: &str, words: &Words) -> Result<Portions, String> {
    Ok(match kind {
        "cells" => {
            let runner = runner(words)?;
            Box::new(move |portion, handed_over| {
                let cells = cells(portion);
                rows_part(&cells, &runner.rows(&cells), handed_over)
            })
        }
        "filter" => {
            let (scenario, record) = scenario_and_record(words)?;
            let place = words.get(4).as_f64().unwrap_or(f64::NAN) as usize;
            let mut pass = Pass::new(&scenario, place, &record).map_err(|error| error.to_string())?;
            Box::new(move |portion, handed_over| {
                let mut tape = Tape::default();
                pass.follow(&record, pass.done() + count(portion), &mut tape);
                numbers(&tape.0, handed_over)
            })
        }
        "file" => {
            let bytes = words.get(2).dyn_into::<Uint8Array>().map(|bytes| bytes.to_vec()).unwrap_or_default();
            in_portions(load(bytes), loaded_message)
        }
        "suggest" => {
            let (scenario, record) = scenario_and_record(words)?;
            in_portions(suggest::begin(&scenario, record), suggestion_message)
        }
        _ => return Err(format!("`{kind}` is no task")),
    })
}
