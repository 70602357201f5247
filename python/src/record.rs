//! Records: of arrays, of data frames, or of files.

use std::path::PathBuf;
use std::sync::Arc;

use kalmanscope_core::document::{self, json};
use kalmanscope_core::import::{self, Column, Imported, Mapping, Table};
use kalmanscope_core::{Channel, ForcedMass, Hold, InputKind, Quantity, Record as Samples, Run, Scenario as Settings};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{array, columns, to_document};
use crate::{error, no_key};

/// Samples of an input and of sensors, NaN where a reading is missing. An `Error` says where columns have different lengths or text,
/// times do not rise, or a file is none of a record.
///
/// Record(t, u=None, *, input="force", hold="zero", **sensors)
/// Record(source, *, mapping=None, input=None, hold="first")
///
/// Parameters
/// ----------
/// t : float or array_like, shape (N,)
///     Time between samples [s], or the times of the samples, in seconds or as dates. Uneven times are kept, and gaps filled, as of
///     a file: `remarks` say so.
/// u : array_like, shape (N,), optional
///     Force over mass, or acceleration of the ground [m/s²]; zero if left out.
/// **sensors : array_like, shape (N,), or a pair of times and readings, shape (M,) each
///     Readings by quantity in SI units: ``displacement``, ``velocity``, ``acceleration``, ``total_acceleration``, ``drift``; of
///     further masses ``displacement_2`` and so on. NaN, None and null are missing readings. True values of a channel, where they
///     are known, as ``true_natural_frequency``; forces over mass on single masses, besides u, as ``force_on_3``.
/// source : path or data frame of pandas or polars
///     A file that the program can read, or columns with names; what they mean is guessed.
/// mapping : dict, optional
///     A scenario's ``[record]``: what the columns mean, their units, gains, offsets, the part, the band.
/// input : {"force", "ground_acceleration"}
/// hold : {"zero", "first"}
///     The input between samples: held, or linear.
#[pyclass(module = "kalmanscope", frozen)]
pub(crate) struct Record {
    pub(crate) record: Arc<Samples>,
    /// How it was read, one sentence each.
    #[pyo3(get)]
    remarks: Vec<String>,
    /// The meaning of its file's columns.
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
        let given = mapping.map(|given| document::read::<Mapping>(&to_document(given)?).map_err(error)).transpose()?;
        let (table, arrays, file) = table_of(t, u, sensors)?;
        if arrays.is_some() && given.is_some() {
            return Err(error("`mapping` is for a file or a data frame"));
        }
        let (guess, guessed) = Mapping::guess(&table);
        let usual = if arrays.is_some() { (InputKind::Force, Hold::Zero) } else { (guessed, Hold::First) };
        let given = arrays.or(given).unwrap_or_default();
        let mapping = if given.sensors.is_empty() {
            let time = if given.time == Default::default() { guess.time } else { given.time };
            Mapping { time, input: given.input.or(guess.input), forces: guess.forces, sensors: guess.sensors, ..given }
        } else {
            given
        };
        let built = import::build(&table, &mapping, kind.unwrap_or(usual.0), hold.unwrap_or(usual.1), Channel::all());
        let all = |reason: import::ImportError| [vec![reason.to_string()], table.remarks.clone()].concat().join("; ");
        let Imported { record, mut remarks, .. } = built.map_err(|reason| error(all(reason)))?;
        let rows = table.columns[0].values.iter().filter(|time| !time.is_nan()).count();
        if file.is_none() && record.len() < rows {
            remarks.push(format!("{} steps remain of {rows} times: those in which all clocks run", record.len()));
        }
        if file.is_some() {
            remarks.splice(0..0, [table.form.clone(), mapping.in_words()]);
        }
        let mapping = file.map(|file| Mapping { file, ..mapping });
        Ok(Self { mapping, ..Self::of(record, remarks) })
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

    /// The readings of a quantity, the truth of a channel as ``true_natural_frequency``, or a force as ``force_on_3``; shape (N,).
    fn __getitem__<'py>(&self, py: Python<'py>, key: &str) -> PyResult<Bound<'py, PyAny>> {
        let truth = || self.record.truth(Channel::from_key(key.strip_prefix("true_")?)?);
        let readings = Quantity::from_key(key).and_then(|quantity| self.record.measured_quantity(quantity));
        let force = || self.record.force_on(ForcedMass::from_key(key)?);
        let column = readings.or_else(truth).or_else(force).ok_or_else(|| no_key(key, &self.sensors()))?;
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

/// The columns of a file, of a data frame, or of arrays; what those of arrays mean; and the file's name.
fn table_of(
    source: &Bound<'_, PyAny>,
    u: Option<&Bound<'_, PyAny>>,
    sensors: Option<&Bound<'_, PyDict>>,
) -> PyResult<(Table, Option<Mapping>, Option<String>)> {
    for key in sensors.into_iter().flat_map(|sensors| sensors.keys()) {
        let key: String = key.extract()?;
        let channel = key.strip_prefix("true_").and_then(Channel::from_key);
        if Quantity::from_key(&key).is_none() && channel.is_none() && ForcedMass::from_key(&key).is_none() {
            let known = Quantity::all()[..5].iter().map(|quantity| quantity.key()).collect::<Vec<_>>().join(", ");
            return Err(error(format_args!("`{key}` is no quantity: there are {known}, also as `displacement_2`")));
        }
    }
    match source.extract::<PathBuf>() {
        Ok(path) if u.is_none() && sensors.is_none() => {
            let of_file = |reason: &dyn ToString| error(format_args!("{}: {}", path.display(), reason.to_string()));
            let bytes = std::fs::read(&path).map_err(|reason| of_file(&reason))?;
            let table = import::read(bytes, None).map_err(|reason| of_file(&reason))?;
            Ok((table, None, Some(path.display().to_string())))
        }
        Ok(_) => Err(error("a file has all columns: `mapping` says what they mean")),
        Err(_) => {
            let (form, columns, remarks, mapping) = columns(source, u, sensors)?;
            let columns = columns.into_iter().map(|(name, values)| Column::of_header(&name, None, values)).collect();
            let mapping = mapping.map(|mapping| document::read_json(&mapping).map_err(error)).transpose()?;
            let file = mapping.is_none().then(String::new);
            Ok((Table::of_columns(&form, columns, remarks), mapping, file))
        }
    }
}
