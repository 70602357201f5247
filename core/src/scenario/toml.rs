//! Scenarios as TOML files.

mod write;

use super::{Scenario, ScenarioError, Sensor};
use crate::Quantity;

impl Scenario {
    /// Reads a scenario file and checks it.
    ///
    /// # Errors
    /// [`ScenarioError::Syntax`] where the text is not TOML, or has an unknown key or a value of the wrong type;
    /// [`ScenarioError::Value`] where [`Self::validate`] finds an impossible value.
    pub fn from_toml(text: &str) -> Result<Self, ScenarioError> {
        let syntax = |error: toml::de::Error| ScenarioError::Syntax(error.to_string().trim_end().to_owned());
        let document = toml::Deserializer::parse(text).map_err(syntax)?;
        let mut scenario: Self = serde_path_to_error::deserialize(document).map_err(|error| {
            let (path, error) = (error.path().to_string(), error.into_inner());
            ScenarioError::Syntax(message(text, &path, &error))
        })?;
        scenario.take_sensors_of_record(text);
        scenario.fill_in();
        scenario.validate()?;
        Ok(scenario)
    }

    /// A scenario that names a record and no sensors has those of the record.
    fn take_sensors_of_record(&mut self, text: &str) {
        let Some(record) = self.record.as_ref().filter(|record| !record.sensors.is_empty()) else { return };
        let has_sensors = text.parse::<toml::Table>().is_ok_and(|table| table.contains_key("sensors"));
        if !has_sensors {
            let usual = |quantity: Quantity| quantity.aspect().info().usual_noise;
            let sensors = record.sensors.keys();
            self.sensors = sensors.map(|&measures| Sensor { measures, noise_std: usual(measures) }).collect();
        }
    }

    /// The scenario as a file that [`Self::from_toml`] reads back to an equal one.
    ///
    /// # Errors
    /// [`ScenarioError::Syntax`] where TOML cannot express it, which no valid scenario causes.
    pub fn to_toml(&self) -> Result<String, ScenarioError> {
        write::text(self).map_err(|e| ScenarioError::Syntax(e.to_string()))
    }
}

/// The message for TOML that is not a scenario: the line, the key's path and the reason.
fn message(text: &str, path: &str, error: &toml::de::Error) -> String {
    let reason = error.message();
    match error.span() {
        Some(span) => {
            let line = 1 + text.bytes().take(span.start).filter(|&byte| byte == b'\n').count();
            format!("line {line}: `{path}`: {reason}")
        }
        None => format!("`{path}`: {reason}"),
    }
}
