//! The map that a step shows in the laboratory.

use kalmanscope_core::{Measure, Scenario};
use serde::Deserialize;

use crate::LessonError;
use crate::grid::{axis, check_corners};

/// A map over two settings, in the words of the laboratory.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Map {
    /// The setting across, written as `KEY=FROM:TO:COUNT`, with `:log` behind it for equal ratios. A setting of filters has `*`
    /// for their names: all filters of the map get the value.
    pub x: String,
    /// The setting up.
    pub y: String,
    /// The score, such as `rmse.natural_frequency`.
    pub measure: Measure,
    /// The filter's name.
    pub filter: String,
    /// The name of a second filter beside it.
    pub second: Option<String>,
}

impl Map {
    /// Checks that the scenario has filters and settings of the map.
    ///
    /// # Errors
    /// [`LessonError`] where the scenario lacks one of them.
    pub(crate) fn validate(&self, scenario: &Scenario) -> Result<(), LessonError> {
        if let Some(name) = self.missing_filter(scenario) {
            return Err(LessonError::UnknownFilter(name.clone()));
        }
        check_corners(scenario, &[axis(&self.x)?, axis(&self.y)?])
    }

    /// The name of a filter that the scenario lacks, if it lacks one: the step's change may have to add it first.
    pub fn missing_filter(&self, scenario: &Scenario) -> Option<&String> {
        let mut names = [Some(&self.filter), self.second.as_ref()].into_iter().flatten();
        names.find(|name| !scenario.filters.iter().any(|filter| filter.name == **name))
    }
}
