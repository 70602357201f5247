//! Questions that a step asks before it shows its effect.

use kalmanscope_core::Scenario;
use serde::Deserialize;

use crate::LessonError;

const FEWEST: usize = 2;
/// Limits the number of choices, so that all are read.
const MOST: usize = 4;

/// A question with a few choices, asked before a step makes its change and shows its effect.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Question {
    /// The question.
    pub ask: String,
    /// The possible answers, two to four.
    pub choices: Vec<String>,
    /// The right choice, counted from 1.
    pub answer: usize,
    /// The reason why it is right, and the others are not.
    pub because: String,
    /// The record is shown up to this time until the question is answered \[s\]; as the step shows it if left out.
    pub until: Option<f64>,
}

impl Question {
    /// Whether a choice, counted from 0, is the right one.
    pub fn is_right(&self, choice: usize) -> bool {
        choice + 1 == self.answer
    }

    /// The text of the right choice; empty if there is none, which [`crate::Lesson::from_toml`] rules out.
    pub fn right_choice(&self) -> &str {
        self.answer.checked_sub(1).and_then(|place| self.choices.get(place)).map_or("", String::as_str)
    }

    pub(crate) fn validate(&self, scenario: &Scenario) -> Result<(), LessonError> {
        let Self { ask, choices, answer, because, until } = self;
        let blank = |text: &String| text.trim().is_empty();
        let repeated = (1..choices.len()).any(|place| choices[..place].contains(&choices[place]));
        let duration = scenario.duration;
        let wrong = if blank(ask) {
            "has an empty `ask`".to_owned()
        } else if !(FEWEST..=MOST).contains(&choices.len()) {
            format!("has {} `choices`, but must have {FEWEST} to {MOST}", choices.len())
        } else if choices.iter().any(blank) {
            "has an empty choice".to_owned()
        } else if repeated {
            "has the same choice twice".to_owned()
        } else if !(1..=choices.len()).contains(answer) {
            format!("has the `answer` {answer}, but must have the number of a choice: 1 to {}", choices.len())
        } else if blank(because) {
            "has an empty `because`".to_owned()
        } else if until.is_some_and(|until| !(0.0..=duration).contains(&until)) {
            format!("has an `until` outside the record, which is from 0 to {duration} s")
        } else {
            return Ok(());
        };
        Err(LessonError::Question(wrong))
    }
}
