//! The errors of each channel with a known truth: sums by part of the record.

use std::ops::Range;

use kalmanscope_core::{Channel, Estimates, Record};

use super::parts::{self, Chosen, PARTS, Piece, Series, first_in, pieces};

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
    first: f64,
    last: f64,
}

#[derive(Debug)]
pub(super) struct LiveErrors {
    channels: Vec<LiveChannel>,
}

#[derive(Debug)]
struct LiveChannel {
    channel: Channel,
    place: usize,
    granules: Series<ChannelErrorSums>,
}

impl LiveErrors {
    pub(super) fn new(estimates: &Estimates, record: &Record, start: usize) -> Self {
        let all = estimates.channels().iter().enumerate();
        let known = all.filter(|(_, channel)| record.truth(**channel).is_some());
        let granules = Series::starting_at(first_in(start));
        let one = |(place, &channel)| LiveChannel { channel, place, granules: granules.clone() };
        Self { channels: known.map(one).collect() }
    }

    pub(super) fn follow(&mut self, window: &Range<usize>, estimates: &Estimates, record: &Record) {
        for LiveChannel { channel, place, granules } in &mut self.channels {
            granules.follow(window, |samples| {
                let mut sums = ChannelErrorSums::default();
                sums.add_samples((*channel, *place), samples, estimates, record);
                sums
            });
        }
    }

    pub(super) fn by_part(&self, window: &Range<usize>, estimates: &Estimates, record: &Record) -> Vec<ChannelErrors> {
        let one = |of: &LiveChannel| {
            let mut last = 0.0;
            let by_part = std::array::from_fn(|part| {
                let mut sums = ChannelErrorSums { last, ..ChannelErrorSums::default() };
                for Piece { samples, granule } in pieces(&parts::range(part, window), window) {
                    match granule.and_then(|number| of.granules.get(number)) {
                        Some(granule) => sums.add(granule),
                        None => sums.add_samples((of.channel, of.place), &samples, estimates, record),
                    }
                }
                last = sums.last;
                sums
            });
            let any = by_part.iter().any(|sums| sums.count > 0.0);
            any.then_some(ChannelErrors { channel: of.channel, by_part })
        };
        self.channels.iter().filter_map(one).collect()
    }
}

impl ChannelErrorSums {
    fn add_samples(
        &mut self,
        (channel, place): (Channel, usize),
        samples: &Range<usize>,
        estimates: &Estimates,
        record: &Record,
    ) {
        let Some(truth) = record.truth(channel) else { return };
        let (means, variances) = (estimates.canonical_means(place), estimates.variances(place));
        for k in samples.start - record.forgotten()..samples.end - record.forgotten() {
            let error = (means[k] - truth[k]) / variances[k].sqrt();
            if error.is_nan() || variances[k] == 0.0 {
                continue;
            }
            self.first = if self.count == 0.0 { error } else { self.first };
            self.count += 1.0;
            self.square += error * error;
            self.product += error * self.last;
            self.inside += if error.abs() <= 2.0 { 1.0 } else { 0.0 };
            self.last = error;
        }
    }

    fn add(&mut self, of: &Self) {
        if of.count == 0.0 {
            return;
        }
        self.count += of.count;
        self.square += of.square;
        self.product += of.product + of.first * self.last;
        self.inside += of.inside;
        self.last = of.last;
    }
}

impl ChannelErrors {
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
