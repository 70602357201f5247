//! The diagnosis of a filter: the verdict, its evidence, and the settings to turn if it is bad.
//!
//! ```text
//! Estimates, Record ──▶ sums by part, spectra of windows ──▶ Case
//! Case ──tests──▶ Evidence ──level──▶ Verdict ──causes──▶ LikelyCauses ──trials, search──▶ Remedies
//! ```
//!
//! Each test is an item of a file in `checks/`, each cause one in `cause/`.

use std::ops::Range;

use kalmanscope_core::internals::sort_items;
use kalmanscope_core::{Diagnostics, Estimates, FilterSettings, Record, Scenario};

use super::case::Case;
use super::cause::{ALTERNATIVES, BadFilter};
use super::{CAUSES, Evidence, LikelyCause, TESTS, Verdict, VerdictKind, checks};

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
    /// The diagnosis of a filter, in one pass of about 0.1 µs a kept sample. `None` if the diagnostics are empty.
    pub fn new(diagnostics: &Diagnostics, estimates: &Estimates, record: &Record) -> Option<Self> {
        Self::over(0..diagnostics.len(), diagnostics, estimates, record)
    }

    /// The same over a range of the kept samples, such as those that a screen shows.
    pub fn over(
        samples: Range<usize>,
        diagnostics: &Diagnostics,
        estimates: &Estimates,
        record: &Record,
    ) -> Option<Self> {
        if diagnostics.is_empty() {
            return None;
        }
        let case = Case::new(samples.clone(), diagnostics, estimates, record);
        let mut evidence = Vec::new();
        TESTS.iter().for_each(|test| (test.run)(&case, test, &mut evidence));
        checks::decide(&mut evidence);
        let verdict = Verdict::of(&case, &evidence);
        let bad_parts = case.ranges(|part| case.bad[part] || case.forgiven[part]);
        Some(Self { verdict, evidence, bad_parts, samples })
    }

    /// The likeliest by the evidence, without a trial, come first; for a good verdict other models that may be likelier.
    pub fn likely_causes(
        &self,
        origin: &FilterSettings,
        scenario: &Scenario,
        place: usize,
        diagnostics: &Diagnostics,
        estimates: &Estimates,
        record: &Record,
    ) -> Vec<LikelyCause> {
        let Some(filter) = scenario.filters.get(place).filter(|_| !estimates.is_empty()) else { return Vec::new() };
        let case = Case::new(self.samples.clone(), diagnostics, estimates, record);
        let bad = BadFilter { case: &case, evidence: &self.evidence, scenario, filter, origin };
        let mut likely_causes = Vec::new();
        let causes = match self.verdict.as_ref().map(|verdict| verdict.kind) {
            Some(VerdictKind::Consistent) => ALTERNATIVES,
            // After any change another plant or a drift fits better for a while.
            Some(VerdictKind::Recovered) => &ALTERNATIVES[..3],
            _ => CAUSES,
        };
        causes.iter().for_each(|cause| (cause.likely_causes)(&bad, cause, &mut likely_causes));
        sort_items(&mut likely_causes, |a, b| b.weight.total_cmp(&a.weight));
        likely_causes
    }
}
