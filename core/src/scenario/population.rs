//! Populations: scenarios of which some numbers are drawn at random, another one for each seed.

use kalmanscope_filters::random::Normal;
use serde::{Deserialize, Serialize};

/// The law of a number that is drawn, each with two numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", expecting = "one of normal, lognormal, uniform and log_uniform, with two numbers")]
pub enum Law {
    /// Mean and standard deviation.
    Normal([f64; 2]),
    /// Median, and standard deviation of the natural logarithm.
    Lognormal([f64; 2]),
    /// From, to.
    Uniform([f64; 2]),
    /// From, to, both above 0: the logarithm is uniform.
    LogUniform([f64; 2]),
}

/// The words of a kind of laws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LawInfo {
    /// The key in scenario files.
    pub key: &'static str,
    /// The name in running text.
    pub name: &'static str,
    /// The names of its two numbers.
    pub numbers: [&'static str; 2],
}

impl Law {
    /// A law of each kind, as it is offered for a number: about its value, spread by this share of it, or by as much where it is 0.
    pub fn about(value: f64, share: f64) -> [Self; 4] {
        let std = if value == 0.0 { share } else { share * value.abs() };
        let positive = if value > 0.0 { value } else { 1.0 };
        let uniform = [value - 2.0 * std, value + 2.0 * std];
        let factor = 1.0 + 2.0 * share;
        [
            Self::Normal([value, std]),
            Self::Lognormal([positive, share]),
            Self::Uniform(uniform),
            Self::LogUniform([positive / factor, positive * factor]),
        ]
        .map(|law| law.with(law.numbers().map(short)))
    }

    /// The words of its kind.
    pub fn info(&self) -> LawInfo {
        let (key, name, numbers) = match self {
            Self::Normal(_) => ("normal", "normal", ["mean", "σ"]),
            Self::Lognormal(_) => ("lognormal", "lognormal", ["median", "σ of the logarithm"]),
            Self::Uniform(_) => ("uniform", "uniform", ["from", "to"]),
            Self::LogUniform(_) => ("log_uniform", "log-uniform", ["from", "to"]),
        };
        LawInfo { key, name, numbers }
    }

    /// Its two numbers.
    pub fn numbers(&self) -> [f64; 2] {
        let (Self::Normal(numbers) | Self::Lognormal(numbers) | Self::Uniform(numbers) | Self::LogUniform(numbers)) =
            *self;
        numbers
    }

    /// The law of the same kind with other numbers.
    #[must_use]
    pub fn with(&self, numbers: [f64; 2]) -> Self {
        let mut law = *self;
        let (Self::Normal(own) | Self::Lognormal(own) | Self::Uniform(own) | Self::LogUniform(own)) = &mut law;
        *own = numbers;
        law
    }

    /// The numbers that it may have, if its own are others.
    pub fn problem(&self) -> Option<&'static str> {
        let [a, b] = self.numbers();
        if !(a.is_finite() && b.is_finite()) {
            return Some("two finite numbers");
        }
        let (holds, allowed) = match self {
            Self::Normal(_) => (b >= 0.0, "a mean and a standard deviation of at least 0"),
            Self::Lognormal(_) => (a > 0.0 && b >= 0.0, "a median above 0 and a standard deviation of at least 0"),
            Self::Uniform(_) => (a <= b, "two numbers, the first of which is not the larger one"),
            Self::LogUniform(_) => (0.0 < a && a <= b, "two numbers above 0, the first of which is not the larger one"),
        };
        (!holds).then_some(allowed)
    }

    pub(crate) fn draw(&self, random: &mut Normal) -> f64 {
        match *self {
            Self::Normal([mean, std]) => mean + std * random.sample(),
            Self::Lognormal([median, std]) => median * libm::exp(std * random.sample()),
            Self::Uniform([from, to]) => from + (to - from) * random.uniform(),
            Self::LogUniform([from, to]) => from * libm::exp(libm::log(to / from) * random.uniform()),
        }
    }
}

/// A number of nine digits: a text of it is short and exact.
pub(crate) fn short(value: f64) -> f64 {
    format!("{value:.8e}").parse().unwrap_or(value)
}
