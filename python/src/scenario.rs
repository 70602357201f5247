//! Scenarios: of TOML, dicts, keywords, or for a record.

use std::path::PathBuf;
use std::sync::Arc;

use kalmanscope_core::document::{self, Document, from_toml, json, of as written, to_json};
use kalmanscope_core::setting::{Address, Edit};
use kalmanscope_core::suggest::{begin, scenario_for};
use kalmanscope_core::{Scenario as Settings, Sensor, simulate};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{from_json, to_document};
use crate::record::Record;
use crate::{error, interruptible};

/// A truth, its sensors, and the filters that estimate it. An `Error` says which key is unknown, or which value is impossible.
///
/// Scenario(source=None, **settings)
///
/// Parameters
/// ----------
/// source : str, path, dict, Scenario or Record, optional
///     TOML or a file of it; settings as dicts; another scenario; or a measured record, for which start values are found.
/// **settings
///     Keys of a scenario, over those of the source: ``duration=20.0``, ``plant={"kind": "duffing"}``,
///     ``filters=[{"kind": "ukf", "sensor_std": {"acceleration": 0.02}}]``; ``equation="x'' + c x' + k x = f"`` for a plant of one's
///     own; settings by address, as in ``**{"filters.EKF.fading": 1.002}``, also those of a remedy's edits.
#[pyclass(module = "kalmanscope", frozen, eq)]
#[derive(Clone, PartialEq)]
pub(crate) struct Scenario {
    pub(crate) settings: Arc<Settings>,
    /// Where each start value comes from, or what was assumed; one sentence each.
    #[pyo3(get)]
    pub(crate) remarks: Vec<String>,
}

impl Scenario {
    /// A scenario, or what makes one.
    pub(crate) fn of(source: &Bound<'_, PyAny>) -> PyResult<Arc<Settings>> {
        if let Ok(scenario) = source.cast::<Self>() {
            return Ok(scenario.get().settings.clone());
        }
        Ok(Self::new(source.py(), Some(source), None)?.settings)
    }
}

#[pymethods]
impl Scenario {
    #[new]
    #[pyo3(signature = (source=None, /, **settings))]
    fn new(py: Python<'_>, source: Option<&Bound<'_, PyAny>>, settings: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let (over, addressed) = keywords(settings)?;
        let record = source.and_then(|source| source.cast::<Record>().ok()).map(|record| record.get());
        let mut document = match (&record, source) {
            (Some(Record { record, mapping, .. }), _) => {
                written(&Settings { record: mapping.clone(), ..scenario_for(record) }).map_err(error)?
            }
            (None, Some(source)) => document_of(source)?,
            (None, None) => json!({}),
        };
        merge(&mut document, &over);
        let (mut settings, mut remarks) = read(document)?;
        if let Some(record) = record {
            let search = begin(&settings, (*record.record).clone());
            let found = interruptible(py, move |wanted| wanted.finish(search))?.ok_or_else(|| error("interrupted"))?;
            remarks.extend(found.reasons);
            remarks.extend(found.problem);
            // What the caller has said comes before what was found.
            let mut document = written(&found.scenario).map_err(error)?;
            merge(&mut document, &over);
            settings = read(document)?.0;
        }
        for (key, value) in addressed {
            match (Address::parse(&settings, &key), value.as_f64()) {
                (Ok(address), Some(number)) => address.set(&mut settings, number),
                (Err(unknown), Some(_)) => return Err(error(unknown)),
                (_, None) => {
                    let edit = Edit { key, value: document::read(&value).map_err(error)? };
                    settings = edit.apply(&settings).map_err(error)?;
                }
            }
        }
        settings.validate().map_err(error)?;
        Ok(Self { settings: Arc::new(settings), remarks })
    }

    /// The scenario as a file.
    #[getter]
    fn toml(&self) -> PyResult<String> {
        self.settings.to_toml().map_err(error)
    }

