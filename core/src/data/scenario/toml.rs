//! Scenarios as TOML files.

use super::{Scenario, ScenarioError};
use crate::data::document;

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
