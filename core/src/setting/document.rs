//! Scenarios as documents, of any format and of TOML, and the members of the populations that they describe.

use std::collections::BTreeMap;

use crate::document::{self, Document, DocumentError};
use kalmanscope_filters::Quantity;
use kalmanscope_filters::random::{Normal, Purpose};
use kalmanscope_records::hash::Hash;

use super::{Address, DT, DURATION, SEED};
use crate::scenario::{Law, Scenario, ScenarioError, Sensor, Values, short};

impl Scenario {
    /// [`Self::from_toml`] for a document of any format; errors are without the line.
    pub fn from_document(document: &Document) -> Result<Self, ScenarioError> {
        Self::from_document_with_remarks(document).map(|(scenario, _)| scenario)
    }

    /// The same, with the sentences of [`Self::from_toml_with_remarks`].
    ///
    /// # Errors
    /// Those of [`Self::from_document`].
    pub fn from_document_with_remarks(document: &Document) -> Result<(Self, Vec<String>), ScenarioError> {
        Self::read(document, |error| error)
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

    /// [`Self::from_toml`] with a sentence for each filter that gets another name, and one for assumed parameters.
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

    /// The member of the population with a seed, with its drawn numbers, each of a stream of its own; it may be impossible.
    #[must_use]
    pub fn member(&self, seed: u64) -> Self {
        let mut member = Self { seed, draw: BTreeMap::new(), ..self.clone() };
        for (address, value) in self.drawn(seed) {
            address.set(&mut member, value);
        }
        member
    }

    /// The drawn numbers of the member with a seed, in the order of their keys. A key that names no number draws none.
    pub fn drawn(&self, seed: u64) -> Vec<(Address, f64)> {
        let one = |(key, law): (&String, &Law)| {
            let address = Address::parse(self, key).ok()?;
            let mut hash = Hash::default();
            hash.add(address.key.as_bytes());
            let value = short(law.draw(&mut Normal::new(seed, Purpose::Draw(hash.value()))));
            let value = address.rounded(value);
            Some((address, value))
        };
        self.draw.iter().filter_map(one).collect()
    }

    /// Leaves out draws of numbers that the scenario lacks, and writes the keys of the others by the ids of filters.
    pub fn keep_draws(&mut self) {
        for (key, law) in std::mem::take(&mut self.draw) {
            if let Ok(address) = Address::parse(self, &key) {
                self.draw.insert(address.key, law);
            }
        }
    }

    fn read_draws(&mut self) -> Result<(), ScenarioError> {
        if self.draw.is_empty() {
            return Ok(());
        }
        let mut numbered = self.clone();
        numbered.number_filters();
        for key in self.draw.keys() {
            let unknown = |error| ScenarioError::Syntax(format!("draw: {error}"));
            let address = Address::parse(&numbered, key).map_err(unknown)?;
            // A population has one clock, and the seed is that of the member.
            if [SEED.key, DT.key, DURATION.key].contains(&&*address.key) {
                return Err(ScenarioError::Syntax(format!(
                    "draw: `{key}` is the same for all members of a population"
                )));
            }
        }
        numbered.keep_draws();
        self.draw = numbered.draw;
        Ok(())
    }
}
