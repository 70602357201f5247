//! Lessons held to what they say.

use std::fmt;
use std::ops::RangeInclusive;

use kalmanscope_core::Scenario;

use crate::check::{Check, SEEDS, Value};
use crate::{Lesson, LessonError, Outcome};

/// A check of a lesson and what came of it, seed by seed.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// The lesson's title.
    pub lesson: String,
    /// The step, counted from 0.
    pub step: usize,
    /// The check.
    pub check: Check,
    /// Each seed and what was measured.
    pub values: Vec<(u64, Value)>,
}

impl Claim {
    /// Whether the check holds in as many seeds as it must. It may fail in as many as it may of ten.
    pub fn holds(&self) -> bool {
        self.failures().count() <= SEEDS - self.check.seeds.min(SEEDS)
    }

    /// Seeds and values for which the check does not hold.
    pub fn failures(&self) -> impl Iterator<Item = &(u64, Value)> {
        self.values.iter().filter(|(_, value)| !self.check.holds(value))
    }

    /// The least and the largest number, or all words that occur.
    fn span(&self) -> String {
        let numbers = self.values.iter().filter_map(|(_, v)| if let Value::Number(x) = v { Some(*x) } else { None });
        let mut sorted: Vec<f64> = numbers.collect();
        sorted.sort_by(f64::total_cmp);
        if let [least, .., largest] = sorted[..] {
            return format!("{} … {}", Value::Number(least), Value::Number(largest));
        }
        let mut words: Vec<String> = self.values.iter().map(|(_, value)| value.to_string()).collect();
        words.sort();
        words.dedup();
        words.join(", ")
    }
}

impl fmt::Display for Claim {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { lesson, step, check, .. } = self;
        write!(f, "{lesson}, step {}: {check}: {}", step + 1, self.span())?;
        for (seed, value) in self.failures() {
            write!(f, "; fails with seed {seed}: {value}")?;
        }
        if check.seeds < SEEDS { write!(f, " (must hold in {} of {SEEDS})", check.seeds) } else { Ok(()) }
    }
}

/// Runs a lesson with each seed and makes its checks, in the order of the file.
///
/// # Errors
/// [`LessonError`] where the lesson's scenarios are impossible, which [`Lesson::from_toml`] rules out.
pub fn verify(lesson: &Lesson, seeds: RangeInclusive<u64>) -> Result<Vec<Claim>, LessonError> {
    let mut claims: Vec<Claim> = pairs(lesson)
        .map(|(step, check)| Claim { lesson: lesson.title.clone(), step, check: check.clone(), values: Vec::new() })
        .collect();
    let scenarios = lesson.scenarios()?;
    for seed in seeds {
        let outcome = |scenario: &Scenario| Outcome::of(&Scenario { seed, ..scenario.clone() });
        let mut before = None;
        let mut claims = claims.iter_mut().peekable();
        for (step, scenario) in scenarios.iter().enumerate() {
            let now = if step == 0 || lesson.steps[step].change.is_some() { Some(outcome(scenario)?) } else { None };
            let (last, now) = match (before.take(), now) {
                (last, Some(now)) => (last, now),
                (Some(last), None) => (None, last),
                (None, None) => continue,
            };
            while let Some(claim) = claims.next_if(|claim| claim.step == step) {
                let value = claim.check.value(&now, last.as_ref().unwrap_or(&now));
                claim.values.push((seed, value.map_err(|error| error.in_step(step))?));
            }
            before = Some(now);
        }
    }
    Ok(claims)
}

fn pairs(lesson: &Lesson) -> impl Iterator<Item = (usize, &Check)> {
    lesson.steps.iter().enumerate().flat_map(|(step, it)| it.checks.iter().map(move |check| (step, check)))
}
