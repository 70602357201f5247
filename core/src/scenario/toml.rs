//! Scenarios as TOML files.

mod write;

use super::{Scenario, ScenarioError, Sensor};
use crate::{Document, PlantKind, Quantity};

impl Scenario {
    /// Reads a scenario file and checks it.
    ///
    /// # Errors
    /// [`ScenarioError::Syntax`] where the text is not TOML, or has an unknown key or a value of the wrong type;
    /// [`ScenarioError::Value`] where [`Self::validate`] finds an impossible value.
    pub fn from_toml(text: &str) -> Result<Self, ScenarioError> {
        Self::from_toml_with_remarks(text).map(|(scenario, _)| scenario)
    }

    /// The same, with a sentence for each filter that has another name than in the file, where two had the same, and one for
    /// names of an equation that are taken for parameters.
    ///
    /// # Errors
    /// Those of [`Self::from_toml`].
    pub fn from_toml_with_remarks(text: &str) -> Result<(Self, Vec<String>), ScenarioError> {
        let document = Document::from_toml(text)?;
        know_equations(&document);
        let mut scenario: Self = document.read().map_err(|error| error.in_toml(text))?;
        if document.get("sensors").is_none() {
            scenario.take_sensors_of_record();
        }
        let mut remarks = scenario.part_names();
        scenario.fill_in();
        scenario.validate()?;
        remarks.extend(scenario.assumed_parameters());
        Ok((scenario, remarks))
    }

    /// A scenario that names a record and no sensors has those of the record.
    fn take_sensors_of_record(&mut self) {
        let Some(record) = self.record.as_ref().filter(|record| !record.sensors.is_empty()) else { return };
        let usual = |quantity: Quantity| quantity.aspect().info().usual_noise;
        let sensors = record.sensors.keys();
        self.sensors = sensors.map(|&measures| Sensor { measures, noise_std: usual(measures) }).collect();
    }

    /// The scenario as a file that [`Self::from_toml`] reads back to an equal one.
    ///
    /// # Errors
    /// [`ScenarioError::Syntax`] where TOML cannot express it, which no valid scenario causes.
    pub fn to_toml(&self) -> Result<String, ScenarioError> {
        write::text(self)
    }
}

/// Reads the equations of a document, so that their parameters are known wherever they stand in the file. One that is none is
/// said where it is read.
fn know_equations(document: &Document) {
    if document.get("equation").is_some() {
        let entry = |key: &str| document.get(key).map(|value| (key.to_owned(), value.clone()));
        let alone = Document::of_entries(entry("equation").into_iter().chain(entry("parameters")));
        if let Ok(settings) = alone.read() {
            let _known = PlantKind::of_equation(&settings);
        }
    }
    document.children().for_each(know_equations);
}
