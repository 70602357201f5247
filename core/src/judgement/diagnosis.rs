//! The diagnosis of a filter: the verdict, its evidence, and the settings to turn if it is bad.
//!
//! ```text
//! Diagnostics, Estimates, Record ──tests──▶ Evidence ──level──▶ Verdict ──causes──▶ LikelyCauses ──trials, search──▶ Remedies
//! ```
//!
//! Each test ([`Test`]) is an item of a file in `diagnosis/checks`, each cause ([`Cause`]) one in `diagnosis/cause`.

mod case;
mod cause;
mod checks;
mod distributions;
mod errors;
mod evidence;
mod innovations;
mod law;
mod live;
mod parts;
mod periodogram;
mod remedy;
mod search;
mod summary;
mod trial;
mod verdict;
mod verdict_kind;

use crate::mathematics::lists::sort_items;
use std::ops::Range;

use crate::numbers::diagnostics::Depth;
use crate::{CramerRao, Diagnostics, Estimates, FilterSettings, Record, RunError, Scenario};

use case::Case;
use cause::{ALTERNATIVES, BadFilter};
use trial::Trials;

pub use cause::{CAUSES, Cause, LikelyCause};
pub use checks::TESTS;
pub use evidence::{Evidence, Subject, Test};
pub use live::LiveDiagnosis;
pub use parts::PARTS;
pub use remedy::{Remedy, in_percent};
pub use search::Search;
pub use summary::{Final, Score, Summary};
pub use verdict::Verdict;
pub use verdict_kind::VerdictKind;

/// The diagnosis of one filter: a verdict and its evidence.
#[derive(Clone, Debug, Default)]
pub struct Diagnosis {
    /// The verdict on the filter, if there are enough measurements for one.
    pub verdict: Option<Verdict>,
    /// The results of all tests.
    pub evidence: Vec<Evidence>,
    /// The kept samples with a bad verdict, judged part by part of the record.
    pub bad_parts: Vec<Range<usize>>,
    samples: Range<usize>,
}

impl Diagnosis {
    /// The diagnosis of a filter from its estimates, its record and their diagnostics. `None` if the diagnostics have
    /// the depth [`Depth::Consistency`]. With a bound, σ is compared with it.
    ///
    /// One pass over the kept samples, of about 0.1 µs each.
    pub fn new(
        diagnostics: &Diagnostics,
        estimates: &Estimates,
        record: &Record,
        bound: Option<&CramerRao>,
    ) -> Option<Self> {
        Self::over(0..diagnostics.len(), diagnostics, estimates, record, bound)
    }

    /// The same over a range of the kept samples, such as those that a screen shows.
    pub fn over(
        samples: Range<usize>,
        diagnostics: &Diagnostics,
        estimates: &Estimates,
        record: &Record,
        bound: Option<&CramerRao>,
    ) -> Option<Self> {
        if diagnostics.depth() != Depth::All || diagnostics.is_empty() {
            return None;
        }
        let case = live::case(diagnostics, estimates, record, bound, samples.clone());
        Some(Self::of(&case, samples))
    }

    fn of(case: &Case<'_>, samples: Range<usize>) -> Self {
        let mut evidence = Vec::new();
        for test in TESTS {
            (test.run)(case, test, &mut evidence);
        }
        evidence::decide(&mut evidence);
        let verdict = Verdict::of(case, &evidence);
        Self { verdict, evidence, bad_parts: case.bad_samples(), samples }
    }

    /// The possible causes for the filter at `place` of a scenario, the likeliest by the evidence, without a trial,
    /// first; for a good verdict other models that may be likelier. Sentences compare with the filter `origin`. The other
    /// arguments are those of [`Self::new`].
    fn likely_causes(
        &self,
        origin: &FilterSettings,
        scenario: &Scenario,
        place: usize,
        diagnostics: &Diagnostics,
        estimates: &Estimates,
        record: &Record,
    ) -> Vec<LikelyCause> {
        let Some(filter) = scenario.filters.get(place).filter(|_| !estimates.is_empty()) else { return Vec::new() };
        let case = live::case(diagnostics, estimates, record, None, self.samples.clone());
        let bad = BadFilter { case: &case, evidence: &self.evidence, scenario, filter, origin };
        let mut likely_causes = Vec::new();
        let causes = match self.verdict.as_ref().map(|verdict| verdict.kind) {
            Some(VerdictKind::Consistent) => ALTERNATIVES,
            // After any change another plant or a drift fits better for a while.
            Some(VerdictKind::Recovered) => &ALTERNATIVES[..3],
            _ => CAUSES,
        };
        for cause in causes {
            (cause.likely_causes)(&bad, cause, &mut likely_causes);
        }
        sort_items(&mut likely_causes, |a, b| b.weight.total_cmp(&a.weight));
        likely_causes
    }

    /// The search for remedies of the filter at `place` of a scenario, of one cause or of several. The other arguments are those of
    /// [`Self::new`].
    ///
    /// # Errors
    /// [`RunError`] where the scenario has no such filter, or the record is not one of such a scenario.
    pub fn search(
        &self,
        scenario: &Scenario,
        place: usize,
        diagnostics: &Diagnostics,
        estimates: &Estimates,
        record: &Record,
    ) -> Result<Search, RunError> {
        let origin = scenario.filters.get(place).ok_or(RunError::NoFilter(place))?;
        let likely_causes = self.likely_causes(origin, scenario, place, diagnostics, estimates, record);
        Ok(Search::new(Trials::new(scenario, place, estimates, record, likely_causes)?))
    }
}
