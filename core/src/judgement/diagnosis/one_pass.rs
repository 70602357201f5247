//! A case from one pass over its samples.

use std::ops::Range;

use super::case::Case;
use super::errors::ChannelErrors;
use super::innovations::SensorInnovations;
use super::periodogram::Periodogram;
use crate::{CramerRao, Diagnostics, Estimates, Record};

/// The case over some samples, as far as they exist.
pub(super) fn case<'a>(
    diagnostics: &'a Diagnostics,
    estimates: &'a Estimates,
    record: &'a Record,
    bound: Option<&'a CramerRao>,
    samples: Range<usize>,
) -> Case<'a> {
    let samples = existing(samples, estimates, record);
    let (sensors, values): (Vec<_>, Vec<_>) =
        SensorInnovations::of_all(estimates, record, &samples).into_iter().unzip();
    let errors = ChannelErrors::of_all(estimates, record, &samples);
    let first = samples.start;
    let case = Case::new(diagnostics, estimates, record, bound, samples, sensors, errors);
    let kept: Vec<Range<usize>> = case.kept_samples().map(|of| of.start - first..of.end - first).collect();
    let values: Vec<&[f64]> = values.iter().map(Vec::as_slice).collect();
    case.with_periodograms(Periodogram::of_all(&values, &kept))
}

/// The part of some samples that has estimates and measurements.
pub(super) fn existing(samples: Range<usize>, estimates: &Estimates, record: &Record) -> Range<usize> {
    let end = samples.end.min(estimates.len()).min(record.len());
    samples.start.min(end)..end
}
