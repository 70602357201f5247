//! A setting and its new value.

use crate::document::{self, Document, json};
use kalmanscope_filters::lists::mapped;
use kalmanscope_filters::quantity::Quantity;
use toml::Value;

use super::{SENSOR_STD, TableInfo};
use crate::scenario::{Scenario, ScenarioError, address};

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
    /// The setting's address, by the filter's id as in `filters#1.process_std.velocity` where the program writes it. In what people
    /// write, the filter's name may stand in place of the id and `*` for all filters: `filters.EKF.fading`. Any key of a scenario
    /// file is one, such as `hold` or `record.input.offset`; a sensor is meant by its quantity.
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
        Self { key: address::of_filter(id, key), value: value.into() }
    }

    /// The line to write into a scenario file: into the table of the filter whose setting it is, or at the top.
    pub fn toml_line(&self) -> String {
        format!("{} = {}", self.inner(), self.value)
    }

    /// The address below the filter or the sensor.
    pub fn inner(&self) -> &str {
        address::split_id(&self.key).map_or(&self.key, |(_, key)| key)
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
        edits.iter().try_for_each(|edit| edit.put(&mut document, scenario))?;
        Scenario::from_document(&document)
    }

    pub(super) fn put(&self, document: &mut Document, scenario: &Scenario) -> Result<(), ScenarioError> {
        let value = document::of(&self.value)?;
        if let Some(error) = document::not_finite(&value) {
            return Err(ScenarioError::Syntax(format!("`{}`: {error}", self.key)));
        }
        put(document, scenario, &self.key, &value, &scenario.filters_instead_of(&self.key))
    }
}

/// Sets a value, also under a new key, since a file leaves out defaults. `instead` ends the error where there is no place for the value.
pub(super) fn put(
    document: &mut Document,
    scenario: &Scenario,
    address: &str,
    value: &Document,
    instead: &str,
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
        return Err(no_setting(address, instead));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PlantKind;
    use kalmanscope_filters::{Channel, Hold};

    #[test]
    fn edits_are_turned_by_their_keys() {
        let mut scenario = Scenario::default();
        scenario.filters[1].name = "UKF, no. 2".to_owned();
        let [ekf, ukf] = [scenario.filters[0].id, scenario.filters[1].id];
        let edits = [
            Edit::new("hold", "first"),
            Edit::of_filter(ukf, "process_std.velocity", 0.5),
            Edit::of_filter(ukf, "sensor_std", vec![0.1, 0.2]),
            Edit::of_filter(ekf, "plant", "duffing"),
            Edit::of_filter(ekf, "augment", vec!["input_gain"]),
        ];
        let turned = Edit::apply_all(&edits, &scenario).unwrap();
        assert_eq!((turned.hold, turned.filters[0].plant.clone()), (Hold::First, Some(PlantKind::DUFFING)));
        assert_eq!(turned.filters[0].augment, [Channel::INPUT_GAIN]);
        assert_eq!(turned.filters[1].process_std[Channel::VELOCITY], 0.5);
        assert_eq!(turned.filters[1].sensor_std, [0.1, 0.2]);
        assert_eq!(edits[1].toml_line(), "process_std.velocity = 0.5");
        assert_eq!(edits[2].toml_line(), "sensor_std = [0.1, 0.2]");
        let rounded = Edit::of_filter(ekf, "sensor_std", vec![0.012_345_678, 1.005]).rounded();
        assert_eq!(rounded.toml_line(), "sensor_std = [0.01235, 1.005]");
        let mut renamed = scenario.clone();
        (renamed.filters[0].name, renamed.filters[1].name) = ("UKF, no. 2".to_owned(), "EKF".to_owned());
        let turned = Edit::of_filter(ekf, "fading", 1.5).apply(&renamed).unwrap();
        assert_eq!((turned.filters[0].fading, turned.filters[1].fading), (1.5, scenario.filters[1].fading));
        renamed.filters[1].id = ekf;
        assert!(Edit::of_filter(ekf, "fading", 1.0).apply(&renamed).is_err(), "which of the two?");
    }

    #[test]
    fn every_kind_of_place_can_be_edited() {
        let scenario = Scenario::default();
        let table = |text: &str| Value::Table(text.parse().unwrap());
        let edits = [
            Edit::new("plant.natural_frequency", table("step = { from = 1.0, to = 2.0, at = 3.0 }")),
            Edit::new("force", "none"),
            Edit::new("duration", 10),
            Edit::new("sensors.velocity.noise_std", 0.2),
            Edit::new("filters.*.fading", 1),
            Edit::new("filters.EKF.sensor_std.1", 7.0),
            Edit::new("filters.EKF.sensor_std.displacement", 8.0),
            Edit::new("filters.UKF.substeps", 3),
            Edit::new("filters.UKF.name", "U"),
        ];
        let edited = Edit::apply_all(&edits, &scenario).unwrap();
        assert_eq!(edited.plant.parameter(Channel::NATURAL_FREQUENCY).map(|signal| signal.at(2.0)), Some(1.0));
        assert_eq!((edited.force, edited.duration, edited.sensors[1].noise_std), (crate::Force::None, 10.0, 0.2));
        let [ekf, ukf] = &edited.filters[..] else { panic!("two filters") };
        assert_eq!((ekf.fading, &ekf.sensor_std[..], ukf.fading), (1.0, &[8.0, 7.0][..], 1.0));
        assert_eq!((ukf.substeps, ukf.name.as_str()), (3, "U"));
    }

    #[test]
    fn settings_that_there_are_not_cannot_be_edited() {
        let mut scenario = Scenario::default();
        scenario.plant.set(Channel::NATURAL_FREQUENCY, crate::Signal::Constant(6.0));
        let keys = " plnt.natural_frequency plant.frequency plant.natural_frequency.step filters.EKF filters.* filters.KF.fading \
             filters.*.fadng filters.EKF.sensor_std.2 filters.EKF.sensor_std.acceleration sensors.acceleration.noise_std \
             record.every";
        for key in keys.split(' ') {
            let error = Edit::new(key, 1.0).apply(&scenario).unwrap_err().to_string();
            let last = key.rsplit('.').next().unwrap_or_default();
            let is_unread = error.contains(&format!("unknown field `{last}`"));
            assert!(is_unread || error.starts_with(&format!("the scenario has no setting `{key}`")), "{error}");
        }
        let impossible = Edit::new("filters.EKF.fading", 0.5).apply(&scenario).unwrap_err().to_string();
        assert!(impossible.starts_with("`filters[0].fading` is 0.5"), "{impossible}");
    }
}
