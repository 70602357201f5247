//! Claims: the results of a lesson's checks.

use std::fmt;
use std::ops::RangeInclusive;

use kalmanscope_core::Scenario;

use crate::check::{Check, SEEDS};
use crate::value::Value;
use crate::{Lesson, LessonError, Outcome};

/// A check of a lesson with its result for each seed.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// The lesson's title.
    pub lesson: String,
    /// The step, counted from 0.
    pub step: usize,
    /// The check.
    pub check: Check,
    /// Each seed with the measured value.
    pub values: Vec<(u64, Value)>,
}

impl Claim {
    /// Whether the check holds in enough seeds. It allows as many failures as with ten seeds.
    pub fn holds(&self) -> bool {
        self.failures().count() <= SEEDS - self.check.seeds.min(SEEDS)
    }

    /// Seeds and values for which the check does not hold.
    pub fn failures(&self) -> impl Iterator<Item = &(u64, Value)> {
        self.values.iter().filter(|(_, value)| !self.check.holds(value))
    }

    /// The least and the largest number, or all words.
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

/// Runs a lesson with each seed and evaluates its checks, in the order of the file.
///
/// # Errors
/// [`LessonError`] where the lesson's scenarios are impossible, which [`Lesson::from_toml`] rules out.
pub fn verify(lesson: &Lesson, seeds: RangeInclusive<u64>) -> Result<Vec<Claim>, LessonError> {
    let claim = |step: usize, check: &Check| {
        let (lesson, check) = (lesson.title.clone(), check.clone());
        Claim { lesson, step, check, values: Vec::new() }
    };
    let steps = lesson.steps.iter().enumerate();
    let mut claims: Vec<Claim> =
        steps.flat_map(|(number, step)| step.checks.iter().map(move |check| claim(number, check))).collect();
    let (first, scenarios) = (lesson.first_scenario()?, lesson.scenarios()?);
    for seed in seeds {
        let run = |scenario: &Scenario| Outcome::of(&Scenario { seed, ..scenario.clone() });
        let mut before = run(&first)?;
        for (number, (step, scenario)) in lesson.steps.iter().zip(&scenarios).enumerate() {
            let changed = if step.change.is_some() { Some(run(scenario)?) } else { None };
            let now = changed.as_ref().unwrap_or(&before);
            for claim in claims.iter_mut().filter(|claim| claim.step == number && claim.check.is_about(seed)) {
                let value = claim.check.value(now, &before).map_err(|error| error.in_step(number))?;
                claim.values.push((seed, value));
            }
            before = changed.unwrap_or(before);
        }
    }
    Ok(claims)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lesson(checks: &str) -> Lesson {
        let text = "title = \"T\"\ngroup = \"Practice\"\nsummary = \"s\"\nscenario = { duration = 2.0 }\n\
                    [[steps]]\nlook = \"l\"\nhappens = \"h\"\nwhy = \"w\"\n\
                    change = { label = \"x\", set = { \"filters.*.fading\" = 1.0 } }\n";
        Lesson::from_toml(&format!("{text}checks = [{checks}]")).unwrap()
    }

    #[test]
    fn a_failed_claim_reports_measure_values_and_seeds() {
        let lesson = lesson("{ filter = \"EKF\", measure = \"evaluations\", above = 5.5, seeds = 9 }");
        let claim = verify(&lesson, 3..=4).unwrap().remove(0);
        assert!(!claim.holds());
        let expected = "T, step 1: evaluations of EKF, above 5.5: 5.000 … 5.000; fails with seed 3: 5.000; \
                        fails with seed 4: 5.000 (must hold in 9 of 10)";
        assert_eq!(claim.to_string(), expected);
        assert!(verify(&lesson, 3..=3).unwrap()[0].holds(), "one failure is forgiven");
    }

    #[test]
    fn before_the_first_change_is_the_lesson_as_it_begins() {
        let check =
            "{ filter = \"EKF\", measure = \"std\", channel = \"natural_frequency\", before = true, below = 0.99 }";
        let claim = verify(&lesson(check), 1..=1).unwrap().remove(0);
        assert!(claim.holds(), "{claim}");
    }

    #[test]
    fn a_check_may_be_about_one_seed() {
        let claims =
            verify(&lesson("{ filter = \"EKF\", measure = \"stopped\", is = false, seed = 2 }"), 1..=3).unwrap();
        assert_eq!(claims[0].values, [(2, Value::Flag(false))]);
    }
}
