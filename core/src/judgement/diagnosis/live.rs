//! The diagnosis of the last samples of a record that grows, from sums that are kept from one diagnosis to the next.
//!
//! ```text
//! Estimates, Record ──follow──▶ sums of granules, spectra of windows ──add──▶ Case ──tests──▶ Diagnosis
//! ```

mod errors;
mod granule;
mod innovations;
mod input;
mod series;
mod spectra;

use std::ops::Range;

use super::case::Case;
use super::{Diagnosis, one_pass};
use crate::numbers::diagnostics::Depth;
use crate::{CramerRao, Diagnostics, Estimates, Record};

use errors::LiveErrors;
use innovations::LiveInnovations;
use spectra::LiveSpectra;

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

/// The sums of the samples of the window and of later ones.
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
        let samples = one_pass::existing(samples, estimates, record);
        let window = numbers(&samples, record);
        let kept = match self.kept.take() {
            Some(kept) if kept.innovations.reaches(window.start) => kept,
            _ => Kept {
                innovations: LiveInnovations::new(estimates, window.start),
                errors: LiveErrors::new(estimates, record, window.start),
                spectra: LiveSpectra::default(),
            },
        };
        let Kept { innovations, errors, spectra } = self.kept.insert(kept);
        innovations.follow(&window, estimates, record);
        errors.follow(&window, estimates, record);
        spectra.follow(&window, innovations);
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
        let Kept { innovations, errors, spectra } = self.kept.as_ref()?;
        let existing = one_pass::existing(samples.clone(), estimates, record);
        let window = numbers(&existing, record);
        let sensors = innovations.by_part(&window, record);
        let channels = errors.by_part(&window, estimates, record);
        let case = Case::new(diagnostics, estimates, record, bound, existing, sensors, channels);
        let kept: Vec<Range<usize>> = case.kept_samples().map(|of| numbers(&of, record)).collect();
        let periodograms = spectra.of(&kept, case.sensors.len());
        Some(Diagnosis::of(&case.with_periodograms(periodograms), samples))
    }
}

/// The numbers of some kept samples, counted from the run's beginning.
fn numbers(kept: &Range<usize>, record: &Record) -> Range<usize> {
    kept.start + record.forgotten()..kept.end + record.forgotten()
}
