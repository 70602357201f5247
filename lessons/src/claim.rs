//! Claims: the results of a lesson's checks.

use kalmanscope_core::internals::sort_numbers;
use kalmanscope_diagnosis::Value;
use std::fmt;

use crate::check::{Check, NEARLY_ALL};

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
    /// Whether the check holds in the share of the records that it states, judged by the tried seeds.
    ///
    /// The test is one-sided: of n seeds, the share found may lie below the stated share p by two standard errors of a
    /// binomial proportion, 2 √(p (1 − p) / n). A true claim of 98 % passes with up to 1 failure of 10, 5 of 100 and 7
    /// of 200. A claim that was not tried holds.
    pub fn holds(&self) -> bool {
        let stated = self.check.share;
        let error = (stated * (1.0 - stated) / self.values.len() as f64).sqrt();
        // A share of 1 has no error; rounding must not make it fail.
        self.values.is_empty() || self.share() >= stated - 2.0 * error - 1e-9
    }

    /// The share of the tried seeds for which the check holds; NaN if none was tried.
    pub fn share(&self) -> f64 {
        1.0 - self.failures().count() as f64 / self.values.len() as f64
    }

    /// Whether the check states that it holds in nearly all records.
    pub fn is_about_nearly_all(&self) -> bool {
        self.check.share >= NEARLY_ALL
    }

    /// Seeds and values for which the check does not hold.
    pub fn failures(&self) -> impl Iterator<Item = &(u64, Value)> {
        self.values.iter().filter(|(_, value)| !self.check.holds(value))
    }

    /// The measured numbers, ascending; empty for words.
    pub fn numbers(&self) -> Vec<f64> {
        let numbers = self.values.iter().filter_map(|(_, v)| if let Value::Number(x) = v { Some(*x) } else { None });
        let mut sorted: Vec<f64> = numbers.collect();
        sort_numbers(&mut sorted);
        sorted
    }

    /// Each measured word with the number of its seeds.
    pub fn words(&self) -> Vec<(String, usize)> {
        let mut words: Vec<String> = self.values.iter().map(|(_, value)| value.to_string()).collect();
        words.sort();
        words.chunk_by(String::eq).map(|equal| (equal[0].clone(), equal.len())).collect()
    }

    /// A line with whether the claim holds, in what share of the records it does and should, and quantiles of the
    /// numbers (0, 2, 10, 50, 90, 98 and 100 %) or the words with their counts.
    pub fn summary(&self) -> String {
        let Self { lesson, step, check, .. } = self;
        let word = if self.holds() { "holds" } else { "FAILS" };
        let (found, stated) = (100.0 * self.share(), 100.0 * check.share);
        let spread = self.spread();
        format!("{word} {found:5.1} % ({stated:.0} %)  {lesson}, step {}: {check}: {spread}", step + 1)
    }

    fn spread(&self) -> String {
        let numbers = self.numbers();
        if numbers.is_empty() {
            let words: Vec<String> = self.words().iter().map(|(word, count)| format!("{word} {count}")).collect();
            return words.join(", ");
        }
        let quantile = |q: f64| Value::Number(numbers[((numbers.len() - 1) as f64 * q).round() as usize]).to_string();
        [0.0, 0.02, 0.1, 0.5, 0.9, 0.98, 1.0].map(quantile).join(" | ")
    }
}

impl fmt::Display for Claim {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.summary())?;
        self.failures().try_for_each(|(seed, value)| write!(f, "; fails with seed {seed}: {value}"))
    }
}
