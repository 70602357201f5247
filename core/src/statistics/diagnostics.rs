//! The diagnostics of a filter: how far it is from the truth, and whether its covariance agrees with that.

pub(crate) mod accuracy;
pub mod chi_squared;
mod totals;
mod whiteness;

use std::ops::Range;

use kalmanscope_filters::{Channel, Stop};
use kalmanscope_records::Record;

use crate::run::waste::Piecewise;
use crate::statistics::score::Scores;
use crate::{Estimates, Sink as _};
use accuracy::Tracked;
use totals::{RangeSums, Totals};

pub use accuracy::ErrorSums;
pub use totals::{MeanSquare, Total};
pub use whiteness::{LAGS, LjungBox, Whiteness};

/// The accuracy and consistency of one filter, from running sums that are updated sample by sample.
///
/// Errors are those of the canonical form ([`Estimates::canonical_mean`]). Portions change no bit.
///
/// Indices count from the first sample that is kept. Of forgotten samples only the settling time is remembered.
#[derive(Clone, Debug, Default)]
pub struct Diagnostics {
    scores: Scores,
    samples: usize,
    forgotten: usize,
    errors: Vec<RangeSums>,
    nees: Vec<f64>,
    nees_totals: Totals,
    inside: u32,
    nis: Totals,
    /// The 95 % quantile of χ² for one and more degrees of freedom.
    limits: Vec<f64>,
    /// The whiteness of the innovations, sensor by sensor.
    pub whiteness: Vec<Whiteness>,
    /// Where and why the filter stopped, if it did.
    pub stop: Option<Stop>,
}

impl Diagnostics {
    /// The diagnostics of all estimates of a filter so far, against the record that it uses.
    pub fn new(estimates: &Estimates, record: &Record) -> Self {
        let mut diagnostics = Self::default();
        diagnostics.restart(estimates, record);
        diagnostics
    }

    /// Begins again with other estimates, and reuses the memory.
    pub fn restart(&mut self, estimates: &Estimates, record: &Record) {
        self.clear(estimates, record);
        self.follow_to(estimates.len(), estimates, record);
    }

    /// Removes what was taken in, and keeps the memory.
    pub fn clear(&mut self, estimates: &Estimates, record: &Record) {
        let Self { scores, samples, forgotten, errors, nees, nees_totals, inside, nis, limits, whiteness, stop } = self;
        *scores = Scores::new(estimates, record);
        (*samples, *forgotten, *inside, *stop) = (0, estimates.forgotten(), 0, None);
        let known = scores.sums.tracked.len();
        errors.resize_with(known, RangeSums::default);
        errors.iter_mut().for_each(RangeSums::clear);
        nees.clear();
        nees_totals.clear();
        nis.clear();
        for degrees in limits.len()..known {
            limits.push(chi_squared::quantile(0.95, degrees as u32 + 1).unwrap_or(f64::INFINITY));
        }
        whiteness.clear();
        whiteness.resize(estimates.sensors().len(), Whiteness::default());
    }

    /// Takes in the new samples up to one, each in constant time. Where samples have been forgotten, begins again with the rest.
    pub fn follow_to(&mut self, end: usize, estimates: &Estimates, record: &Record) {
        if estimates.forgotten() != self.forgotten {
            let seen_all = self.forgotten + self.samples >= estimates.forgotten();
            let before = std::mem::take(&mut self.scores);
            self.restart(estimates, record);
            if seen_all {
                self.remember(&before.sums.tracked);
            }
            return;
        }
        let end = end.min(estimates.len());
        for k in self.samples..end {
            self.push(estimates, record, k);
        }
        self.samples = self.samples.max(end);
        self.stop = estimates.stop().filter(|_| end == estimates.len());
    }

    fn push(&mut self, estimates: &Estimates, record: &Record, k: usize) {
        let Self { scores, errors, nees, nees_totals, inside, nis, limits, whiteness, .. } = self;
        let (sample, before) = (estimates.sample(k), scores.sums.nees.degrees);
        scores.against(record).push(&sample);
        let sums = &scores.sums;
        let [square, of_update] = sums.last;
        nees.push(square);
        nees_totals.push(square, sums.nees.total(0));
        nis.push(of_update, sums.nis.total(0));
        let limit = ((sums.nees.degrees - before) as usize).checked_sub(1).map(|place| limits[place]);
        *inside += u32::from(limit.is_some_and(|limit| square <= limit));
        for (errors, tracked) in errors.iter_mut().zip(&sums.tracked) {
            let (error, ErrorSums { known, inside, .. }) = (tracked.error, tracked.total(0));
            errors.push(if error.is_nan() { 0.0 } else { error * error }, (known, inside));
        }
        let m = whiteness.len();
        for (i, (whiteness, innovation)) in whiteness.iter_mut().zip(sample.innovation).enumerate() {
            whiteness.push(innovation / sample.innovation_cov[i * (m + 1)].sqrt());
        }
    }

    fn remember(&mut self, before: &[Tracked<f64>]) {
        let tracked = self.scores.sums.tracked.iter_mut().zip(before);
        for (known, before) in tracked.filter(|(_, before)| before.known > 0.0) {
            known.first_error = before.first_error;
            known.largest_truth = known.largest_truth.max(before.largest_truth);
            if known.settled == self.forgotten as f64 {
                known.settled = known.settled.min(before.settled);
            }
        }
    }

