//! A lesson as it stands in its file.

use kalmanscope_core::Scenario;
use serde::Deserialize;
use toml::Table;

use crate::adjustment::{self, Adjustment, Change};
use crate::library::scenario_text;
use crate::{Check, LessonError};

/// An experiment in steps. Each begins with what the steps before have changed.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lesson {
    /// The title in the menu.
    pub title: String,
    /// The group in the menu.
    pub group: String,
    /// What one learns, in a sentence.
    pub summary: String,
    /// The scenario that it begins with.
    pub scenario: Base,
    /// What is different from that at first.
    #[serde(default)]
    pub adjust: Adjustment,
    /// What to do, in order.
    pub steps: Vec<Step>,
}

/// The scenario that a lesson begins with.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Base {
    /// A built-in one, by the name of its file.
    Named(String),
    /// One of its own, as in a scenario file.
    Inline(Table),
}

/// A step of a lesson.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Step {
    /// What to look at.
    pub look: String,
    /// What to change, if anything.
    pub change: Option<Change>,
    /// What happens then.
    pub happens: String,
    /// Why.
    pub why: String,
    /// The views that show it, the most telling first.
    #[serde(default)]
    pub views: Vec<View>,
    /// Whether the record is played or shown whole.
    #[serde(default)]
    pub mode: Mode,
    /// The time that the record is played from \[s\], or that is shown from; its beginning if left out.
    pub from: Option<f64>,
    /// The time until which the record is shown \[s\]; its end if left out.
    pub to: Option<f64>,
    /// What the text says, in numbers.
    #[serde(default)]
    pub checks: Vec<Check>,
}

/// What a step wants to be seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum View {
    /// Motion over time.
    States,
    /// Parameters over time.
    Parameters,
    /// Errors with ±2σ over time.
    Errors,
    /// Innovations with ±2σ over time.
    Innovations,
    /// NIS and NEES over time.
    NisNees,
    /// Autocorrelation of the innovations.
    Autocorrelation,
    /// Gain over time.
    Gain,
    /// Velocity over displacement.
    Phase,
    /// Two parameters against each other, with the belief's ellipse.
    ParameterPlane,
    /// Frequency response, true and estimated.
    FrequencyResponse,
    /// P, K, S, Φ and H of one step.
    Matrices,
    /// The moving mass.
    Oscillator,
}

/// How a step shows the record.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// Sample by sample.
    Live,
    /// All at once.
    #[default]
    Whole,
}

impl Lesson {
    /// Reads a lesson file and checks that each of its steps can be taken.
    ///
    /// # Errors
    /// [`LessonError::Syntax`] where it is no lesson, [`LessonError::Step`] where a step asks for what is not there.
    pub fn from_toml(text: &str) -> Result<Self, LessonError> {
        let lesson: Self = toml::from_str(text).map_err(|error| LessonError::Syntax(error.to_string()))?;
        let scenarios = lesson.scenarios()?;
        for (number, (step, scenario)) in lesson.steps.iter().zip(&scenarios).enumerate() {
            // A check that compares with what was before needs its filter there, too.
            let before = scenarios.get(number.wrapping_sub(1)).unwrap_or(scenario);
            for check in &step.checks {
                let earlier = if check.before { before } else { scenario };
                check.validate(scenario).and_then(|()| check.validate(earlier)).map_err(|e| e.in_step(number))?;
            }
        }
        Ok(lesson)
    }

    /// The scenario that the lesson begins with, before the first step's change.
    ///
    /// # Errors
    /// [`LessonError`] where there is no such scenario or it cannot be adjusted like this.
    pub fn first_scenario(&self) -> Result<Scenario, LessonError> {
        let scenario = match &self.scenario {
            Base::Named(name) => {
                let text = scenario_text(name).ok_or_else(|| LessonError::UnknownScenario(name.clone()))?;
                Scenario::from_toml(text)?
            }
            Base::Inline(table) => adjustment::read(table)?,
        };
        self.adjust.apply(&scenario)
    }

    /// The scenario of a step, counted from 0, with its change and those of all steps before. That of the last step if
    /// there are not so many.
    ///
    /// # Errors
    /// [`LessonError::Step`] where a step changes what is not there.
    pub fn scenario_at(&self, step: usize) -> Result<Scenario, LessonError> {
        let mut scenario = self.first_scenario()?;
        for (number, step) in self.steps.iter().enumerate().take(step + 1) {
            if let Some(change) = &step.change {
                scenario = change.adjustment.apply(&scenario).map_err(|error| error.in_step(number))?;
            }
        }
        Ok(scenario)
    }

    /// The scenario of every step.
    ///
    /// # Errors
    /// [`LessonError::Step`] where a step changes what is not there.
    pub fn scenarios(&self) -> Result<Vec<Scenario>, LessonError> {
        (0..self.steps.len()).map(|step| self.scenario_at(step)).collect()
    }
}
