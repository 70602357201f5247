//! The changes that a lesson makes to a scenario.

use kalmanscope_core::document;
use kalmanscope_core::setting::{self, Edit};
use kalmanscope_core::{Quantity, Scenario, ScenarioError, Sensor};
use serde::Deserialize;
use toml::{Table, Value};

use crate::LessonError;

/// Changes to a scenario, made in the order of the fields.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Adjustment {
    /// The text of the button that makes the changes; empty for those before the first step.
    pub label: String,
    /// Filters to remove, by their names.
    pub remove_filters: Vec<String>,
    /// Filters to add, as in a scenario file; `like = "NAME"` copies missing settings from another filter.
    pub add_filters: Vec<Table>,
    /// Sensors to remove.
    pub remove_sensors: Vec<Quantity>,
    /// Sensors to add. Every filter assumes their true noise.
    pub add_sensors: Vec<Sensor>,
    /// Values by their paths, such as `"filters.EKF.fading" = 1.005` or `"filters.*.process_std.natural_frequency" = 1e-3`.
    pub set: Table,
}

impl Adjustment {
    /// The scenario with these changes.
    ///
    /// # Errors
    /// [`LessonError`] where the scenario lacks something to change, or the changed scenario is impossible.
    pub fn apply(&self, scenario: &Scenario) -> Result<Scenario, LessonError> {
        let mut changed = scenario.clone();
        self.change(scenario)?.apply(&mut changed)?;
        changed.validate()?;
        Ok(changed)
    }

    /// These changes as those of a scenario.
    ///
    /// # Errors
    /// [`LessonError`] where the scenario lacks something to change.
    pub fn change(&self, scenario: &Scenario) -> Result<setting::Change, LessonError> {
        let Self { label: _, remove_filters, add_filters, remove_sensors, add_sensors, set } = self;
        let (mut change, mut scenario) = (setting::Change::default(), scenario.clone());
        // Removal comes first, so that an added filter may take the name of one that goes.
        for name in remove_filters {
            let place = scenario.filters.iter().position(|filter| filter.name == *name);
            let filter = scenario.filters.remove(place.ok_or_else(|| LessonError::UnknownFilter(name.clone()))?);
            change.remove_filter(filter.id);
        }
        if !add_filters.is_empty() {
            let mut file = written(&scenario)?;
            for filter in add_filters {
                add_filter(&mut file, filter)?;
            }
            let all = read(&file)?.filters.into_iter().enumerate();
            all.skip(scenario.filters.len()).for_each(|(place, filter)| change.put_filter(place, filter));
        }
        for &quantity in remove_sensors {
            scenario.sensor_place(quantity).ok_or(LessonError::UnknownSensor(quantity))?;
            change.remove_sensor(quantity);
        }
        add_sensors.iter().for_each(|&sensor| change.put_sensor(sensor));
        set.iter().for_each(|(key, value)| change.edit(Edit::new(key, value.clone())));
        Ok(change)
    }

    /// The paths of all settings that are changed, such as `filters.EKF.fading`; of an added filter its name, and of an
    /// added sensor its noise.
    pub fn paths(&self) -> Vec<String> {
        let Self { label: _, remove_filters: _, add_filters, remove_sensors: _, add_sensors, set } = self;
        let name = |filter: &Table| Some(format!("filters.{}.name", filter.get("name")?.as_str()?));
        let filters = add_filters.iter().filter_map(name);
        let sensors = add_sensors.iter().map(|sensor| format!("sensors.{}.noise_std", sensor.measures.key()));
        set.keys().cloned().chain(filters).chain(sensors).collect()
    }
}

fn add_filter(file: &mut Table, filter: &Table) -> Result<(), LessonError> {
    let mut filter = filter.clone();
    let name = filter.get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
    let Some(Value::Array(filters)) = file.get_mut("filters") else {
        return Err(LessonError::AmbiguousFilter(name));
    };
    let called = |name: &str| filters.iter().find(|other| other.get("name").and_then(Value::as_str) == Some(name));
    if name.is_empty() || called(&name).is_some() {
        return Err(LessonError::AmbiguousFilter(name));
    }
    if let Some(like) = filter.remove("like") {
        let like = like.as_str().unwrap_or_default();
        let model = called(like).and_then(Value::as_table);
        let mut model = model.ok_or_else(|| LessonError::UnknownFilter(like.to_owned()))?.clone();
        lay_over(&mut model, &filter);
        filter = model;
    }
    filters.push(Value::Table(filter));
    Ok(())
}

/// Merges a table into another: subtables are merged, other values are replaced.
fn lay_over(below: &mut Table, above: &Table) {
    for (key, value) in above {
        match (below.get_mut(key), value) {
            (Some(Value::Table(below)), Value::Table(above)) => lay_over(below, above),
            _ => {
                below.insert(key.clone(), value.clone());
            }
        }
    }
}

/// The scenario with all its settings, defaults included, so that each has a path.
fn written(scenario: &Scenario) -> Result<Table, LessonError> {
    Ok(document::to_table(scenario).map_err(ScenarioError::from)?)
}

/// The scenario of a table, by way of its text, so that missing settings are filled in and everything is checked.
pub(crate) fn read(file: &Table) -> Result<Scenario, LessonError> {
    let text = toml::to_string(file).map_err(|error| LessonError::Syntax(error.to_string()))?;
    Ok(Scenario::from_toml(&text)?)
}
