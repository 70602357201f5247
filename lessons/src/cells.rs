//! The grid of a check over cells.

use kalmanscope_core::setting::SEED;
use kalmanscope_core::{Axis, Scenario};
use serde::Deserialize;

use crate::LessonError;
use crate::grid;
use crate::limits::Limits;
use crate::value::Expected;

/// A grid of settings around those of a step, and the limits of the measure in a cell. A check over cells is about the share of
/// the cells in which the measure keeps within them.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Cells {
    /// A setting, written as `KEY=FROM:TO:COUNT`, with `:log` behind it for equal ratios.
    pub x: String,
    /// Another setting.
    pub y: Option<String>,
    /// The measure must be above this in the cell.
    pub above: Option<f64>,
    /// The measure must be below this in the cell.
    pub below: Option<f64>,
    /// The word must be this in the cell.
    pub is: Option<Expected>,
}

impl Cells {
    /// The limits of the measure in a cell.
    pub(crate) fn limits(&self) -> Limits<'_> {
        Limits { above: self.above, below: self.below, is: self.is.as_ref() }
    }

    /// The axes.
    ///
    /// # Errors
    /// [`LessonError::Axis`] where a text is not an axis.
    pub(crate) fn axes(&self) -> Result<Vec<Axis>, LessonError> {
        [Some(&self.x), self.y.as_ref()].into_iter().flatten().map(|text| grid::axis(text)).collect()
    }

    /// Checks that all cells can be run.
    ///
    /// # Errors
    /// [`LessonError`] where a text is not an axis, or an axis varies something that the scenario lacks, or the seed,
    /// which is varied anyway.
    pub(crate) fn validate(&self, scenario: &Scenario) -> Result<(), LessonError> {
        let axes = self.axes()?;
        if axes.iter().any(|axis| axis.key == SEED.key) {
            return Err(LessonError::Axis(self.x.clone()));
        }
        grid::check_corners(scenario, &axes)
    }
}
