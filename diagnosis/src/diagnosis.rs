//! The diagnosis of a filter: the verdict, its evidence, and the settings to turn if it is bad.
//!
//! ```text
//! Estimates, Record ──follow──▶ sums of granules, spectra of windows ──add──▶ Case
//! Case ──tests──▶ Evidence ──level──▶ Verdict ──causes──▶ LikelyCauses ──trials, search──▶ Remedies
//! ```
//!
//! Each test ([`Test`]) is an item of a file in `checks/`, each cause ([`Cause`]) one in `cause/`.

use std::ops::Range;

use kalmanscope_core::diagnostics::Depth;
use kalmanscope_core::internals::{mapped, sort_items};
use kalmanscope_core::{CramerRao, Diagnostics, Estimates, FilterSettings, Record, Scenario};

use super::case::{Case, Inputs};
use super::cause::{ALTERNATIVES, BadFilter};
use super::errors::LiveErrors;
use super::innovations::{LiveInnovations, Pair};
use super::periodogram::{LiveSpectra, Periodogram};
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
        if diagnostics.depth != Depth::All || diagnostics.is_empty() {
            return None;
        }
        let case = case_of((diagnostics, estimates, record, bound), samples.clone());
        Some(Self::of(&case, samples))
    }

    fn of(case: &Case<'_>, samples: Range<usize>) -> Self {
        let mut evidence = Vec::new();
        for test in TESTS {
            (test.run)(case, test, &mut evidence);
        }
        checks::decide(&mut evidence);
        let verdict = Verdict::of(case, &evidence);
        Self { verdict, evidence, bad_parts: case.bad_samples(), samples }
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
        let case = case_of((diagnostics, estimates, record, None), self.samples.clone());
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
}

/// The diagnosis of one filter over a window of samples that moves with a growing record.
///
/// It equals [`Diagnosis::over`] the same samples, except for rounding and for the periodogram: its windows begin at
/// multiples of their length from the run's beginning. Each sample is taken in once. Innovations and errors are added
/// up over granules of 16 samples, and a part of the window is the sum of whole granules and of the samples at its
/// edges. Nothing is subtracted, so that a number outside a part cannot change its sum. The memory is that of twice the
/// window.
#[derive(Debug, Default)]
pub struct LiveDiagnosis {
    kept: Option<Kept>,
}

#[derive(Debug)]
struct Kept {
    innovations: LiveInnovations,
    errors: LiveErrors,
    spectra: LiveSpectra,
}

impl LiveDiagnosis {
    /// Takes in the new samples of a range of kept ones, and forgets the samples before the range.
    ///
    /// `estimates` and `record` must be those that this began with, grown longer; they may have forgotten samples. If
    /// the range includes samples that were forgotten here, it begins again with them.
    pub fn follow(&mut self, samples: Range<usize>, estimates: &Estimates, record: &Record) {
        let window = numbers(&existing(samples, estimates, record), record);
        let kept = self.kept.take().filter(|kept| kept.innovations.reaches(window.start));
        let kept = kept.unwrap_or_else(|| Kept::new(estimates, record, window.start));
        let Kept { innovations, errors, spectra } = self.kept.insert(kept);
        innovations.extend(&window, estimates, record);
        innovations.follow(&window, record);
        errors.follow(&window, estimates, record);
        spectra.follow(&window, |samples| innovations.values(samples));
    }

    /// [`Diagnosis::over`] these samples, after [`Self::follow`].
    pub fn over(
        &mut self,
        samples: Range<usize>,
        diagnostics: &Diagnostics,
        estimates: &Estimates,
        record: &Record,
        bound: Option<&CramerRao>,
    ) -> Option<Diagnosis> {
        if diagnostics.depth != Depth::All || diagnostics.is_empty() {
            return None;
        }
        self.follow(samples.clone(), estimates, record);
        let kept = self.kept.as_ref()?;
        let spectra = |ranges: &[Range<usize>]| kept.spectra.of(ranges, estimates.sensors().len());
        let case = kept.case((diagnostics, estimates, record, bound), samples.clone(), spectra);
        Some(Diagnosis::of(&case, samples))
    }
}

/// No granule is stored, as it is for one time, and the windows of the periodogram begin with the samples.
fn case_of(inputs: Inputs<'_>, samples: Range<usize>) -> Case<'_> {
    let (_, estimates, record, _) = inputs;
    let window = numbers(&existing(samples.clone(), estimates, record), record);
    let mut kept = Kept::new(estimates, record, window.start);
    kept.innovations.extend(&window, estimates, record);
    let spectra = |ranges: &[Range<usize>]| {
        let ranges: Vec<_> = mapped(ranges, &|of| of.start - window.start..of.end - window.start);
        Periodogram::of_all(&kept.innovations.values(&window), &ranges)
    };
    kept.case(inputs, samples, spectra)
}

impl Kept {
    fn new(estimates: &Estimates, record: &Record, start: usize) -> Self {
        let (innovations, errors) = (LiveInnovations::new(estimates, start), LiveErrors::new(estimates, record, start));
        Self { innovations, errors, spectra: LiveSpectra::default() }
    }

    fn case<'a>(
        &self,
        inputs: Inputs<'a>,
        samples: Range<usize>,
        spectra: impl Fn(&[Range<usize>]) -> Vec<Periodogram>,
    ) -> Case<'a> {
        let (_, estimates, record, _) = inputs;
        let samples = existing(samples, estimates, record);
        let window = numbers(&samples, record);
        let (sensors, errors) =
            (self.innovations.by_part(&window, record), self.errors.by_part(&window, estimates, record));
        let mut case = Case::new(inputs, samples, sensors, errors);
        let ranges: Vec<_> = mapped(&case.ranges(|part| case.kept[part]), &|of| numbers(of, record));
        for (one, periodogram) in case.sensors.iter_mut().zip(spectra(&ranges)) {
            one.periodogram = periodogram;
        }
        if case.sensors.len() > 1 {
            let ranges: Vec<_> = mapped(&ranges, &|of| of.start - window.start..of.end - window.start);
            case.pairs = Pair::of_all(&case.sensors, &self.innovations.values(&window), &ranges);
        }
        case
    }
}

fn existing(samples: Range<usize>, estimates: &Estimates, record: &Record) -> Range<usize> {
    let end = samples.end.min(estimates.len()).min(record.len());
    samples.start.min(end)..end
}

fn numbers(kept: &Range<usize>, record: &Record) -> Range<usize> {
    kept.start + record.forgotten()..kept.end + record.forgotten()
}
