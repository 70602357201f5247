//! A setting and its new value.

use crate::document::{self, Document, json};
use kalmanscope_filters::lists::mapped;
use kalmanscope_filters::quantity::Quantity;
use toml::Value;

use super::{SENSOR_STD, TableInfo, filters};
use crate::scenario::{Scenario, ScenarioError};

/// An edit of a scenario: a key and its new value.
#[derive(Clone, Debug, PartialEq)]
pub struct Edit {
    /// The address, by the filter's id where the program writes it, else also by its name; any key of a scenario file is one.
    pub key: String,
    /// Its new value.
    pub value: Value,
}

impl Edit {
    /// A setting of the scenario.
    pub fn new(key: &str, value: impl Into<Value>) -> Self {
        Self { key: key.to_owned(), value: value.into() }
    }

    /// A setting of the filter with an id.
    pub fn of_filter(id: u32, key: &str, value: impl Into<Value>) -> Self {
        Self { key: filters::address(id, key), value: value.into() }
    }

    /// The line to write into a scenario file: into the table of the filter whose setting it is, or at the top.
    pub fn toml_line(&self) -> String {
        format!("{} = {}", self.inner(), self.value)
    }

    /// The address below the filter or the sensor.
    pub fn inner(&self) -> &str {
        filters::split_id(&self.key).map_or(&self.key, |(_, key)| key)
    }

    /// The edit with numbers of four significant digits, as people read and write them.
    #[must_use]
    pub fn rounded(&self) -> Self {
        Self { key: self.key.clone(), value: rounded(&self.value) }
    }

    /// The scenario with the setting edited.
    ///
    /// # Errors
    /// [`ScenarioError`] where the scenario has no such setting, or not with this value.
    pub fn apply(&self, scenario: &Scenario) -> Result<Scenario, ScenarioError> {
        Self::apply_all(std::slice::from_ref(self), scenario)
    }

    /// [`Self::apply`] of several edits, each setting found in the scenario as it is before all of them.
    pub fn apply_all(edits: &[Self], scenario: &Scenario) -> Result<Scenario, ScenarioError> {
        let mut document = document::of(scenario)?;
        edits.iter().try_for_each(|edit| put(&mut document, scenario, &edit.key, &edit.document()?))?;
        Scenario::from_document(&document)
    }

    pub(super) fn document(&self) -> Result<Document, ScenarioError> {
        let value = document::of(&self.value)?;
        match document::not_finite(&value) {
            Some(error) => Err(ScenarioError::Syntax(format!("`{}`: {error}", self.key))),
            None => Ok(value),
        }
    }
}

/// Sets a value, also under a new key, since a file leaves out defaults.
pub(super) fn put(
    document: &mut Document,
    scenario: &Scenario,
    address: &str,
    value: &Document,
) -> Result<(), ScenarioError> {
    let sensor = |key: &str| match Quantity::from_key(key) {
        Some(quantity) => scenario.sensor_place(quantity).map(|at| at.to_string()),
        None => Some(key.to_owned()),
    };
    let mut paths = Vec::new();
    if let Some((places, key)) = scenario.filters_at(address) {
        let (table, entry) = key.split_once('.').unwrap_or((key, ""));
        let key = if table == SENSOR_STD.key && !entry.is_empty() {
            sensor(entry).map(|at| format!("{table}.{at}"))
        } else {
            Some(key.to_owned())
        };
        let is_left_out = TableInfo::from_key(table).is_some_and(|table| !table.is_of_sensors()) && !entry.is_empty();
        for place in places {
            if is_left_out && document["filters"][place][table].is_null() {
                document["filters"][place][table] = json!({});
            }
            paths.extend(key.iter().map(|key| format!("filters.{place}.{key}")));
        }
    } else if let Some((key, rest)) = address.strip_prefix("sensors.").and_then(|rest| rest.split_once('.')) {
        paths.extend(sensor(key).map(|at| format!("sensors.{at}.{rest}")));
    } else if !address.starts_with("filters") {
        paths.push(address.to_owned());
    }
    if paths.is_empty() || !paths.iter().all(|path| document::put(document, path, value)) {
        return Err(no_setting(address, &scenario.filters_instead_of(address)));
    }
    Ok(())
}

pub(super) fn no_setting(address: &str, instead: &str) -> ScenarioError {
    ScenarioError::Syntax(format!("the scenario has no setting `{address}`{instead}"))
}

fn rounded(value: &Value) -> Value {
    match value {
        Value::Float(x) => Value::Float(format!("{x:.3e}").parse().unwrap_or(*x)),
        Value::Array(values) => Value::Array(mapped(values, &rounded)),
        other => other.clone(),
    }
}
