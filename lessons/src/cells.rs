//! Checks over a grid: the share of its cells in which a measure keeps within limits.

use kalmanscope_core::Scenario;
use serde::Deserialize;

use crate::axis::{self, Axis};
use crate::check::{Check, Limits};
use crate::value::Expected;
use crate::{LessonError, Outcome};

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
    /// [`LessonError::Axis`] where a text is none.
    fn axes(&self) -> Result<Vec<Axis>, LessonError> {
        [Some(&self.x), self.y.as_ref()].into_iter().flatten().map(|text| Axis::parse(text)).collect()
    }

    /// Checks that all cells can be run.
    ///
    /// # Errors
    /// [`LessonError`] where an axis is none, or varies something that the scenario lacks or the seed, which is tried anyway.
    pub(crate) fn validate(&self, scenario: &Scenario) -> Result<(), LessonError> {
        let axes = self.axes()?;
        if axes.iter().any(|axis| axis.key() == "seed") {
            return Err(LessonError::Axis(self.x.clone()));
        }
        axis::check_corners(scenario, &axes)
    }
}

/// The shares of the cells in which checks hold, of those checks that have cells. Each cell of a grid is run once for all checks
/// over the same grid.
///
/// # Errors
/// [`LessonError`] where a cell cannot be run.
pub(crate) fn shares(
    checks: &[&Check],
    scenario: &Scenario,
    run: &dyn Fn(&Scenario) -> Result<Outcome, LessonError>,
) -> Result<Vec<Option<f64>>, LessonError> {
    let grid = |place: usize| checks[place].cells.as_ref().map(|cells| (&cells.x, &cells.y));
    let mut shares = vec![None; checks.len()];
    for first in 0..checks.len() {
        let Some(cells) = checks[first].cells.as_ref().filter(|_| shares[first].is_none()) else { continue };
        let same: Vec<usize> = (first..checks.len()).filter(|&other| grid(other) == grid(first)).collect();
        let scenarios = axis::cells(scenario, &cells.axes()?)?;
        let mut hits = vec![0_usize; same.len()];
        for scenario in &scenarios {
            let outcome = run(scenario)?;
            for (&place, hits) in same.iter().zip(&mut hits) {
                *hits += usize::from(checks[place].holds_in(&outcome)?);
            }
        }
        for (place, hits) in same.into_iter().zip(hits) {
            shares[place] = Some(hits as f64 / scenarios.len() as f64);
        }
    }
    Ok(shares)
}
