//! A setting to turn, as data.

use toml::{Table, Value};

use crate::{Document, Scenario, ScenarioError};

/// An edit of a scenario: a key and its new value.
///
/// ```
/// use kalmanscope_core::Scenario;
/// use kalmanscope_core::diagnosis::Knob;
/// # fn main() -> Result<(), kalmanscope_core::ScenarioError> {
/// let knob = Knob::of_filter("EKF", "fading", 1.02);
/// assert_eq!((knob.key.as_str(), knob.toml_line().as_str()), ("filters.EKF.fading", "fading = 1.02"));
/// assert_eq!(knob.apply(&Scenario::default())?.filters[0].fading, 1.02);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Knob {
    /// The setting's path, as in `filters.EKF.process_std.velocity` or `hold`.
    pub key: String,
    /// Its new value.
    pub value: Value,
}

impl Knob {
    /// A setting of the scenario.
    pub fn new(key: &str, value: impl Into<Value>) -> Self {
        Self { key: key.to_owned(), value: value.into() }
    }

    /// A setting of the filter with a name.
    pub fn of_filter(name: &str, key: &str, value: impl Into<Value>) -> Self {
        Self { key: format!("filters.{name}.{key}"), value: value.into() }
    }

    /// The line to write into a scenario file: into the table of the filter whose setting it is ([`Self::filter`]), or at
    /// the top.
    pub fn toml_line(&self) -> String {
        let inner = self.filter().map_or(self.key.as_str(), |name| &self.key["filters.".len() + name.len() + 1..]);
        format!("{inner} = {}", self.value)
    }

    /// The whole lines that turn some knobs, each with the name of its filter if it is one of a filter's. A table with a number for
    /// each channel is one line, so that it can take the place of that in a file.
    ///
    /// # Errors
    /// As [`Self::apply`].
    pub fn toml_lines(knobs: &[Self], scenario: &Scenario) -> Result<Vec<(Option<String>, String)>, ScenarioError> {
        let mut file = Document::table(&Self::apply_all(knobs, scenario)?)?;
        let mut lines: Vec<(Option<String>, String)> = Vec::new();
        for knob in knobs {
            let name = knob.filter();
            let inner = name.map_or(knob.key.as_str(), |name| &knob.key["filters.".len() + name.len() + 1..]);
            let outer = inner.split('.').next().unwrap_or(inner);
            let table = match name {
                None => Some(&mut file),
                Some(name) => filter_named(&mut file, name),
            };
            // A setting that is back at its default has no line in the file.
            let value = table.and_then(|table| table.get(outer)).filter(|value| outer == inner || value.is_table());
            let line = value.map_or_else(|| knob.toml_line(), |value| format!("{outer} = {value}"));
            let line = (name.map(str::to_owned), line);
            if !lines.contains(&line) {
                lines.push(line);
            }
        }
        Ok(lines)
    }

    /// The name of the filter whose setting it is, if it is one of a filter.
    pub fn filter(&self) -> Option<&str> {
        let rest = self.key.strip_prefix("filters.")?;
        // A setting has one key, or two where it has one for each channel; names may have dots.
        let settings = ["initial_mean.", "initial_std.", "process_std.", "adaptation."];
        let inner = settings.iter().find_map(|setting| rest.rfind(&format!(".{setting}")));
        Some(&rest[..inner.or_else(|| rest.rfind('.'))?])
    }

    /// The knob with numbers of four significant digits, as people read and write them.
    #[must_use]
    pub fn rounded(&self) -> Self {
        Self { key: self.key.clone(), value: rounded(&self.value) }
    }

    /// The scenario with the setting turned.
    ///
    /// # Errors
    /// [`ScenarioError`] where the scenario has no such setting, or not with this value.
    pub fn apply(&self, scenario: &Scenario) -> Result<Scenario, ScenarioError> {
        Self::apply_all(std::slice::from_ref(self), scenario)
    }

