//! Estimates in the making: samples are appended and forgotten, and memory is used again.

use super::{Estimates, Stop};
use crate::Channel;
use crate::samples::sample::Sample;
use crate::samples::waste::Piecewise;

/// Reserve memory for at most this many samples; the vectors of longer runs grow.
const ROOM: usize = 1 << 18;

/// Limits the numbers freed in one call: 4 MB.
const FREED: usize = 1 << 19;

impl Estimates {
    /// With room for `samples` or the kept part of a long run. Fresh pages cost more than filling them.
    pub(crate) fn recycle(&mut self, old: Option<Self>, samples: usize) {
        let (n, m) = (self.channels.len(), self.sensors.len());
        let sampled = usize::from(self.kind.has_own_likelihood());
        let [weighed, learnt] = [self.weighs, self.learns].map(|does| if does { m } else { 0 });
        let mut old = old.unwrap_or_else(|| self.clone());
        for (new, old, per_sample) in [
            (&mut self.mean, &mut old.mean, n),
            (&mut self.cov, &mut old.cov, n * n),
            (&mut self.innovation, &mut old.innovation, m),
            (&mut self.innovation_cov, &mut old.innovation_cov, m * m),
            (&mut self.gain, &mut old.gain, n * m),
            (&mut self.nis, &mut old.nis, 1),
            (&mut self.determinant, &mut old.determinant, 1),
            (&mut self.log_likelihood, &mut old.log_likelihood, sampled),
            (&mut self.effective_samples, &mut old.effective_samples, sampled),
            (&mut self.weights, &mut old.weights, weighed),
            (&mut self.learnt, &mut old.learnt, 2 * learnt),
            (&mut self.process_scale, &mut old.process_scale, if self.scales { 2 } else { 0 }),
        ] {
            *new = std::mem::take(old);
            new.clear();
            new.reserve(samples.min(ROOM) * per_sample);
        }
        self.canonical.recycle(old.canonical, samples.min(ROOM));
        self.variance.recycle(old.variance, samples.min(ROOM));
    }

    /// Drops the covariances and gains of all samples so far but the last, which is more than half of the memory. Diagnostics must
    /// have followed before; a diagnosis, its causes and a free run need only the rest: means, variances, innovations
    /// and their covariances. [`Self::cov`] and [`Self::gain`] of these samples are empty from now on;
    /// [`Self::checksum`] leaves them out.
    pub fn drop_matrices(&mut self) {
        let (n, m) = (self.channels.len(), self.sensors.len());
        self.cov.drain(..self.cov.len().saturating_sub(n * n));
        self.dropped = self.len().saturating_sub(1);
        if self.dropped_gains() > 0 {
            self.gain.drain(..self.gain.len().saturating_sub(n * m));
        }
    }

    /// Forgets the first `samples` in place; all of them if the filter has stopped before that.
    pub(crate) fn forget(&mut self, samples: usize) {
        let (n, m) = (self.channels.len(), self.sensors.len());
        let with_cov = samples.saturating_sub(self.dropped);
        let with_gain = samples.saturating_sub(self.dropped_gains());
        self.dropped = self.dropped.saturating_sub(samples);
        let Self { mean, cov, innovation, innovation_cov, gain, nis, .. } = self;
        let Self { determinant, log_likelihood, effective_samples, weights, learnt, process_scale, .. } = self;
        for (values, samples, per_sample) in [
            (mean, samples, n),
            (cov, with_cov, n * n),
            (innovation, samples, m),
            (innovation_cov, samples, m * m),
            (gain, with_gain, n * m),
            (nis, samples, 1),
            (determinant, samples, 1),
            (log_likelihood, samples, 1),
            (effective_samples, samples, 1),
            (weights, samples, m),
            (learnt, samples, 2 * m),
            (process_scale, samples, 2),
        ] {
            values.drain(..(samples * per_sample).min(values.len()));
        }
        let first = self.forgotten + samples;
        self.earlier.drain(..self.earlier.partition_point(|(sample, _)| *sample < first));
        self.canonical.forget(samples);
        self.variance.forget(samples);
        self.forgotten += samples;
        self.monitor.forget_before(self.forgotten);
    }

