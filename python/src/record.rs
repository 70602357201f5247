//! Records: of arrays, of data frames, or of files.

use std::path::PathBuf;
use std::sync::Arc;

use kalmanscope_core::document::{self, json};
use kalmanscope_core::import::{self, Column, Imported, Mapping, Table};
use kalmanscope_core::record::{Clocks, Input, Timed};
use kalmanscope_core::{Channel, Hold, InputKind, Quantity, Record as Samples, Run, Scenario as Settings};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{array, column, frame, to_document};
use crate::error;

/// Samples of an input and of sensors, NaN where a reading is missing.
///
/// Record(t, u=None, *, input="force", hold="zero", **sensors)
/// Record(source, *, mapping=None, input=None, hold="first")
///
/// Parameters
/// ----------
/// t : float or array_like, shape (N,)
///     Time between samples, or the times of the samples [s].
/// u : array_like, shape (N,), optional
///     Force over mass, or acceleration of the ground [m/s²]; zero if left out.
/// **sensors : array_like, shape (N,), or a pair of times and readings, shape (M,) each
///     Readings by quantity in SI units: ``displacement``, ``velocity``, ``acceleration``, ``total_acceleration``, ``drift``; of
///     further masses ``displacement_2`` and so on. NaN, None and null are missing readings. True values of a channel, where they
///     are known, as ``true_natural_frequency``.
/// source : path or data frame of pandas or polars
///     A file that the program can read, or columns with names; what they mean is guessed.
/// mapping : dict, optional
///     A scenario's ``[record]``: what the columns mean, their units, gains, offsets, the part, the band.
/// input : {"force", "ground_acceleration"}
/// hold : {"zero", "first"}
///     The input between samples: held, or linear.
///
/// Raises
/// ------
/// Error
///     Where columns have different lengths, or a file is none of a record.
#[pyclass(module = "kalmanscope", frozen)]
pub(crate) struct Record {
    pub(crate) record: Arc<Samples>,
    /// How it was read, one sentence each.
    #[pyo3(get)]
    remarks: Vec<String>,
    /// What the columns of its file mean.
    pub(crate) mapping: Option<Mapping>,
}

#[pymethods]
impl Record {
    #[new]
    #[pyo3(signature = (t, u=None, /, *, mapping=None, input=None, hold=None, **sensors))]
    fn new(
        t: &Bound<'_, PyAny>,
        u: Option<&Bound<'_, PyAny>>,
        mapping: Option<&Bound<'_, PyAny>>,
        input: Option<&str>,
        hold: Option<&str>,
        sensors: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let kind = input.map(|input| document::read::<InputKind>(&json!(input))).transpose().map_err(error)?;
        let hold = hold.map(|hold| document::read::<Hold>(&json!(hold))).transpose().map_err(error)?;
        if let Some((table, file)) = table(t)? {
            return of_table(&table, file, mapping, kind, hold.unwrap_or(Hold::First));
        }
        let (mut readings, mut truth) = (Vec::new(), Vec::new());
        for (key, values) in sensors.into_iter().flat_map(|sensors| sensors.iter()) {
            let key: String = key.extract()?;
            if let Some(channel) = key.strip_prefix("true_").and_then(Channel::from_key) {
                truth.push((channel, column(&values)?));
                continue;
            }
            let unknown = || {
                let keys: Vec<&str> = Quantity::all().iter().take(5).map(|quantity| quantity.key()).collect();
                error(format_args!("`{key}` is no quantity: there are {}, also as `displacement_2`", keys.join(", ")))
            };
            let quantity = Quantity::from_key(&key).ok_or_else(unknown)?;
            // A pair of columns are times and readings; two numbers are two readings.
            readings.push(match values.extract::<(Bound<'_, PyAny>, Bound<'_, PyAny>)>() {
                Ok((times, values)) if times.len().is_ok() => (quantity, Some(column(&times)?), column(&values)?),
                _ => (quantity, None, column(&values)?),
            });
        }
        let given = u.map(column).transpose()?;
        let times = if t.len().is_ok() { Ok(column(t)?) } else { Err(t.extract()?) };
        let (kind, hold) = (kind.unwrap_or(InputKind::Force), hold.unwrap_or_default());
        let record = of_columns(times, given, kind, hold, readings)?;
        Ok(Self::of(if truth.is_empty() { record } else { record.with_truth(truth).map_err(error)? }, Vec::new()))
    }

