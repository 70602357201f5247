//! Estimates in the making: samples are appended and forgotten, and memory is used again. Whole columns of a filter's history.

use std::iter::repeat;

use kalmanscope_filters::Channel;

use super::{Estimates, Stop};
use crate::run::sink::{Sample, Sink};
use crate::run::waste::Piecewise;

/// Reserve memory for at most this many samples; the vectors of longer runs grow.
const ROOM: usize = 1 << 18;

/// Limits the numbers freed in one call: 4 MB.
const FREED: usize = 1 << 19;

#[derive(Clone, Debug, Default)]
pub(super) struct History {
    pub(super) mean: Vec<f64>,
    pub(super) cov: Vec<f64>,
    pub(super) innovation: Vec<f64>,
    pub(super) innovation_cov: Vec<f64>,
    pub(super) gain: Vec<f64>,
    pub(super) nis: Vec<f64>,
    pub(super) determinant: Vec<f64>,
    pub(super) log_likelihood: Vec<f64>,
    pub(super) effective_samples: Vec<f64>,
    pub(super) weights: Vec<f64>,
    /// R of each sensor, then the variance of each R.
    pub(super) learnt: Vec<f64>,
    /// Mean and standard deviation of ln s.
    pub(super) process_scale: Vec<f64>,
}

impl Estimates {
    /// Covariances and gains first. The NIS last: it has one number per sample, also without matrices.
    fn columns(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        let Self { history, canonical, variance, .. } = self;
        let History { mean, cov, innovation, innovation_cov, gain, nis, .. } = history;
        let History { determinant, log_likelihood, effective_samples, weights, learnt, process_scale, .. } = history;
        let first = [cov, gain, mean, innovation, innovation_cov, determinant];
        let then = [log_likelihood, effective_samples, weights, learnt, process_scale];
        first.into_iter().chain(then).chain(canonical).chain(variance).chain([nis])
    }

    fn widths(&self) -> impl Iterator<Item = usize> + use<> {
        let (n, m) = (self.channels.len(), self.sensors.len());
        let of = |does: bool, width: usize| if does { width } else { 0 };
        let own = of(self.kind.has_own_likelihood(), 1);
        let (weights, learnt, scales) =
            (of(self.weighs, m), of(self.learns_sensor_noise, 2 * m), of(self.has_process_scale, 2));
        [n * n, n * m, n, m, m * m, 1, own, own, weights, learnt, scales].into_iter().chain(repeat(1))
    }

    /// With room for `samples` or the kept part of a long run. Fresh pages cost more than filling them.
    pub fn recycle(&mut self, old: Option<Self>, samples: usize) {
        let (mut old, widths) = (old.unwrap_or_else(|| self.clone()), self.widths());
        let mut old = old.columns();
        for (new, width) in self.columns().zip(widths) {
            *new = old.next().map(std::mem::take).unwrap_or_default();
            new.clear();
            new.reserve(samples.min(ROOM) * width);
        }
    }

    /// Drops the covariances and gains of all samples but the last, after their diagnostics; [`Self::checksum`] leaves them out.
    pub fn drop_matrices(&mut self) {
        let (n, m) = (self.channels.len(), self.sensors.len());
        self.history.cov.drain(..self.history.cov.len().saturating_sub(n * n));
        self.dropped = self.len().saturating_sub(1);
        if self.dropped_gains() > 0 {
            self.history.gain.drain(..self.history.gain.len().saturating_sub(n * m));
        }
    }

    /// Forgets the first `samples` in place; all of them if the filter has stopped before that.
    pub fn forget(&mut self, samples: usize) {
        let (widths, dropped) = (self.widths(), [self.dropped, self.dropped_gains()]);
        let counts = dropped.map(|dropped| samples.saturating_sub(dropped)).into_iter().chain(repeat(samples));
        self.dropped = self.dropped.saturating_sub(samples);
        for ((values, width), count) in self.columns().zip(widths).zip(counts) {
            values.drain(..(count * width).min(values.len()));
        }
        let first = self.forgotten + samples;
        self.earlier.drain(..self.earlier.partition_point(|(sample, ..)| *sample < first));
        self.forgotten += samples;
        self.monitor.forget_before(self.forgotten);
    }
}

fn push(columns: &mut [Vec<f64>], sample: impl Iterator<Item = f64>) {
    for (values, value) in columns.iter_mut().zip(sample) {
        values.push(value);
    }
}

