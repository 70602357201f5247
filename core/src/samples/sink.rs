//! Receivers of a filter's results.

use crate::samples::passage::Passages;
use crate::{Estimates, Stop};

pub use crate::samples::sample::{AssumedNoise, Sample};

/// Receives the samples of one filter in turn: a full history ([`Estimates`]), or running sums
/// ([`Scores`](crate::Scores)).
///
/// ```
/// use kalmanscope_core::{Sample, Sink};
/// use kalmanscope_core::{Pass, Run, Scenario, Stop};
///
/// /// The largest NIS so far.
/// struct Largest(f64);
///
/// impl Sink for Largest {
///     fn push(&mut self, sample: &Sample<'_>) {
///         self.0 = self.0.max(sample.nis);
///     }
///
///     fn stop_at(&mut self, _: Stop) {}
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let scenario = Scenario { duration: 5.0, ..Scenario::default() };
/// let mut run = Run::new(&scenario)?;
/// run.finish();
/// let mut largest = Largest(0.0);
/// Pass::new(&scenario, 0, run.record())?.follow(run.record(), 501, &mut largest);
/// assert_eq!(largest.0, run.estimates()[0].nis()[1..].iter().copied().fold(0.0, f64::max));
/// # Ok(())
/// # }
/// ```
pub trait Sink {
    /// Takes in the next sample. The first one is the initial belief.
    fn push(&mut self, sample: &Sample<'_>);

    /// Notes that the filter has stopped; there are no more samples.
    fn stop_at(&mut self, stop: Stop);

    /// Whether samples are to have the belief before the update too, `prior_mean` and `prior_cov`. It is copied for a sink
    /// that asks, and costs nothing else.
    fn wants_prior(&self) -> bool {
        false
    }

    /// The passages of a smoother's sink, to which the filter adds those of each step.
    #[doc(hidden)]
    fn passages(&mut self) -> Option<&mut Passages> {
        None
    }
}

impl Sink for Estimates {
    fn push(&mut self, sample: &Sample<'_>) {
        self.append(sample);
    }

    fn stop_at(&mut self, stop: Stop) {
        self.set_stop(stop);
    }
}

impl Sink for Passages {
    fn push(&mut self, _: &Sample<'_>) {}

    fn stop_at(&mut self, stop: Stop) {
        self.stop = Some(stop);
    }

    fn passages(&mut self) -> Option<&mut Passages> {
        Some(self)
    }
}

/// A sink that keeps the last sample alone, in memory that it uses again, with the belief before its update.
#[derive(Clone, Debug, Default)]
pub struct LastSample {
    /// Its vectors and matrices, the variances that a filter learns among them, in the order of [`parts`].
    parts: [Vec<f64>; 11],
    earlier: u32,
    /// NIS, det S, own log likelihood, effective sample size.
    numbers: [f64; 4],
    process_scale: [f64; 2],
    is_adaptive: bool,
    has_widened: bool,
    without_prior: bool,
}

fn parts<'a>(sample: &Sample<'a>) -> [&'a [f64]; 11] {
    let Sample { mean, cov, prior_mean, prior_cov, innovation, innovation_cov, gain, weights, .. } = *sample;
    let noise = sample.noise.map(|noise| [noise.process, noise.sensors, noise.uncertainty]);
    let [process, sensors, uncertainty] = noise.unwrap_or_default();
    [mean, cov, prior_mean, prior_cov, innovation, innovation_cov, gain, weights, process, sensors, uncertainty]
}

impl LastSample {
    /// Sets whether it wants the belief before the update.
    pub fn want_prior(&mut self, wants: bool) {
        self.without_prior = !wants;
    }

    /// The sample; without numbers before the first one.
    pub fn sample(&self) -> Sample<'_> {
        let [nis, determinant, log_likelihood, effective_samples] = self.numbers;
        let [mean, cov, prior_mean, prior_cov, innovation, innovation_cov, gain, weights, noise @ ..] = &self.parts;
        let [process, sensors, uncertainty] = noise;
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
            weights,
            has_widened: self.has_widened,
        }
    }
}

impl Sink for LastSample {
    fn push(&mut self, sample: &Sample<'_>) {
        for (kept, part) in self.parts.iter_mut().zip(parts(sample)) {
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