    fn __len__(&self) -> usize {
        self.record.len()
    }

    /// The time between samples [s].
    #[getter]
    fn dt(&self) -> f64 {
        self.record.dt()
    }

    /// The times of the samples [s], shape (N,).
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let record = &self.record;
        array(py, &[record.len()], (0..record.len()).map(|k| record.time(k)))
    }

    /// The input [m/s²], shape (N,).
    #[getter]
    fn input<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        array(py, &[self.record.len()], self.record.input().iter().copied())
    }

    /// The measured quantities.
    #[getter]
    fn sensors(&self) -> Vec<&'static str> {
        self.record.sensors().iter().map(|quantity| quantity.key()).collect()
    }

    /// The readings of a quantity, or the truth of a channel as ``true_natural_frequency``; shape (N,).
    fn __getitem__<'py>(&self, py: Python<'py>, key: &str) -> PyResult<Bound<'py, PyAny>> {
        let truth = || self.record.truth(Channel::from_key(key.strip_prefix("true_")?)?);
        let readings = Quantity::from_key(key).and_then(|quantity| self.record.measured_quantity(quantity));
        let column = readings.or_else(truth).ok_or_else(|| PyKeyError::new_err(key.to_owned()))?;
        array(py, &[column.len()], column.iter().copied())
    }

    fn __repr__(&self) -> String {
        let record = &*self.record;
        let missing: usize = (0..record.sensors().len())
            .map(|sensor| record.measured(sensor).iter().filter(|value| value.is_nan()).count())
            .sum();
        let lost = if missing > 0 { format!(", {missing} readings missing") } else { String::new() };
        let clocks = if record.clocks().is_some() { ", readings at times of their own" } else { "" };
        let sensors = self.sensors().join(", ");
        format!("<Record of {} samples, {} s apart: {sensors}{lost}{clocks}>", record.len(), record.dt())
    }

    fn _repr_html_(&self) -> PyResult<String> {
        let scenario = kalmanscope_core::suggest::scenario_for(&self.record);
        let scenario = Settings { filters: Vec::new(), ..scenario };
        Ok(kalmanscope_cli::svg(&Run::on_record(&scenario, self.record.clone()).map_err(error)?))
    }
}

impl Record {
    pub(crate) fn of(record: Samples, remarks: Vec<String>) -> Self {
        Self { record: Arc::new(record), remarks, mapping: None }
    }
}

/// The columns of a file or of a data frame, and the file's name; `None` of anything else.
fn table(source: &Bound<'_, PyAny>) -> PyResult<Option<(Table, String)>> {
    if source.hasattr("columns")? {
        let columns = frame(source)?.into_iter().map(|(name, values)| Column::of_header(&name, None, values)).collect();
        return Ok(Some((Table::of_columns("a data frame", columns, Vec::new()), String::new())));
    }
    let Ok(path) = source.extract::<PathBuf>() else { return Ok(None) };
    let of_file = |reason: &dyn ToString| error(format_args!("{}: {}", path.display(), reason.to_string()));
    let bytes = std::fs::read(&path).map_err(|reason| of_file(&reason))?;
    let table = import::read(bytes, None).map_err(|reason| of_file(&reason))?;
    Ok(Some((table, path.display().to_string())))
}

