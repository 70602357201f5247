//! Lessons and their files.

use kalmanscope_core::document;
use kalmanscope_core::{Channel, Scenario};
use serde::Deserialize;
use toml::Table;

use crate::adjustment::{self, Adjustment};
use crate::{BuiltIn, Check, LessonError, LessonPicture, Map, Question};

/// An experiment in steps. Each step includes the changes of the steps before it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Lesson {
    /// The title in the menu.
    pub title: String,
    /// The course in the menu.
    pub course: String,
    /// A sentence on what the lesson teaches.
    pub summary: String,
    /// The picture in the menu.
    pub picture: Option<LessonPicture>,
    /// The initial scenario.
    pub scenario: Base,
    /// Changes to the initial scenario, before the first step.
    #[serde(default)]
    pub adjust: Adjustment,
    /// The steps, in order.
    pub steps: Vec<LessonStep>,
}

/// The initial scenario of a lesson.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged, expecting = "expected the name of a built-in scenario, or a table")]
pub enum Base {
    /// A built-in one, by the name of its file.
    Named(String),
    /// A scenario of the lesson's own, as in a scenario file.
    Inline(Table),
}

/// A step of a lesson.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LessonStep {
    /// Instructions on where to look.
    pub look: String,
    /// A question that is asked before the change is made and its effect is shown.
    pub question: Option<Question>,
    /// The change, if any.
    pub change: Option<Adjustment>,
    /// The effect to be seen.
    pub happens: String,
    /// Why.
    pub why: String,
    /// The views to show, the most important first.
    #[serde(default)]
    pub views: Vec<ViewName>,
    /// The map in the view `map`; the user's or a usual one if left out.
    pub map: Option<Map>,
    /// The channels to show; all if left out.
    #[serde(default)]
    pub channels: Vec<Channel>,
    /// Whether the ±2σ bands are shown.
    #[serde(default = "yes")]
    pub bands: bool,
    /// Whether the record is played, stepped through or shown whole.
    #[serde(default)]
    pub mode: Presentation,
    /// The time at which playing, stepping or the shown range begins \[s\]; the record's beginning if left out.
    pub from: Option<f64>,
    /// The time at which the shown range ends \[s\]; the record's end if left out.
    pub to: Option<f64>,
    /// The claims of the text, as numbers.
    #[serde(default)]
    pub checks: Vec<Check>,
}

impl LessonStep {
    /// Whether the step makes a claim about a verdict.
    pub fn speaks_of_verdicts(&self) -> bool {
        self.checks.iter().any(Check::is_of_verdict)
    }
}

/// The speed of a reader who thinks along.
const WORDS_A_MINUTE: usize = 150;

const fn yes() -> bool {
    true
}

/// A view that a step can ask for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ViewName {
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
    /// Probabilities of the filters as model classes over time.
    ModelClasses,
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
    /// Measured and predicted values, and the free run.
    Measured,
    /// A score over two settings.
    Map,
}

/// The presentation of the record in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Presentation {
    /// Sample by sample, playing.
    Live,
    /// Sample by sample, paused, for the user to step.
    Step,
    /// All at once.
    #[default]
    Whole,
}

impl Lesson {
    /// Reads a lesson file and checks that each of its steps is possible.
    ///
    /// # Errors
    /// [`LessonError::Syntax`] where it is not a lesson, [`LessonError::Step`] where a step is impossible.
    pub fn from_toml(text: &str) -> Result<Self, LessonError> {
        let lesson = Self::read(text)?;
        let scenarios = lesson.scenarios()?;
        let first = lesson.first_scenario()?;
        if lesson.steps.is_empty() {
            return Err(LessonError::NoStep);
        }
        for (number, (step, scenario)) in lesson.steps.iter().zip(&scenarios).enumerate() {
            let before = number.checked_sub(1).map_or(&first, |last| &scenarios[last]);
            if step.change.as_ref().is_some_and(|change| change.label.trim().is_empty()) {
                return Err(LessonError::NoLabel.in_step(number));
            }
            if let Some(question) = &step.question {
                // The question comes before the change.
                question.validate(before).map_err(|error| error.in_step(number))?;
            }
            if let Some(map) = &step.map {
                map.validate(scenario).map_err(|error| error.in_step(number))?;
            }
            for check in &step.checks {
                let valid = check.validate(scenario).and_then(|()| match (check.before, &step.change) {
                    (false, _) => Ok(()),
                    (true, Some(_)) => check.validate(before),
                    (true, None) => Err(check.trouble("compares with what was before, but the step changes nothing")),
                });
                valid.map_err(|error| error.in_step(number))?;
            }
        }
        if let Some(picture) = &lesson.picture {
            let mut steps = lesson.steps.iter().zip(&scenarios);
            // Step 0 wraps to a place that no lesson has.
            let (step, scenario) = steps.nth(picture.step.wrapping_sub(1)).ok_or(LessonError::Picture("step"))?;
            picture.validate(scenario, step.map.is_some())?;
        }
        Ok(lesson)
    }

    /// The time that a reader takes, in whole minutes: to read every text, and half a minute a step to look.
    pub fn minutes(&self) -> usize {
        let texts = self.steps.iter().flat_map(|step| {
            let LessonStep { look, happens, why, question, .. } = step;
            let question = question.iter().flat_map(|one| [&one.ask, &one.because].into_iter().chain(&one.choices));
            [look, happens, why].into_iter().chain(question)
        });
        let words: usize = texts.map(|text| text.split_whitespace().count()).sum();
        (words.div_ceil(WORDS_A_MINUTE) + self.steps.len() / 2).max(1)
    }

    /// Reads a lesson, but does not try its scenarios and checks.
    pub(crate) fn read(text: &str) -> Result<Self, LessonError> {
        Ok(document::read_toml(text)?)
    }

    /// The initial scenario, before the first step's change.
    ///
    /// # Errors
    /// [`LessonError`] where there is no such scenario or its adjustment is impossible.
    pub fn first_scenario(&self) -> Result<Scenario, LessonError> {
        let scenario = match &self.scenario {
            Base::Named(name) => {
                let built_in = BuiltIn::named(name).ok_or_else(|| LessonError::UnknownScenario(name.clone()))?;
                built_in.scenario()?
            }
            Base::Inline(table) => adjustment::read(table)?,
        };
        self.adjust.apply(&scenario)
    }

    /// The scenario of a step, counted from 0, with its change and those of the steps before. Beyond the last step it
    /// is that of the last.
    ///
    /// # Errors
    /// [`LessonError::Step`] where a change is impossible.
    pub fn scenario_at(&self, step: usize) -> Result<Scenario, LessonError> {
        let mut scenario = self.first_scenario()?;
        for (number, step) in self.steps.iter().enumerate().take(step + 1) {
            if let Some(change) = &step.change {
                scenario = change.apply(&scenario).map_err(|error| error.in_step(number))?;
            }
        }
        Ok(scenario)
    }

    /// The scenario of every step.
    ///
    /// # Errors
    /// [`LessonError::Step`] where a change is impossible.
    pub fn scenarios(&self) -> Result<Vec<Scenario>, LessonError> {
        (0..self.steps.len()).map(|step| self.scenario_at(step)).collect()
    }
}
