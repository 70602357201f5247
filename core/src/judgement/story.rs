//! A run in a few plain sentences: what happens, what each filter makes of it, and which one to believe.
//!
//! ```text
//! Scenario ──happening──▶ "At 8 s the spring loses 36 % of its stiffness."
//! Diagnostics, Estimates, Verdict ──outcome──▶ "plain EKF, which forgets nothing, is still 1.4 % off, and does not know it (overconfident)."
//! Verdicts ──belief──▶ "Believe fading EKF."
//! ```
//!
//! Every number is a result of the run or a setting of its scenario, and no sentence contradicts a verdict.

mod happening;
mod outcome;
mod phrase;
mod sentences;

use std::fmt;

use crate::judgement::words::with_band;
use crate::{Diagnosis, Diagnostics, Run};

use happening::Happening;
use outcome::Outcome;

pub use phrase::{Adjustable, Phrase};

const TOLD: usize = 3;

/// The story of a run so far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Story {
    /// Its sentences, each of some phrases in a row. Spaces and stops are part of the words.
    pub sentences: Vec<Vec<Phrase>>,
    /// Settings that no sentence names and that are worth a try: memory and guess of the filters that it tells of.
    pub aside: Vec<Adjustable>,
}

impl Story {
    /// An estimate with its band in some unit, to the digits that the band leaves: `429.2 ± 0.1 rad/s`.
    pub fn estimate(mean: f64, band: f64, unit: &str) -> String {
        with_band(mean, band, unit)
    }

    /// The story of the part of a run that is done. Each filter has its diagnostics and, if there are enough samples, its
    /// diagnosis at the same place. Filters without diagnostics are left out.
    pub fn of(run: &Run, diagnostics: &[Diagnostics], diagnoses: &[Option<&Diagnosis>]) -> Self {
        let happening = Happening::of(run.scenario());
        let is_measured = run.source().is_measured();
        let mut sentences = vec![if is_measured { sentences::of_record(run) } else { happening.sentence(run) }];
        if !is_measured {
            sentences.extend(happening::faults(run.scenario()));
        }
        let outcomes: Vec<Outcome<'_>> = (run.estimates().iter().zip(diagnostics).zip(&run.scenario().filters))
            .enumerate()
            .filter(|(_, ((estimates, _), _))| !estimates.is_empty())
            .map(|(place, ((estimates, diagnostics), filter))| {
                let diagnosis = diagnoses.get(place).copied().flatten();
                Outcome::new(run, filter, (estimates, diagnostics, diagnosis), &happening)
            })
            .collect();
        sentences.extend(outcomes.iter().take(TOLD).map(|outcome| outcome.sentence(happening.change())));
        sentences.extend(sentences::of_belief(&outcomes, TOLD));
        sentences.extend(sentences::of_classes(run, diagnostics));
        if is_measured && !sentences::has_input(run) {
            sentences.extend(sentences::of_swing(&outcomes));
        }
        sentences.retain(|sentence| !sentence.is_empty());
        let aside =
            outcomes.iter().take(TOLD).flat_map(|outcome| outcome.aside(happening.change().is_some())).collect();
        Self { sentences, aside }
    }

    /// The same, with a sentence that compares filters with themselves before a change, which `words` names. Each filter has its
    /// id, its name, and its diagnostics before and now.
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