    /// The scenario with several settings turned.
    ///
    /// # Errors
    /// As [`Self::apply`].
    pub fn apply_all(knobs: &[Self], scenario: &Scenario) -> Result<Scenario, ScenarioError> {
        let mut file = Document::table(scenario)?;
        for knob in knobs {
            let unknown = || ScenarioError::Syntax(format!("the scenario has no setting `{}`", knob.key));
            let (table, key) = match knob.filter() {
                None => (Some(&mut file), knob.key.as_str()),
                Some(name) => (filter_named(&mut file, name), &knob.key["filters.".len() + name.len() + 1..]),
            };
            set(table.ok_or_else(unknown)?, key, &knob.value);
        }
        let text = toml::to_string(&file).map_err(|error| ScenarioError::Syntax(error.to_string()))?;
        Scenario::from_toml(&text)
    }
}

fn rounded(value: &Value) -> Value {
    match value {
        Value::Float(x) => Value::Float(format!("{x:.3e}").parse().unwrap_or(*x)),
        Value::Array(values) => Value::Array(values.iter().map(rounded).collect()),
        other => other.clone(),
    }
}

/// The filter with a name. `None` if several have it.
fn filter_named<'a>(file: &'a mut Table, name: &str) -> Option<&'a mut Table> {
    let filters = file.get_mut("filters")?.as_array_mut()?;
    let tables = filters.iter_mut().filter_map(Value::as_table_mut);
    let mut called = tables.filter(|table| table.get("name").and_then(Value::as_str) == Some(name));
    let first = called.next()?;
    called.next().is_none().then_some(first)
}

/// Sets a key, or an inner key after a dot. The scenario's reader refuses what it does not know.
fn set(table: &mut Table, key: &str, value: &Value) {
    match key.split_once('.') {
        Some((outer, inner)) => {
            if let Some(table) = table.get_mut(outer).and_then(Value::as_table_mut) {
                table.insert(inner.to_owned(), value.clone());
            }
        }
        None => {
            table.insert(key.to_owned(), value.clone());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Channel, Hold, PlantKind};

    #[test]
    fn knobs_are_turned_by_their_keys() {
        let mut scenario = Scenario::default();
        scenario.filters[1].name = "UKF, no. 2".to_owned();
        let knobs = [
            Knob::new("hold", "first"),
            Knob::of_filter("UKF, no. 2", "process_std.velocity", 0.5),
            Knob::of_filter("UKF, no. 2", "sensor_std", vec![0.1, 0.2]),
            Knob::of_filter("EKF", "plant", "duffing"),
            Knob::of_filter("EKF", "augment", vec!["input_gain"]),
        ];
        let turned = Knob::apply_all(&knobs, &scenario).unwrap();
        assert_eq!((turned.hold, turned.filters[0].plant), (Hold::First, Some(PlantKind::DUFFING)));
        assert_eq!(turned.filters[0].augment, [Channel::INPUT_GAIN]);
        assert_eq!(turned.filters[1].process_std[Channel::VELOCITY], 0.5);
        assert_eq!(turned.filters[1].sensor_std, [0.1, 0.2]);
        assert_eq!(knobs[1].toml_line(), "process_std.velocity = 0.5");
        assert_eq!((knobs[2].toml_line().as_str(), knobs[2].filter()), ("sensor_std = [0.1, 0.2]", Some("UKF, no. 2")));
        let rounded = Knob::of_filter("EKF", "sensor_std", vec![0.012_345_678, 1.005]).rounded();
        assert_eq!(rounded.toml_line(), "sensor_std = [0.01235, 1.005]");
        let mut twice = scenario.clone();
        twice.filters[1].name = "EKF".to_owned();
        assert!(Knob::of_filter("EKF", "fading", 1.0).apply(&twice).is_err(), "which of the two?");
        let lines = Knob::toml_lines(&knobs, &scenario).unwrap();
        assert_eq!(lines.len(), 5);
        assert_eq!((&lines[0].0, lines[0].1.as_str()), (&None, "hold = \"first\""));
        // A file takes each line in place of its own, which is a table in one line.
        let (name, line) = &lines[1];
        assert_eq!(name.as_deref(), Some("UKF, no. 2"));
        let line: toml::Table = toml::from_str(line).unwrap();
        assert_eq!(line["process_std"]["velocity"].as_float(), Some(0.5));
        assert!(line["process_std"].as_table().unwrap().len() >= 4, "{line}");
        for wrong in [Knob::of_filter("PF", "fading", 1.0), Knob::of_filter("EKF", "fadng", 1.0)] {
            assert!(matches!(wrong.apply(&scenario), Err(ScenarioError::Syntax(_))), "{wrong:?}");
        }
    }
}
