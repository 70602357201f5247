//! A setting to turn, as data.

use toml::{Table, Value};

use crate::scenario::address;
use crate::{Document, Scenario, ScenarioError};

/// An edit of a scenario: a key and its new value.
///
/// ```
/// use kalmanscope_core::Scenario;
/// use kalmanscope_core::diagnosis::Knob;
/// # fn main() -> Result<(), kalmanscope_core::ScenarioError> {
/// let scenario = Scenario::default();
/// let knob = Knob::of_filter(scenario.filters[0].id, "fading", 1.02);
/// assert_eq!((knob.key.as_str(), knob.toml_line().as_str()), ("filters#1.fading", "fading = 1.02"));
/// assert_eq!(knob.apply(&scenario)?.filters[0].fading, 1.02);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Knob {
    /// The setting's address, as in `filters#1.process_std.velocity` or `hold`: that of a filter is by the filter's id.
    pub key: String,
    /// Its new value.
    pub value: Value,
}

impl Knob {
    /// A setting of the scenario.
    pub fn new(key: &str, value: impl Into<Value>) -> Self {
        Self { key: key.to_owned(), value: value.into() }
    }

    /// A setting of the filter with an id.
    pub fn of_filter(id: u32, key: &str, value: impl Into<Value>) -> Self {
        Self { key: address::of_filter(id, key), value: value.into() }
    }

    /// The line to write into a scenario file: into the table of the filter whose setting it is ([`Self::filter`]), or at
    /// the top.
    pub fn toml_line(&self) -> String {
        format!("{} = {}", self.inner(), self.value)
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
            let inner = knob.inner();
            let outer = inner.split('.').next().unwrap_or(inner);
            let name = knob.place(scenario).and_then(|place| Some(scenario.filters.get(place)?.name.clone()));
            // A setting that is back at its default has no line in the file.
            let value = knob.table(&mut file, scenario).and_then(|table| table.get(outer));
            let value = value.filter(|value| outer == inner || value.is_table());
            let line = value.map_or_else(|| knob.toml_line(), |value| format!("{outer} = {value}"));
            let line = (name, line);
            if !lines.contains(&line) {
                lines.push(line);
            }
        }
        Ok(lines)
    }

    /// The id of the filter whose setting it is, if it is one of a filter.
    pub fn filter(&self) -> Option<u32> {
        address::split_id(&self.key).map(|(id, _)| id)
    }

    /// The key within the table of the filter, or of the scenario.
    fn inner(&self) -> &str {
        address::split_id(&self.key).map_or(&self.key, |(_, key)| key)
    }

    /// The place of the filter in a scenario.
    fn place(&self, scenario: &Scenario) -> Option<usize> {
        self.filter().and_then(|_| scenario.filters_at(&self.key))?.0.first().copied()
    }

    /// The table in a scenario's file in which the setting is. `None` if the scenario has no such filter.
    fn table<'a>(&self, file: &'a mut Table, scenario: &Scenario) -> Option<&'a mut Table> {
        if self.filter().is_none() {
            return Some(file);
        }
        file.get_mut("filters")?.as_array_mut()?.get_mut(self.place(scenario)?)?.as_table_mut()
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
            let unknown = || {
                let instead = scenario.filters_instead_of(&knob.key);
                ScenarioError::Syntax(format!("the scenario has no setting `{}`{instead}", knob.key))
            };
            set(knob.table(&mut file, scenario).ok_or_else(unknown)?, knob.inner(), &knob.value);
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
        let [ekf, ukf] = [scenario.filters[0].id, scenario.filters[1].id];
        let knobs = [
            Knob::new("hold", "first"),
            Knob::of_filter(ukf, "process_std.velocity", 0.5),
            Knob::of_filter(ukf, "sensor_std", vec![0.1, 0.2]),
            Knob::of_filter(ekf, "plant", "duffing"),
            Knob::of_filter(ekf, "augment", vec!["input_gain"]),
        ];
        let turned = Knob::apply_all(&knobs, &scenario).unwrap();
        assert_eq!((turned.hold, turned.filters[0].plant), (Hold::First, Some(PlantKind::DUFFING)));
        assert_eq!(turned.filters[0].augment, [Channel::INPUT_GAIN]);
        assert_eq!(turned.filters[1].process_std[Channel::VELOCITY], 0.5);
        assert_eq!(turned.filters[1].sensor_std, [0.1, 0.2]);
        assert_eq!(knobs[1].toml_line(), "process_std.velocity = 0.5");
        assert_eq!((knobs[2].toml_line().as_str(), knobs[2].filter()), ("sensor_std = [0.1, 0.2]", Some(ukf)));
        let rounded = Knob::of_filter(ekf, "sensor_std", vec![0.012_345_678, 1.005]).rounded();
        assert_eq!(rounded.toml_line(), "sensor_std = [0.01235, 1.005]");
        // A filter is found whatever it is called by now.
        let mut renamed = scenario.clone();
        (renamed.filters[0].name, renamed.filters[1].name) = ("UKF, no. 2".to_owned(), "EKF".to_owned());
        let turned = Knob::of_filter(ekf, "fading", 1.5).apply(&renamed).unwrap();
        assert_eq!((turned.filters[0].fading, turned.filters[1].fading), (1.5, scenario.filters[1].fading));
        renamed.filters[1].id = ekf;
        assert!(Knob::of_filter(ekf, "fading", 1.0).apply(&renamed).is_err(), "which of the two?");
        let lines = Knob::toml_lines(&knobs, &scenario).unwrap();
        assert_eq!(lines.len(), 5);
        assert_eq!((&lines[0].0, lines[0].1.as_str()), (&None, "hold = \"first\""));
        // A file takes each line in place of its own, which is a table in one line.
        let (name, line) = &lines[1];
        assert_eq!(name.as_deref(), Some("UKF, no. 2"));
        let line: toml::Table = toml::from_str(line).unwrap();
        assert_eq!(line["process_std"]["velocity"].as_float(), Some(0.5));
        assert!(line["process_std"].as_table().unwrap().len() >= 4, "{line}");
        for wrong in [Knob::of_filter(9, "fading", 1.0), Knob::of_filter(ekf, "fadng", 1.0)] {
            assert!(matches!(wrong.apply(&scenario), Err(ScenarioError::Syntax(_))), "{wrong:?}");
        }
    }
}
