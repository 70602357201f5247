//! Scenarios as documents: the contents of a file of any format.

use super::{Scenario, ScenarioError, Sensor, Values};
use crate::{Document, DocumentError, PlantKind, Quantity};

impl Scenario {
    /// Reads a scenario from a document and checks it: what [`Self::from_toml`] does, for any format. Keys, defaults and
    /// allowed values are those of a file.
    ///
    /// ```
    /// use kalmanscope_core::{Document, Scenario};
    /// # fn main() -> Result<(), Box<dyn std::error::Error>> {
    /// let json = Document::from_json(r#"{"duration": 20, "plant": {"natural_frequency": 6}, "filters": [{"kind": "ckf"}]}"#)?;
    /// let by_hand = Document::of_entries([
    ///     ("duration", Document::Number(20.0)),
    ///     ("plant", Document::of_entries([("natural_frequency", Document::Number(6.0))])),
    ///     ("filters", Document::List(vec![Document::of_entries([("kind", Document::from("ckf"))])])),
    /// ]);
    /// let scenario = Scenario::from_document(&json)?;
    /// assert_eq!(scenario, Scenario::from_document(&by_hand)?);
    /// assert_eq!(scenario, Scenario::from_document(&scenario.to_document()?)?);
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`ScenarioError::Syntax`] where the document has an unknown key or a value of the wrong type, with the path of the key;
    /// [`ScenarioError::Value`] where [`Self::validate`] finds an impossible value.
    pub fn from_document(document: &Document) -> Result<Self, ScenarioError> {
        Self::from_document_with_remarks(document).map(|(scenario, _)| scenario)
    }

    /// The same, with a sentence for each filter that has another name than in the document, where two had the same.
    ///
    /// # Errors
    /// Those of [`Self::from_document`].
    pub fn from_document_with_remarks(document: &Document) -> Result<(Self, Vec<String>), ScenarioError> {
        Self::read(document, |error| error)
    }

    /// The scenario as a document that [`Self::from_document`] reads back to an equal one.
    ///
    /// # Errors
    /// [`ScenarioError::Syntax`] where a document cannot express it, which no valid scenario causes.
    pub fn to_document(&self) -> Result<Document, ScenarioError> {
        Ok(Document::of(&self.as_written())?)
    }

    /// Reads a document; `locate` adds to an error its place in the text that the document was read from.
    pub(super) fn read(
        document: &Document,
        locate: impl FnOnce(DocumentError) -> DocumentError,
    ) -> Result<(Self, Vec<String>), ScenarioError> {
        let Document::Table(_) = document else { return Err(locate(document.mismatch(&"a table")).into()) };
        know_equations(document);
        let mut scenario: Self = document.read().map_err(locate)?;
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

    /// A scenario that names a record and no sensors has those of the record.
    fn take_sensors_of_record(&mut self) {
        let Some(record) = self.record.as_ref().filter(|record| !record.sensors.is_empty()) else { return };
        let usual = |quantity: Quantity| quantity.aspect().info().usual_noise;
        let sensors = record.sensors.keys();
        self.sensors = sensors.map(|&measures| Sensor::new(measures, usual(measures))).collect();
    }

    /// The scenario without channels that no plant of it has, numbers with their default value, and ids that equal the
    /// filters' places.
    pub(super) fn as_written(&self) -> Self {
        let mut scenario = self.clone();
        let (truth, input) = (scenario.plant.kind, scenario.input);
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
