//! The last sample of a filter, kept beyond the step that made it.

use super::{AssumedNoise, Sample, Sink};
use crate::Stop;

/// A sink that keeps the last sample alone, in memory that it uses again, with the belief before its update.
#[derive(Clone, Debug, Default)]
pub struct LastSample {
    mean: Vec<f64>,
    cov: Vec<f64>,
    prior_mean: Vec<f64>,
    prior_cov: Vec<f64>,
    innovation: Vec<f64>,
    innovation_cov: Vec<f64>,
    gain: Vec<f64>,
    earlier: u32,
    /// NIS, det S, own log likelihood, effective sample size.
    numbers: [f64; 4],
    /// Diagonals of Q and R, where the filter learns them, and the variance of each R.
    noise: [Vec<f64>; 3],
    process_scale: [f64; 2],
    weights: Vec<f64>,
    is_adaptive: bool,
    has_widened: bool,
    without_prior: bool,
}

impl LastSample {
    /// Sets whether it wants the belief before the update.
    pub fn want_prior(&mut self, wants: bool) {
        self.without_prior = !wants;
    }

    /// The sample; without numbers before the first one.
    pub fn sample(&self) -> Sample<'_> {
        let Self { mean, cov, prior_mean, prior_cov, innovation, innovation_cov, gain, .. } = self;
        let ([nis, determinant, log_likelihood, effective_samples], [process, sensors, uncertainty]) =
            (self.numbers, &self.noise);
        let process_scale = self.process_scale;
        let noise = self.is_adaptive.then_some(AssumedNoise { process, sensors, uncertainty, process_scale });
        Sample {
            mean,
            cov,
            prior_mean,
            prior_cov,
            innovation,
            innovation_cov,
            gain,
            earlier: self.earlier,
            nis,
            determinant,
            log_likelihood,
            effective_samples,
            noise,
            weights: &self.weights,
            has_widened: self.has_widened,
        }
    }
}

impl Sink for LastSample {
    fn push(&mut self, sample: &Sample<'_>) {
        let Self {
            mean,
            cov,
            prior_mean,
            prior_cov,
            innovation,
            innovation_cov,
            gain,
            noise: [q, r, of_r],
            weights,
            ..
        } = self;
        let noise = sample.noise.map(|noise| [noise.process, noise.sensors, noise.uncertainty]);
        let [process, sensors, uncertainty] = noise.unwrap_or_default();
        for (kept, part) in [
            (mean, sample.mean),
            (cov, sample.cov),
            (prior_mean, sample.prior_mean),
            (prior_cov, sample.prior_cov),
            (innovation, sample.innovation),
            (innovation_cov, sample.innovation_cov),
            (gain, sample.gain),
            (q, process),
            (r, sensors),
            (of_r, uncertainty),
            (weights, sample.weights),
        ] {
            kept.clear();
            kept.extend_from_slice(part);
        }
        self.numbers = [sample.nis, sample.determinant, sample.log_likelihood, sample.effective_samples];
        self.earlier = sample.earlier;
        self.process_scale = sample.noise.map_or([f64::NAN; 2], |noise| noise.process_scale);
        self.is_adaptive = sample.noise.is_some();
        self.has_widened = sample.has_widened;
    }

    fn stop_at(&mut self, _: Stop) {}

    fn wants_prior(&self) -> bool {
        !self.without_prior
    }
}