fn of_table(
    table: &Table,
    file: String,
    given: Option<&Bound<'_, PyAny>>,
    kind: Option<InputKind>,
    hold: Hold,
) -> PyResult<Record> {
    let given = given.map(|given| document::read::<Mapping>(&to_document(given)?).map_err(error)).transpose()?;
    let given = given.unwrap_or_default();
    let (guess, guessed) = Mapping::guess(table);
    let mapping = if given.sensors.is_empty() {
        let time = if given.time == Default::default() { guess.time } else { given.time };
        Mapping { time, input: given.input.or(guess.input), sensors: guess.sensors, ..given }
    } else {
        given
    };
    let built = import::build(table, &mapping, kind.unwrap_or(guessed), hold, &Channel::all());
    let Imported { record, remarks, .. } = built.map_err(error)?;
    let remarks = [table.form.clone(), mapping.in_words()].into_iter().chain(remarks).collect();
    Ok(Record { mapping: Some(Mapping { file, ..mapping }), ..Record::of(record, remarks) })
}

/// Times that differ from even ones by less than this share of a step are even.
const EVEN: f64 = 1e-3;

type Readings = (Quantity, Option<Vec<f64>>, Vec<f64>);

fn of_columns(
    times: Result<Vec<f64>, f64>,
    given: Option<Vec<f64>>,
    kind: InputKind,
    hold: Hold,
    sensors: Vec<Readings>,
) -> PyResult<Samples> {
    let length = |times: &Vec<f64>| times.len();
    let first = || sensors.iter().find(|(_, own, _)| own.is_none()).map_or(0, |(.., values)| values.len());
    let samples = times.as_ref().map_or_else(|_| given.as_ref().map_or_else(first, Vec::len), length);
    let (start, dt) = match &times {
        Err(dt) => (0.0, *dt),
        Ok(times) if samples < 2 || times.iter().any(|time| !time.is_finite()) => {
            return Err(error(format_args!("{} times are none of a record: they must be finite", times.len())));
        }
        Ok(times) => (times[0], (times[samples - 1] - times[0]) / (samples - 1) as f64),
    };
    let is_even =
        |times: &Vec<f64>| times.iter().enumerate().all(|(k, time)| ((time - start) / dt - k as f64).abs() < EVEN);
    let uneven = times.ok().filter(|times| !is_even(times));
    let own = |times: &[f64]| -> Vec<f64> { times.iter().map(|time| (time - start) / dt).collect() };
    let has_clocks = uneven.is_some() || sensors.iter().any(|(_, times, _)| times.is_some());
    let (mut columns, mut readings) = (Vec::new(), Vec::new());
    for (quantity, times, values) in sensors {
        if !has_clocks {
            columns.push((quantity, values));
            continue;
        }
        let times = match (&times, &uneven) {
            (Some(times), _) | (None, Some(times)) => own(times),
            (None, None) => (0..values.len()).map(|k| k as f64).collect(),
        };
        if times.len() != values.len() {
            let name = quantity.key();
            return Err(error(format_args!("`{name}` has {} times, but {} readings", times.len(), values.len())));
        }
        // A column has the last reading of each step at its end.
        let mut column = vec![f64::NAN; samples];
        let there = times.iter().zip(&values).filter(|(_, value)| !value.is_nan());
        for (time, value) in there.clone() {
            if let Some(sample) = column.get_mut((time - EVEN).ceil().max(0.0) as usize) {
                *sample = *value;
            }
        }
        let (times, values) = there.map(|(time, value)| (*time, *value)).unzip();
        readings.push(Timed { times, values });
        columns.push((quantity, column));
    }
    let values = given.unwrap_or_else(|| vec![0.0; samples]);
    let input = uneven.map(|times| Timed { times: own(&times), values: values.clone() });
    let record = Samples::new(dt, Input { kind, hold, values }, columns).map_err(error)?.starting_at(start);
    if has_clocks { record.with_clocks(Clocks { input, readings }).map_err(error) } else { Ok(record) }
}
