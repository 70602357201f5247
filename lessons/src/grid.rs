//! Grids over settings: the map that a step shows in the laboratory, and the cells of a check.

use kalmanscope_core::setting::{Address, SEED};
use kalmanscope_core::{Axis, Scenario};
use kalmanscope_diagnosis::{Measure, Value};
use serde::Deserialize;

use crate::LessonError;

/// Limits the values on one axis: a check runs the scenario for each.
const MOST: usize = 256;

fn axis(text: &str) -> Result<Axis, LessonError> {
    let axis = Axis::parse(text).ok().filter(|axis| (2..=MOST).contains(&axis.count));
    axis.ok_or_else(|| LessonError::Axis(text.to_owned()))
}

/// The scenarios of all cells of a grid, those of the last axis next to each other.
pub(crate) fn cells(scenario: &Scenario, axes: &[Axis]) -> Result<Vec<Scenario>, LessonError> {
    let mut cells = vec![scenario.clone()];
    for axis in axes {
        let address = Address::parse(scenario, &axis.key)?;
        let with = |cell: &Scenario, place: usize| {
            let mut cell = cell.clone();
            address.set(&mut cell, axis.value(place));
            cell
        };
        cells = cells.iter().flat_map(|cell| (0..axis.count).map(move |place| with(cell, place))).collect();
    }
    cells.iter().try_for_each(Scenario::validate)?;
    Ok(cells)
}

/// Settings are limited by ranges: possible corners make a possible grid, and all its cells may be 256² scenarios.
fn check_corners(scenario: &Scenario, axes: &[Axis]) -> Result<(), LessonError> {
    let ends: Vec<Axis> = axes.iter().map(|axis| Axis { count: 2, ..axis.clone() }).collect();
    cells(scenario, &ends).map(|_| ())
}

/// Whether a number is between limits, or a word is one of those that are expected.
pub(crate) fn is_within(value: &Value, (above, below): (Option<f64>, Option<f64>), is: &[String]) -> bool {
    match value {
        Value::Number(x) => !x.is_nan() && above.is_none_or(|limit| *x > limit) && below.is_none_or(|limit| *x < limit),
        words => words.words().iter().any(|word| is.iter().any(|one| one == word)),
    }
}

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

/// A grid of settings around those of a step, and the limits of the measure in a cell. A check over cells is about the share of
/// the cells in which the measure keeps within them.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GridCells {
    /// A setting, written as `KEY=FROM:TO:COUNT`, with `:log` behind it for equal ratios.
    pub x: String,
    /// Another setting.
    pub y: Option<String>,
    /// The measure must be above this in the cell.
    pub above: Option<f64>,
    /// The measure must be below this in the cell.
    pub below: Option<f64>,
    /// The word must be one of these in the cell.
    #[serde(default)]
    pub is: Vec<String>,
}

impl GridCells {
    /// Whether a value in a cell keeps within the limits.
    pub(crate) fn hold(&self, value: &Value) -> bool {
        is_within(value, (self.above, self.below), &self.is)
    }

    pub(crate) fn axes(&self) -> Result<Vec<Axis>, LessonError> {
        [Some(&self.x), self.y.as_ref()].into_iter().flatten().map(|text| axis(text)).collect()
    }

    /// Checks that all cells can be run.
    pub(crate) fn validate(&self, scenario: &Scenario) -> Result<(), LessonError> {
        let axes = self.axes()?;
        // Each trial of a claim sets the seed of all its cells, over that of an axis.
        if axes.iter().any(|axis| axis.key == SEED.key) {
            return Err(LessonError::Axis(self.x.clone()));
        }
        check_corners(scenario, &axes)
    }
}
