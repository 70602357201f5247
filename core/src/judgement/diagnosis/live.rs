//! The diagnosis of the last samples of a record that grows, from sums that are kept from one diagnosis to the next.
//!
//! ```text
//! Estimates, Record ──follow──▶ sums of granules, spectra of windows ──add──▶ Case ──tests──▶ Diagnosis
//! ```

use std::ops::Range;

use super::Diagnosis;
use super::case::Case;
use super::errors::LiveErrors;
use super::innovations::{LiveInnovations, Pair};
use super::periodogram::{LiveSpectra, Periodogram};
use crate::mathematics::lists::mapped;
use crate::numbers::diagnostics::Depth;
use crate::{CramerRao, Diagnostics, Estimates, Record};

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
        innovations.take_in(&window, estimates, record);
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
        if diagnostics.depth() != Depth::All || diagnostics.is_empty() {
            return None;
        }
        self.follow(samples.clone(), estimates, record);
        let kept = self.kept.as_ref()?;
        let spectra = |ranges: &[Range<usize>]| kept.spectra.of(ranges, estimates.sensors().len());
        let case = kept.case(diagnostics, estimates, record, bound, samples.clone(), spectra);
        Some(Diagnosis::of(&case, samples))
    }
}

/// No granule is stored, as it is for one time, and the windows of the periodogram begin with the samples.
pub(super) fn case<'a>(
    diagnostics: &'a Diagnostics,
    estimates: &'a Estimates,
    record: &'a Record,
    bound: Option<&'a CramerRao>,
    samples: Range<usize>,
) -> Case<'a> {
    let window = numbers(&existing(samples.clone(), estimates, record), record);
    let mut kept = Kept::new(estimates, record, window.start);
    kept.innovations.take_in(&window, estimates, record);
    let spectra = |ranges: &[Range<usize>]| {
        let ranges: Vec<_> = mapped(ranges, &|of| of.start - window.start..of.end - window.start);
        Periodogram::of_all(&kept.innovations.values(&window), &ranges)
    };
    kept.case(diagnostics, estimates, record, bound, samples, spectra)
}

impl Kept {
    fn new(estimates: &Estimates, record: &Record, start: usize) -> Self {
        let (innovations, errors) = (LiveInnovations::new(estimates, start), LiveErrors::new(estimates, record, start));
        Self { innovations, errors, spectra: LiveSpectra::default() }
    }

    /// `spectra` are the sensors' periodograms over ranges of samples by their numbers.
    fn case<'a>(
        &self,
        diagnostics: &'a Diagnostics,
        estimates: &'a Estimates,
        record: &'a Record,
        bound: Option<&'a CramerRao>,
        samples: Range<usize>,
        spectra: impl Fn(&[Range<usize>]) -> Vec<Periodogram>,
    ) -> Case<'a> {
        let samples = existing(samples, estimates, record);
        let window = numbers(&samples, record);
        let (sensors, errors) =
            (self.innovations.by_part(&window, record), self.errors.by_part(&window, estimates, record));
        let mut case = Case::new(diagnostics, estimates, record, bound, samples, sensors, errors);
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

/// The numbers of some kept samples, counted from the run's beginning.
fn numbers(kept: &Range<usize>, record: &Record) -> Range<usize> {
    kept.start + record.forgotten()..kept.end + record.forgotten()
}
