//! A setting and its new value, also in words, as a button says them.

use crate::document::{self, Document, json};
use kalmanscope_filters::lists::mapped;
use kalmanscope_filters::quantity::Quantity;
use toml::Value;

use super::{
    CHOICES_OF_FILTER, CHOICES_OF_SCENARIO, SENSOR_DELAY, SENSOR_STD, TableInfo, filters, name, of_filter, of_scenario,
};
use crate::PlantKind;
use crate::scenario::{FilterSettings, Scenario, ScenarioError, Sensor};

/// A σ that is at least this many times the present one leaves its sensor out.
const LEFT_OUT: f64 = 500.0;

/// An edit of a scenario: a key and its new value.
///
/// ```
/// use kalmanscope_core::Scenario;
/// use kalmanscope_core::setting::Edit;
/// # fn main() -> Result<(), kalmanscope_core::ScenarioError> {
/// let scenario = Scenario::default();
/// let edit = Edit::of_filter(scenario.filters[0].id, "fading", 1.02);
/// assert_eq!((edit.key.as_str(), edit.toml_line().as_str()), ("filters#1.fading", "fading = 1.02"));
/// assert_eq!(edit.apply(&scenario)?.filters[0].fading, 1.02);
/// # Ok(())
/// # }
/// ```
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

    /// The scenario with several edits made, each setting found in the scenario as it is before all of them.
    ///
    /// # Errors
    /// As [`Self::apply`].
    pub fn apply_all(edits: &[Self], scenario: &Scenario) -> Result<Scenario, ScenarioError> {
        let mut document = document::of(scenario)?;
        edits.iter().try_for_each(|edit| put(&mut document, scenario, &edit.key, &edit.document()?))?;
        Scenario::from_document(&document)
    }

    /// The edit in words and symbols, without the name of a filter; one without words is the line of a file.
    pub fn in_words(&self, scenario: &Scenario) -> String {
        let filter = scenario.filters_at(&self.key).and_then(|(places, _)| scenario.filters.get(*places.first()?));
        let words = match filter {
            Some(filter) => self.of_filter_in_words(filter, scenario),
            None => self.of_scenario_in_words(),
        };
        words.unwrap_or_else(|| self.toml_line())
    }

    fn of_filter_in_words(&self, filter: &FilterSettings, scenario: &Scenario) -> Option<String> {
        let key = self.inner();
        match (key, &self.value) {
            ("augment", Value::Array(wanted)) => {
                let wanted = wanted.iter().filter_map(|key| scenario.channel(key.as_str()?));
                let new: Vec<String> = wanted
                    .filter(|channel| !filter.augment.contains(channel))
                    .map(|channel| format!("the {}", channel.name()))
                    .collect();
                Some(if new.is_empty() {
                    "estimate nothing more".to_owned()
                } else {
                    format!("estimate {}", new.join(" and "))
                })
            }
            ("plant", Value::String(kind)) => Some(format!("choose the plant: {}", PlantKind::from_key(kind)?.name())),
            ("plant", Value::Table(plant)) => Some(format!("choose the equation {}", plant.get("equation")?.as_str()?)),
            ("sensor_std", Value::Array(stds)) => {
                let is_left_out = |(std, own): (&Value, &f64)| std.as_float().is_some_and(|std| std >= LEFT_OUT * own);
                if let Some(place) = stds.iter().zip(&filter.sensor_std).position(is_left_out) {
                    return Some(format!("leave out the {}", scenario.sensors.get(place)?.measures.name()));
                }
                Some(format!("set {} {}", SENSOR_STD.symbol, of_sensors(scenario, stds, "", |_| true)?))
            }
            ("sensor_delay", Value::Array(delays)) => {
                let before = |place: usize| filter.sensor_delay.get(place).copied().unwrap_or(0.0);
                let changes = |place: usize| delays[place].as_float() != Some(before(place));
                Some(format!("set the {} {}", SENSOR_DELAY.symbol, of_sensors(scenario, delays, " s", changes)?))
            }
            (_, Value::Boolean(on)) => {
                let info = of_filter().find(|info| info.key == key)?;
                let label = (info.label)(filter).unwrap_or(info.name);
                Some(if *on { label.to_owned() } else { format!("no {label}") })
            }
            _ => {
                if let Some(info) = CHOICES_OF_FILTER.into_iter().find(|info| info.key == key) {
                    return Some(format!("{}: {}", info.name, info.name_of(&self.value)?));
                }
                if of_filter().any(|info| info.key == key) {
                    return Some(format!("set {} = {}", name(scenario, key), number(&self.value)?));
                }
                let (table, entry) = TableInfo::entry(key, &|key| scenario.channel(key), &Quantity::from_key)?;
                Some(format!("set {} of {} = {}", table.symbol, entry.symbol(), number(&self.value)?))
            }
        }
    }

    fn of_scenario_in_words(&self) -> Option<String> {
        if let Some(info) = CHOICES_OF_SCENARIO.into_iter().find(|info| info.key == self.key) {
            return Some(format!("{}: {}", info.name, info.name_of(&self.value)?));
        }
        let info = of_scenario().find(|info| info.key == self.key)?;
        Some(format!("set {} = {}", info.name, number(&self.value)?))
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

fn of_sensors(scenario: &Scenario, values: &[Value], unit: &str, counts: impl Fn(usize) -> bool) -> Option<String> {
    let all = scenario.sensors.iter().zip(values).enumerate().filter(|(place, _)| counts(*place));
    let one = |(_, (sensor, value)): (usize, (&Sensor, &Value))| {
        Some(format!("of {} = {}{unit}", sensor.measures.symbol(), number(value)?))
    };
    Some(all.map(one).collect::<Option<Vec<String>>>()?.join(", "))
}

fn number(value: &Value) -> Option<String> {
    let value = value.as_float().or_else(|| value.as_integer().map(|whole| whole as f64))?;
    let text = format!("{value:.2e}");
    text.parse::<f64>().ok().map(|short| short.to_string())
}
