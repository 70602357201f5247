//! One pass over the errors of each channel with a known truth.

use std::ops::Range;

use super::parts::{self, Chosen, PARTS};
use crate::{Channel, Estimates, Record};

/// The normalised errors `e / σ` of one channel.
#[derive(Clone, Debug)]
pub(crate) struct ChannelErrors {
    pub(crate) channel: Channel,
    pub(crate) by_part: [Sums; PARTS],
}

/// The sums of one part.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sums {
    pub(crate) count: f64,
    /// Sum of (e/σ)².
    pub(crate) square: f64,
    /// Sum of the products of e/σ with that of the sample before.
    pub(crate) product: f64,
    /// Samples with the truth inside ±2σ.
    pub(crate) inside: f64,
}

impl Sums {
    /// Adds the normalised error of a sample, if it is known. `before` is the last known error.
    #[inline]
    pub(crate) fn take_in(&mut self, error: f64, variance: f64, before: &mut f64) {
        if error.is_nan() || variance == 0.0 {
            return;
        }
        self.count += 1.0;
        self.square += error * error;
        self.product += error * *before;
        self.inside += if error.abs() <= 2.0 { 1.0 } else { 0.0 };
        *before = error;
    }
}

impl ChannelErrors {
    /// The pass over all channels of some estimates; those that are known for certain are left out.
    pub(crate) fn of_all(estimates: &Estimates, record: &Record, samples: &Range<usize>) -> Vec<Self> {
        let one = |(place, &channel): (usize, &Channel)| {
            let truth = record.truth(channel)?;
            let (means, variances) = (estimates.canonical_means(place), estimates.variances(place));
            let mut by_part = [Sums::default(); PARTS];
            let mut before = 0.0;
            for (part, sums) in by_part.iter_mut().enumerate() {
                for k in parts::range(part, samples) {
                    sums.take_in((means[k] - truth[k]) / variances[k].sqrt(), variances[k], &mut before);
                }
            }
            let any = by_part.iter().any(|sums| sums.count > 0.0);
            any.then_some(Self { channel, by_part })
        };
        estimates.channels().iter().enumerate().filter_map(one).collect()
    }

    /// The mean of (e/σ)² over some parts; NaN where the truth is not known there.
    pub(crate) fn level(&self, chosen: &Chosen) -> f64 {
        parts::sum(chosen, |part| self.by_part[part].square) / self.count(chosen)
    }

    /// The number of errors in some parts.
    pub(crate) fn count(&self, chosen: &Chosen) -> f64 {
        parts::sum(chosen, |part| self.by_part[part].count)
    }

    /// The share of samples in some parts with the truth inside ±2σ.
    pub(crate) fn coverage(&self, chosen: &Chosen) -> f64 {
        parts::sum(chosen, |part| self.by_part[part].inside) / self.count(chosen)
    }

    /// The number of errors in some parts that count as independent, from their correlation ρ from one sample to the
    /// next.
    ///
    /// ```text
    /// n (1 - ρ²) / (1 + ρ²)
    /// ```
    ///
    /// Source: Bartlett (1946), On the theoretical specification and sampling properties of autocorrelated time-series.
    pub(crate) fn independent(&self, chosen: &Chosen) -> f64 {
        let square = parts::sum(chosen, |part| self.by_part[part].square);
        let product = parts::sum(chosen, |part| self.by_part[part].product);
        let correlation = if square > 0.0 { (product / square).clamp(0.0, 0.999_999) } else { 0.0 };
        let squared = correlation * correlation;
        (self.count(chosen) * (1.0 - squared) / (1.0 + squared)).max(1.0)
    }
}
