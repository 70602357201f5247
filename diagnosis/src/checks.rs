//! The tests, and their results of one and of many at once.

mod estimates;
mod innovations;

use std::ops::Range;

use kalmanscope_core::internals::sorted_places;
use kalmanscope_core::{Channel, Quantity};

use super::case::{Case, Span, VerdictKind};

/// Every test. A new one is an item of a file and a line here.
pub static TESTS: &[&Test] = &[
    &estimates::DIVERGENCE,
    &estimates::RANGE,
    &estimates::SAMPLE,
    &estimates::DIVERSITY,
    &estimates::WIND_UP,
    &estimates::ELLIPSOID,
    &estimates::CHANNELS,
    &innovations::SENSORS,
    &innovations::TOGETHER,
    &innovations::WHITENESS,
    &innovations::PAIRS,
    &innovations::AT_ONCE,
    &innovations::INPUT,
    &innovations::MEAN,
    &innovations::LINES,
    &estimates::UNLEARNT,
    &estimates::RECOVERY,
];

/// A statistical test, or a deterministic rule.
#[derive(Debug)]
pub struct Test {
    /// The name, in running text.
    pub name: &'static str,
    /// The formula of the statistic.
    pub statistic: &'static str,
    /// Its distribution for a consistent filter.
    pub distribution: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// Instructions for reading it.
    pub reading: &'static str,
    pub(crate) run: fn(&Case<'_>, &'static Self, &mut Vec<Evidence>),
}

/// The subject of a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Subject {
    /// All sensors, or all channels.
    All,
    /// One sensor.
    Sensor(Quantity),
    /// One channel.
    Channel(Channel),
}

/// The result of one test for one subject.
#[derive(Clone, Debug)]
pub struct Evidence {
    /// The test.
    pub test: &'static Test,
    /// The subject.
    pub subject: Subject,
    /// The statistic.
    pub statistic: f64,
    /// The probability that a consistent filter gives as much or more; 0 or 1 for a rule.
    pub p_value: f64,
    /// The size of the effect over the size that matters: below 1 it is harmless, however small the p-value.
    pub effect: f64,
    /// The verdict that it supports if it counts.
    pub speaks_for: VerdictKind,
    /// Whether it counts: the effect matters, and is significant with all tests taken together.
    pub counts: bool,
    /// The kept samples that it is about.
    pub samples: Range<usize>,
    /// The remedy, in words and numbers.
    pub sentence: String,
}

impl Evidence {
    pub(crate) fn new(test: &'static Test, subject: Subject, case: &Case<'_>) -> Self {
        Self::over(test, subject, &case.whole())
    }

    pub(crate) fn over(test: &'static Test, subject: Subject, span: &Span) -> Self {
        let (speaks_for, samples) = (VerdictKind::Consistent, span.samples.clone());
        let (effect, counts, sentence) = Default::default();
        Self { test, subject, statistic: f64::NAN, p_value: 1.0, effect, speaks_for, counts, samples, sentence }
    }

    pub(crate) fn certain(self, kind: VerdictKind, effect: f64, statistic: f64, sentence: String) -> Self {
        Self { p_value: 0.0, effect, speaks_for: kind, statistic, sentence, ..self }
    }
}

/// Limits the probability that any test rejects a consistent filter.
const LEVEL: f64 = 1e-4;

/// Evidence counts where its effect matters, and its p-value is below the level for all tests together:
/// ```text
/// p₍ᵢ₎ ≤ α / (m - i + 1)  for the i-th smallest of m p-values and all before it
/// ```
/// Source: Holm (1979), A simple sequentially rejective multiple test procedure, *Scandinavian Journal of Statistics* 6.
pub(crate) fn decide(evidence: &mut [Evidence]) {
    let order = sorted_places(evidence.len(), &|a, b| evidence[a].p_value.total_cmp(&evidence[b].p_value));
    for (rank, &place) in order.iter().enumerate() {
        let one = &mut evidence[place];
        if one.p_value > LEVEL / (order.len() - rank) as f64 {
            break;
        }
        one.counts = one.effect >= 1.0;
    }
}
