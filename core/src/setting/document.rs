//! Scenarios as documents: the contents of a file of any format, and of TOML files; and the reasons why they are none.

use crate::document::{self, Document, DocumentError};
use kalmanscope_filters::Quantity;

use crate::scenario::{Scenario, ScenarioError, Sensor, Values};

impl Scenario {
    /// Reads a scenario from a document and checks it: what [`Self::from_toml`] does, for any format.
    ///
    /// # Errors
    /// Those of [`Self::from_toml`], without the line.
    pub fn from_document(document: &Document) -> Result<Self, ScenarioError> {
        Self::read(document, |error| error).map(|(scenario, _)| scenario)
    }

    /// Reads a document; `locate` adds to an error its place in the text that the document was read from.
    fn read(
        document: &Document,
        locate: impl FnOnce(DocumentError) -> DocumentError,
    ) -> Result<(Self, Vec<String>), ScenarioError> {
        if !document.is_object() {
            return Err(locate(DocumentError::new("expected a table")).into());
        }
        let mut scenario: Self = document::read(document).map_err(locate)?;
        if document.get("sensors").is_none() {
            scenario.take_sensors_of_record();
        }
        let mut remarks = scenario.part_names();
        scenario.fill_in();
        scenario.validate()?;
        scenario.read_draws()?;
        remarks.extend(scenario.assumed_parameters());
        Ok((scenario, remarks))
    }

    fn take_sensors_of_record(&mut self) {
        let Some(record) = self.record.as_ref().filter(|record| !record.sensors.is_empty()) else { return };
        let usual = |quantity: Quantity| quantity.aspect().info().usual_noise;
        let sensors = record.sensors.keys();
        self.sensors = sensors.map(|&measures| Sensor::new(measures, usual(measures))).collect();
    }

    fn as_written(&self) -> Self {
        let mut scenario = self.clone();
        let (truth, input) = (&scenario.plant.kind, scenario.input);
        let are_in_order = (1..).zip(&scenario.filters).all(|(number, filter)| filter.id == number);
        for filter in &mut scenario.filters {
            if are_in_order {
                filter.id = 0;
            }
            let model = filter.model(truth, input);
            let channels = model.channels();
            filter.initial_mean = filter.initial_mean.written_over(&Values::INITIAL_MEAN, channels);
            filter.initial_std = filter.initial_std.written_over(&Values::INITIAL_STD, channels);
            filter.process_std = filter.process_std.written_over(&Values::PROCESS_STD, channels);
        }
        scenario
    }

    /// Reads a scenario file and checks it.
    ///
    /// # Errors
    /// [`ScenarioError::Syntax`] where the text is not TOML, or has an unknown key or a value of the wrong type;
    /// [`ScenarioError::Value`] where [`Self::validate`] finds an impossible value.
    pub fn from_toml(text: &str) -> Result<Self, ScenarioError> {
        Self::from_toml_with_remarks(text).map(|(scenario, _)| scenario)
    }

    /// The same, with a sentence for each filter that gets another name, and one for assumed parameters.
    ///
    /// # Errors
    /// Those of [`Self::from_toml`].
    pub fn from_toml_with_remarks(text: &str) -> Result<(Self, Vec<String>), ScenarioError> {
        Self::read(&document::from_toml(text)?, |error| error.in_toml(text))
    }

    /// The scenario as a file that [`Self::from_toml`] reads back to an equal one.
    ///
    /// # Errors
    /// [`ScenarioError::Syntax`] where TOML cannot express it, which no valid scenario causes.
    pub fn to_toml(&self) -> Result<String, ScenarioError> {
        // The detour over a table puts subtables after plain values.
        Ok(document::to_toml(&self.as_written())?)
    }
}