impl Sink for Estimates {
    #[inline(always)]
    fn push(&mut self, sample: &Sample<'_>) {
        let Sample { mean, cov, innovation, innovation_cov, gain, nis, determinant, .. } = *sample;
        let n = mean.len();
        if self.initial_std.is_empty() {
            self.initial_mean.extend_from_slice(mean);
            self.initial_std.extend((0..n).map(|i| cov[i * n + i].sqrt()));
        }
        self.history.mean.extend_from_slice(mean);
        self.history.cov.extend_from_slice(cov);
        push(&mut self.variance, (0..n).map(|i| cov[i * n + i]));
        if self.frequency.is_some_and(|place| mean[place] < 0.0) {
            let sign = |channel: &Channel| if channel.is_mirrored() { -1.0 } else { 1.0 };
            push(&mut self.canonical, mean.iter().zip(&self.channels).map(|(mean, channel)| mean * sign(channel)));
        } else {
            push(&mut self.canonical, mean.iter().copied());
        }
        self.history.innovation.extend_from_slice(innovation);
        if sample.earlier > 0 || !sample.ln_determinant.is_nan() {
            self.earlier.push((self.forgotten + self.history.nis.len(), sample.earlier, sample.ln_determinant));
        }
        self.history.innovation_cov.extend_from_slice(innovation_cov);
        self.history.gain.extend_from_slice(gain);
        self.history.nis.push(nis);
        self.history.determinant.push(determinant);
        if self.kind.has_own_likelihood() {
            self.history.log_likelihood.push(sample.log_likelihood);
            self.history.effective_samples.push(sample.effective_samples);
        }
        self.history.weights.extend_from_slice(sample.weights);
        if let Some(noise) = sample.noise {
            if self.learns_sensor_noise {
                self.history.learnt.extend(noise.sensors.iter().chain(noise.uncertainty));
            }
            if self.has_process_scale {
                self.history.process_scale.extend(noise.process_scale);
            }
        }
        self.monitor.check(self.forgotten + self.history.nis.len() - 1, sample);
    }

    fn stop_at(&mut self, stop: Stop) {
        self.stop = Some(stop);
    }
}

impl Piecewise for Estimates {
    fn free_piece(&mut self) -> bool {
        let Some(values) = self.columns().find(|values| values.capacity() > 0) else { return false };
        values.clear();
        values.shrink_to(values.capacity().saturating_sub(FREED));
        true
    }
}

/// Each column begins with the first sample that is kept, and has [`Estimates::len`] numbers. `channel` and `sensor` are
/// places in [`Estimates::channels`] and [`Estimates::sensors`]: like an index into a slice, one beyond the last panics.
impl Estimates {
    /// The mean of one channel, as in [`Self::mean`]. [`Self::canonical_means`] has those in canonical form.
    pub fn means(&self, channel: usize) -> impl ExactSizeIterator<Item = f64> + DoubleEndedIterator {
        (0..self.len()).map(move |k| self.mean(k)[channel])
    }

    /// The standard deviation of one channel. [`Self::variances`] has the squares.
    pub fn stds(&self, channel: usize) -> impl ExactSizeIterator<Item = f64> + DoubleEndedIterator {
        self.variances(channel).iter().map(|variance| variance.sqrt())
    }

    /// The innovation e of one sensor in its unit; NaN where it measured nothing.
    pub fn innovations(&self, sensor: usize) -> impl ExactSizeIterator<Item = f64> + DoubleEndedIterator {
        (0..self.len()).map(move |k| self.innovation(k)[sensor])
    }

    /// The standard deviation of the innovation of one sensor, by S; NaN where it measured nothing.
    pub fn innovation_stds(&self, sensor: usize) -> impl ExactSizeIterator<Item = f64> + DoubleEndedIterator {
        let diagonal = sensor * (self.sensors.len() + 1);
        (0..self.len()).map(move |k| self.innovation_cov(k)[diagonal].sqrt())
    }

    /// The gain K of one channel by one sensor: the change of the mean per unit of innovation; NaN where it has been dropped.
    pub fn gains(&self, channel: usize, sensor: usize) -> impl ExactSizeIterator<Item = f64> + DoubleEndedIterator {
        let n = self.channels.len();
        (0..self.len()).map(move |k| match self.gain(k) {
            [] => f64::NAN,
            gain => gain[sensor * n..][..n][channel],
        })
    }

    /// The log likelihood of the measurements, as in [`Self::log_likelihood`]; NaN where there was none.
    pub fn log_likelihoods(&self) -> impl ExactSizeIterator<Item = f64> + DoubleEndedIterator {
        (0..self.len()).map(|k| self.log_likelihood(k))
    }
}
