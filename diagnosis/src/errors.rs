//! The errors of each channel with a known truth: sums by part of the record.

use std::ops::Range;

use kalmanscope_core::{Channel, Estimates, Record};

use super::parts::{self, Chosen, PARTS};

#[derive(Clone, Debug)]
pub(crate) struct ChannelErrors {
    pub(crate) channel: Channel,
    pub(crate) by_part: [ChannelErrorSums; PARTS],
}

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ChannelErrorSums {
    pub(crate) count: f64,
    pub(crate) square: f64,
    pub(crate) product: f64,
    pub(crate) inside: f64,
}

impl ChannelErrors {
    /// Of the channels with a known truth in these samples.
    pub(super) fn of_all(samples: &Range<usize>, estimates: &Estimates, record: &Record) -> Vec<Self> {
        let of = |(place, &channel): (usize, &Channel)| {
            let truth = record.truth(channel)?;
            let (means, variances) = (estimates.canonical_means(place), estimates.variances(place));
            // The first error of a part follows the last one of the part before.
            let mut last = 0.0;
            let by_part = std::array::from_fn(|part| {
                let mut sums = ChannelErrorSums::default();
                for k in parts::range(part, samples) {
                    let error = (means[k] - truth[k]) / variances[k].sqrt();
                    if error.is_nan() || variances[k] == 0.0 {
                        continue;
                    }
                    sums.count += 1.0;
                    sums.square += error * error;
                    sums.product += error * last;
                    sums.inside += if error.abs() <= 2.0 { 1.0 } else { 0.0 };
                    last = error;
                }
                sums
            });
            by_part.iter().any(|sums| sums.count > 0.0).then_some(Self { channel, by_part })
        };
        estimates.channels().iter().enumerate().filter_map(of).collect()
    }

    /// The mean of (e/σ)² over some parts; NaN where the truth is not known there.
    pub(crate) fn level(&self, chosen: &Chosen) -> f64 {
        parts::sum(chosen, |part| self.by_part[part].square) / self.count(chosen)
    }

    pub(crate) fn count(&self, chosen: &Chosen) -> f64 {
        parts::sum(chosen, |part| self.by_part[part].count)
    }

    pub(crate) fn coverage(&self, chosen: &Chosen) -> f64 {
        parts::sum(chosen, |part| self.by_part[part].inside) / self.count(chosen)
    }

    /// The number of independent errors, by their correlation ρ from one sample to the next:
    /// ```text
    /// n (1 - ρ²) / (1 + ρ²)
    /// ```
    /// Source: Bartlett (1946), On the theoretical specification and sampling properties of autocorrelated time-series.
    pub(crate) fn independent(&self, chosen: &Chosen) -> f64 {
        let square = parts::sum(chosen, |part| self.by_part[part].square);
        let product = parts::sum(chosen, |part| self.by_part[part].product);
        let correlation = if square > 0.0 { (product / square).clamp(0.0, 0.999_999) } else { 0.0 };
        let squared = correlation * correlation;
        (self.count(chosen) * (1.0 - squared) / (1.0 + squared)).max(1.0)
    }
}
