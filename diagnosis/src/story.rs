//! A run in a few plain sentences: the events, the outcome of each filter, and the one to believe.
//!
//! ```text
//! Scenario ──happening──▶ "At 8 s the spring loses 36 % of its stiffness."
//! Diagnostics, Estimates, Verdict ──outcome──▶ "plain EKF is still 1.4 % off, and does not know it (overconfident)."
//! Verdicts ──belief──▶ "Trust fading EKF."
//! ```
//!
//! Every number is a result of the run or a setting of its scenario, and no sentence contradicts a verdict.

mod happening;
mod outcome;
mod sentences;

use std::fmt;

use kalmanscope_core::{Diagnostics, Run};

use crate::Diagnosis;
use crate::words::{percent_to_a_tenth, plain};
use outcome::FilterOutcome;

const TOLD: usize = 3;

/// The story of a run so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Story {
    /// Its sentences, each of some phrases in a row. Spaces and stops are part of the words.
    pub sentences: Vec<Vec<Phrase>>,
    /// Settings that no sentence names and that are worth a try: memory and guess of the filters in the story.
    pub aside: Vec<Adjustable>,
}

impl Story {
    /// The story of the part of a run that is done, with diagnostics and diagnosis of each filter; one without the first is left out.
    pub fn of(run: &Run, diagnostics: &[Diagnostics], diagnoses: &[Option<&Diagnosis>]) -> Self {
        let changes = happening::changes_of(run.scenario());
        let is_measured = run.source().is_measured();
        let mut sentences =
            vec![if is_measured { sentences::of_record(run) } else { happening::sentence(&changes, run) }];
        if !is_measured {
            sentences.extend(happening::faults(run.scenario()));
        }
        let mut outcomes: Vec<FilterOutcome<'_>> = Vec::new();
        let filters = run.estimates().iter().zip(diagnostics).zip(&run.scenario().filters).enumerate();
        for (place, ((estimates, diagnostics), filter)) in filters.filter(|(_, ((one, _), _))| !one.is_empty()) {
            let diagnosis = diagnoses.get(place).copied().flatten();
            outcomes.push(FilterOutcome::new(run, filter, (estimates, diagnostics, diagnosis), &changes));
        }
        sentences.extend(outcomes.iter().take(TOLD).map(|outcome| outcome.sentence(changes.first())));
        sentences.extend(sentences::of_belief(&outcomes, TOLD));
        sentences.extend(sentences::of_classes(run, diagnostics));
        if is_measured && !sentences::has_input(run) {
            sentences.extend(sentences::of_swing(&outcomes));
        }
        sentences.retain(|sentence| !sentence.is_empty());
        let aside = outcomes.iter().take(TOLD).flat_map(|outcome| outcome.aside(!changes.is_empty())).collect();
        Self { sentences, aside }
    }

    /// The same, with a sentence that compares filters (id, name, diagnostics before and now) over a change, which `words` names.
    #[must_use]
    pub fn compared(mut self, words: &str, filters: &[(u32, &str, &Diagnostics, &Diagnostics)]) -> Self {
        self.sentences.extend(sentences::of_comparison(words, filters));
        self
    }

    /// All phrases in a row.
    pub fn phrases(&self) -> impl Iterator<Item = &Phrase> {
        self.sentences.iter().flatten()
    }
}

impl fmt::Display for Story {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (place, sentence) in self.sentences.iter().enumerate() {
            if place > 0 {
                f.write_str(" ")?;
            }
            sentence.iter().try_for_each(|phrase| write!(f, "{phrase}"))?;
        }
        Ok(())
    }
}

/// A piece of a sentence.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Phrase {
    /// Words.
    Words(String),
    /// The name of a filter.
    Filter {
        /// The filter's id.
        id: u32,
        /// Its name.
        name: String,
    },
    /// A result of the run.
    Result(String),
    /// A number of the scenario that a reader may change.
    Setting(Adjustable),
}