    /// Appends a sample. Inlined, so that a caller with fixed sizes needs no checks of lengths.
    #[inline(always)]
    pub(crate) fn append(&mut self, sample: &Sample<'_>) {
        let Sample { mean, cov, innovation, innovation_cov, gain, nis, determinant, .. } = *sample;
        let n = mean.len();
        if self.initial_std.is_empty() {
            self.initial_mean.extend_from_slice(mean);
            self.initial_std.extend((0..n).map(|i| cov[i * n + i].sqrt()));
        }
        self.mean.extend_from_slice(mean);
        self.cov.extend_from_slice(cov);
        self.variance.push((0..n).map(|i| cov[i * n + i]));
        if self.frequency.is_some_and(|place| mean[place] < 0.0) {
            let sign = |channel: &Channel| if channel.is_mirrored() { -1.0 } else { 1.0 };
            self.canonical.push(mean.iter().zip(&self.channels).map(|(mean, channel)| mean * sign(channel)));
        } else {
            self.canonical.push(mean.iter().copied());
        }
        self.innovation.extend_from_slice(innovation);
        if sample.earlier > 0 {
            self.earlier.push((self.forgotten + self.nis.len(), sample.earlier));
        }
        self.innovation_cov.extend_from_slice(innovation_cov);
        self.gain.extend_from_slice(gain);
        self.nis.push(nis);
        self.determinant.push(determinant);
        if self.kind.has_own_likelihood() {
            self.log_likelihood.push(sample.log_likelihood);
            self.effective_samples.push(sample.effective_samples);
        }
        self.weights.extend_from_slice(sample.weights);
        if let Some(noise) = sample.noise {
            if self.learns {
                self.learnt.extend(noise.sensors.iter().chain(noise.uncertainty));
            }
            if self.scales {
                self.process_scale.extend(noise.process_scale);
            }
        }
        self.monitor.look(self.forgotten + self.nis.len() - 1, sample);
    }

    pub(crate) fn set_stop(&mut self, stop: Stop) {
        self.stop = Some(stop);
    }
}

impl Piecewise for Estimates {
    fn free_piece(&mut self) -> bool {
        let Self { mean, cov, canonical, variance, innovation, innovation_cov, gain, .. } = self;
        let Self { nis, determinant, log_likelihood, effective_samples, weights, learnt, process_scale, .. } = self;
        // The NIS last: it has one number per sample, also without matrices.
        let matrices = [mean, cov, innovation, innovation_cov, gain];
        let numbers = [determinant, log_likelihood, effective_samples, weights, learnt, process_scale];
        let mut all =
            matrices.into_iter().chain(numbers).chain(canonical.columns()).chain(variance.columns()).chain([nis]);
        let Some(values) = all.find(|values| values.capacity() > 0) else { return false };
        values.clear();
        values.shrink_to(values.capacity().saturating_sub(FREED));
        true
    }
}

#[cfg(test)]
mod tests {
    use crate::{FilterKind, Pass, Run, Scenario};

    #[test]
    fn matrices_that_are_dropped_are_empty_and_later_ones_are_right() {
        let mut scenario = Scenario { duration: 2.0, ..Scenario::default() };
        (scenario.filters[1].kind, scenario.filters[1].ensemble_size) = (FilterKind::PF, 50);
        let mut run = Run::new(&scenario).unwrap();
        run.finish();
        for (place, whole) in run.estimates().iter().enumerate() {
            let mut pass = Pass::new(&scenario, place, run.record()).unwrap();
            let mut history = Pass::history(&scenario, place).unwrap();
            pass.follow(run.record(), 100, &mut history);
            history.drop_matrices();
            pass.follow(run.record(), 201, &mut history);
            for forgotten in [0, 40, 100] {
                history.forget(forgotten - history.forgotten());
                for k in forgotten..201 {
                    let (cov, gain) = (history.cov(k - forgotten), history.gain(k - forgotten));
                    let keeps_gain = k >= 99 || whole.kind() == FilterKind::PF;
                    assert_eq!(cov, if k < 99 { &[][..] } else { whole.cov(k) }, "{forgotten} {k}");
                    assert_eq!(gain, if keeps_gain { whole.gain(k) } else { &[][..] }, "{forgotten} {k}");
                    assert_eq!(history.mean(k - forgotten), whole.mean(k));
                    assert_eq!(history.std(k - forgotten, 2), whole.std(k, 2));
                }
            }
        }
    }
}