    /// The scenario as dicts and lists.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        from_json(py, &to_json(&*self.settings).map_err(error)?)
    }

    /// The names of the filters.
    #[getter]
    fn filters(&self) -> Vec<String> {
        self.settings.filters.iter().map(|filter| filter.name.clone()).collect()
    }

    fn __getnewargs__(&self) -> PyResult<(String,)> {
        Ok((self.toml()?,))
    }

    /// The number with an address, as ``"filters.EKF.fading"``.
    fn __getitem__(&self, key: &str) -> PyResult<f64> {
        Ok(Address::parse(&self.settings, key).map_err(error)?.get(&self.settings))
    }

    /// A record of its truth and sensors, with the truth.
    #[pyo3(signature = (seed=None))]
    fn simulate(&self, py: Python<'_>, seed: Option<i128>) -> PyResult<Record> {
        let mut settings = Settings::clone(&self.settings);
        let seed = seed.map_or(Ok(settings.seed), TryInto::try_into);
        settings.seed = seed.map_err(|_| error("a seed is a whole number from 0 to 2⁶⁴ − 1"))?;
        settings.validate().map_err(error)?;
        Ok(Record::of(interruptible(py, move |_| simulate(&settings))?, Vec::new()))
    }

    fn __repr__(&self) -> String {
        let Settings { plant, duration, dt, .. } = &*self.settings;
        let names = self.filters().join(", ");
        format!("<Scenario of {}, {duration} s in steps of {dt} s, with {names}>", plant.kind.name())
    }
}

/// Keywords as a document, and those that are addresses of numbers.
fn keywords(settings: Option<&Bound<'_, PyDict>>) -> PyResult<(Document, Vec<(String, Document)>)> {
    let (mut over, mut addressed) = (json!({}), Vec::new());
    for (key, value) in settings.into_iter().flat_map(|settings| settings.iter()) {
        let (key, value): (String, _) = (key.extract()?, to_document(&value)?);
        match key.as_str() {
            _ if key.contains('.') => addressed.push((key, value)),
            "equation" => merge(&mut over, &json!({ "plant": { "equation": value } })),
            _ => merge(&mut over, &json!({ key: value })),
        }
    }
    Ok((over, addressed))
}

fn document_of(source: &Bound<'_, PyAny>) -> PyResult<Document> {
    if let Ok(scenario) = source.cast::<Scenario>() {
        return written(&*scenario.get().settings).map_err(error);
    }
    if source.is_instance_of::<PyDict>() {
        return to_document(source);
    }
    let text = match source.extract::<String>() {
        Ok(text) if text.is_empty() || text.contains(['=', '\n']) => text,
        _ => {
            let path: PathBuf = source.extract()?;
            std::fs::read_to_string(&path).map_err(|reason| error(format_args!("{}: {reason}", path.display())))?
        }
    };
    // An error of a text has its line; below there are paths only.
    Settings::from_toml(&text).map_err(error)?;
    from_toml(&text).map_err(error)
}

/// Lays one document over another: tables key by key, lists of tables of equal length one by one. A filter of another kind has its name.
fn merge(under: &mut Document, over: &Document) {
    match (under, over) {
        (Document::Object(under), Document::Object(over)) => {
            if over.get("kind").is_some_and(|kind| under.get("kind") != Some(kind)) {
                under.remove("name");
            }
            for (key, value) in over {
                merge(under.entry(key).or_insert(Document::Null), value);
            }
        }
        (Document::Array(under), Document::Array(over))
            if under.len() == over.len() && over.iter().all(Document::is_object) =>
        {
            under.iter_mut().zip(over).for_each(|(under, over)| merge(under, over));
        }
        (under, over) => *under = over.clone(),
    }
}

fn read(mut document: Document) -> PyResult<(Settings, Vec<String>)> {
    name_sensors(&mut document)?;
    Settings::from_document_with_remarks(&document).map_err(error)
}

/// Writes `sensor_std` by names of sensors as the list in their order; a sensor without one has the true noise.
fn name_sensors(document: &mut Document) -> PyResult<()> {
    let sensors = document.get("sensors").map_or(Ok(Settings::default().sensors), document::read::<Vec<Sensor>>);
    let sensors = sensors.map_err(error)?;
    let names: Vec<&str> = sensors.iter().map(|sensor| sensor.measures.key()).collect();
    let filters = document.get_mut("filters").and_then(Document::as_array_mut).into_iter().flatten();
    for (place, filter) in filters.enumerate() {
        let Some(Document::Object(by_name)) = filter.get("sensor_std").cloned() else { continue };
        if let Some(unknown) = by_name.keys().find(|name| !names.contains(&name.as_str())) {
            let names = names.join("`, `");
            return Err(error(format_args!("`filters[{place}].sensor_std.{unknown}`: the sensors are `{names}`")));
        }
        let own = |sensor: &Sensor| by_name.get(sensor.measures.key()).cloned().unwrap_or(sensor.noise_std.into());
        filter["sensor_std"] = Document::from_iter(sensors.iter().map(own));
    }
    Ok(())
}