/// A number of the scenario in a sentence.
#[derive(Clone, Debug, PartialEq)]
pub struct Adjustable {
    /// The address of its setting, as [`Address::parse`](kalmanscope_core::setting::Address::parse) reads it.
    pub address: String,
    /// The number that the sentence shows.
    pub shown: f64,
    /// Limits the shown number.
    pub range: (f64, f64),
    /// The unit of the shown number, empty for a pure one.
    pub unit: &'static str,
    has_three_decimals: bool,
    /// Of a frequency after a change the one before; shown is the stiffness that is lost (1) or gained (-1), in percent of that before.
    stiffness: Option<(f64, f64)>,
}

impl Adjustable {
    fn new(address: impl Into<String>, value: f64, range: (f64, f64), unit: &'static str) -> Self {
        Self { address: address.into(), shown: value, range, unit, has_three_decimals: false, stiffness: None }
    }

    /// The stiffness that is lost or gained where the natural frequency goes from `before` to `after` \[rad/s\]: `k ∝ ωₙ²`.
    fn stiffness(address: impl Into<String>, before: f64, after: f64) -> Self {
        let lost = 1.0 - (after / before) * (after / before);
        let (sign, most) = if lost < 0.0 { (-1.0, 300.0) } else { (1.0, 95.0) };
        Self { stiffness: Some((before, sign)), ..Self::new(address, 100.0 * sign * lost, (1.0, most), "%") }
    }

    /// The name of the shown number, where it is not that of the setting.
    pub fn name(&self) -> Option<&'static str> {
        self.stiffness.map(|(_, sign)| if sign > 0.0 { "loss of stiffness" } else { "gain of stiffness" })
    }

    /// The same with another number.
    #[must_use]
    pub fn showing(&self, shown: f64) -> Self {
        Self { shown, ..self.clone() }
    }

    /// The same at another value of the setting, as while it is changed and the run does not follow yet.
    #[must_use]
    pub fn at(&self, value: f64) -> Self {
        let of = |(before, sign): (f64, f64)| 100.0 * sign * (1.0 - (value / before) * (value / before));
        self.showing(self.stiffness.map_or(value, of))
    }

    /// The value of the setting for a number that the sentence shows.
    pub fn value(&self, shown: f64) -> f64 {
        let of = |(before, sign): (f64, f64)| before * libm::sqrt((1.0 - 0.01 * sign * shown).max(0.0));
        self.stiffness.map_or(shown, of)
    }
}

impl Phrase {
    /// The setting that the phrase shows, if it does.
    pub fn setting(&self) -> Option<&Adjustable> {
        if let Self::Setting(setting) = self { Some(setting) } else { None }
    }
}

impl fmt::Display for Phrase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Words(words) | Self::Result(words) => f.write_str(words),
            Self::Filter { name, .. } => f.write_str(name),
            Self::Setting(setting) => setting.fmt(f),
        }
    }
}

impl fmt::Display for Adjustable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = match self.stiffness {
            Some(_) => return f.write_str(&percent_to_a_tenth(0.01 * self.shown)),
            None if self.has_three_decimals && self.shown.abs() < 1e3 => format!("{:.3}", self.shown),
            None => plain(self.shown),
        };
        f.write_str(format!("{number} {}", self.unit).trim_end())
    }
}

#[derive(Default)]
struct Writer(Vec<Phrase>);

impl Writer {
    fn say(mut self, words: impl Into<String>) -> Self {
        let words = words.into();
        match self.0.last_mut() {
            _ if words.is_empty() => {}
            Some(Phrase::Words(before)) => before.push_str(&words),
            _ => self.0.push(Phrase::Words(words)),
        }
        self
    }

    fn result(mut self, words: impl Into<String>) -> Self {
        self.0.push(Phrase::Result(words.into()));
        self
    }

    fn setting(mut self, setting: Adjustable) -> Self {
        self.0.push(Phrase::Setting(setting));
        self
    }

    fn filter(mut self, id: u32, name: &str) -> Self {
        self.0.push(Phrase::Filter { id, name: name.to_owned() });
        self
    }
}