    fn place(&self, channel: Channel) -> Option<usize> {
        self.scores.sums.tracked.iter().position(|known| known.channel == channel)
    }

    fn within(&self, at: usize, range: Range<usize>) -> ErrorSums {
        let (squares, (known, inside)) = self.errors[at].within(range, self.scores.sums.tracked[at].total(0).squares);
        ErrorSums { squares, known, inside }
    }

    /// The number of samples taken in.
    pub fn len(&self) -> usize {
        self.samples
    }

    /// Whether no sample has been taken in.
    pub fn is_empty(&self) -> bool {
        self.samples == 0
    }

    /// The estimated channels with a known truth.
    pub fn known(&self) -> impl Iterator<Item = Channel> {
        self.scores.sums.tracked.iter().map(|known| known.channel)
    }

    /// A channel's last error, estimate minus truth, in its unit. `None` if the truth is not known.
    pub fn error(&self, channel: Channel) -> Option<f64> {
        Some(self.scores.sums.tracked[self.place(channel)?].error).filter(|error| !error.is_nan())
    }

    /// The tally of a channel's errors over a range of samples. `None` if the truth is not known.
    pub fn tally(&self, channel: Channel, range: Range<usize>) -> Option<ErrorSums> {
        let tally = self.within(self.place(channel)?, range);
        (tally.known > 0).then_some(tally)
    }

    /// Channels whose root mean square error over the last fifth exceeds `limit` std, truth and initial belief: it in std, and itself.
    pub fn lost(&self, estimates: &Estimates, limit: f64) -> Vec<(Channel, f64, f64)> {
        let Some(last) = self.samples.checked_sub(1) else { return Vec::new() };
        let recent = self.samples * 4 / 5..self.samples;
        let is_lost = |(at, known): (usize, &Tracked<f64>)| {
            let rmse = self.within(at, recent.clone()).rmse();
            let (first, std) = (estimates.initial_std(known.place), estimates.std(last, known.place));
            let seen = known.largest_truth.max(known.first_error);
            accuracy::is_lost(rmse, std, limit, seen, first).then_some((known.channel, rmse / std, rmse))
        };
        self.scores.sums.tracked.iter().enumerate().filter_map(is_lost).collect()
    }

    /// The last third of the samples.
    pub fn last_third(&self) -> Range<usize> {
        (2 * self.samples).div_ceil(3)..self.samples
    }

    /// The sample, from the run's beginning, since which a channel's estimate stays within 5 % of the truth, if it does.
    pub fn settled(&self, channel: Channel) -> Option<usize> {
        let Tracked { settled, known, .. } = self.scores.sums.tracked[self.place(channel)?];
        let (settled, end) = (settled as usize, self.forgotten + self.samples);
        (known > 0.0 && settled < end).then_some(settled)
    }

    /// The normalised estimation error squared of every sample; NaN without a truth or a factor of the covariance.
    ///
    /// ```text
    /// NEES = eᵀ P⁻¹ e
    /// ```
    ///
    /// over all channels of known truth and positive variance.
    ///
    /// Source: Bar-Shalom, Li and Kirubarajan (2001), *Estimation with Applications to Tracking and Navigation*, section 5.4.
    pub fn nees(&self) -> &[f64] {
        &self.nees
    }

    /// The sum of the NEES over a range of samples.
    pub fn nees_within(&self, range: Range<usize>) -> Total {
        self.nees_totals.within(range)
    }

    /// For each sample of a range, the NEES of the `window` samples up to it over its expectation; NaN where there is none.
    pub fn moving_nees(&self, window: usize, range: Range<usize>) -> Vec<f64> {
        self.nees_totals.moving_means(window, range)
    }

    /// The mean NEES of all samples, and the 95 % interval of a single sample's.
    ///
    /// Errors of one run are correlated from sample to sample, so the interval is that of a single one, which is wide.
    pub fn mean_nees(&self) -> Option<MeanSquare> {
        MeanSquare::new(self.nees_totals.whole, 1)
    }

    /// The share of samples whose NEES is below the 95 % quantile of χ²: the truth is inside the belief's 95 % ellipsoid.
    pub fn share_in_ellipsoid(&self) -> Option<f64> {
        let share = f64::from(self.inside) / f64::from(self.nees_totals.whole.samples);
        Some(share).filter(|share| !share.is_nan())
    }

    /// The sum of the NIS over a range of samples.
    pub fn nis_within(&self, range: Range<usize>) -> Total {
        self.nis.within(range)
    }

    /// For each sample of a range, the NIS of the `window` samples up to it over its expectation; NaN where there is none.
    pub fn moving_nis(&self, window: usize, range: Range<usize>) -> Vec<f64> {
        self.nis.moving_means(window, range)
    }

    /// The mean NIS of all samples with a measurement, and its 95 % interval for independent innovations.
    pub fn mean_nis(&self) -> Option<MeanSquare> {
        let total = self.nis.whole;
        MeanSquare::new(total, total.samples)
    }

    /// Sum of the log likelihoods of all samples with a measurement.
    pub fn log_likelihood(&self) -> f64 {
        self.scores.log_likelihood()
    }

    /// The same as the evidence of a model class ([`ModelClasses`](crate::ModelClasses)): minus infinity where the filter stopped.
    pub fn log_evidence(&self) -> f64 {
        if self.stop.is_some() { f64::NEG_INFINITY } else { self.log_likelihood() }
    }
}

impl Piecewise for Diagnostics {}
