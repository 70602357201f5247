//! Samples of a filter's results, and their receivers.

use kalmanscope_filters::Stop;
use kalmanscope_filters::gaussian_likelihood;

use crate::run::passage::Passages;

/// One sample of a filter with n channels and m sensors: its belief after the update, in the channels' units, and its results.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sample<'a> {
    /// Mean, n numbers.
    pub mean: &'a [f64],
    /// Covariance, n × n, symmetric to the last bit.
    pub cov: &'a [f64],
    /// Mean before the update, n numbers; empty unless the sink wants it ([`Sink::wants_prior`](crate::Sink::wants_prior)).
    pub prior_mean: &'a [f64],
    /// Covariance before the update, n × n; empty unless the sink wants it.
    pub prior_cov: &'a [f64],
    /// The innovation e of each sensor in its unit, m numbers; NaN where a sensor measured nothing.
    pub innovation: &'a [f64],
    /// S, the covariance of e, m × m.
    pub innovation_cov: &'a [f64],
    /// K: for each sensor, the change of each channel by a unit of innovation; m × n.
    pub gain: &'a [f64],
    /// The readings before those of e, S and K within the same sample, by the same sensors; NIS and det S count all.
    pub earlier: u32,
    /// Normalised innovation squared.
    pub nis: f64,
    /// det S over the sensors with a measurement; zero or infinite where it underflows or overflows.
    pub determinant: f64,
    /// ln det S of all readings, where det S is zero or infinite and S is of the last ones only; else NaN.
    pub ln_determinant: f64,
    /// Of a particle filter, the logarithm of the mean likelihood of its particles; else NaN, as it follows from NIS and det S.
    pub log_likelihood: f64,
    /// Effective sample size of a particle filter before it resampled; NaN for any other.
    pub effective_samples: f64,
    /// For an adaptive filter, the present variances of process and sensor noise.
    pub noise: Option<AssumedNoise<'a>>,
    /// The weight of each sensor's reading, from 0 to about 1, m numbers; NaN for none, empty for a filter that weighs none.
    pub weights: &'a [f64],
    /// Whether the filter widened P in the step to this sample; of a bank, whether its parameters walk from here on.
    pub has_widened: bool,
}

impl<'a> Sample<'a> {
    /// A belief without a measurement, and without that before it.
    pub fn unmeasured(mean: &'a [f64], cov: &'a [f64]) -> Self {
        let nan = f64::NAN;
        let sample = Self { mean, cov, nis: nan, determinant: nan, ln_determinant: nan, ..Self::default() };
        Self { log_likelihood: nan, effective_samples: nan, ..sample }
    }

    /// The number of readings in its update.
    pub fn readings(&self) -> u32 {
        self.earlier + readings(self.innovation)
    }

    /// The log likelihood of the measurements, `-(NIS + ln det S + m ln 2π) / 2`, or of a particle filter the logarithm of the mean
    /// likelihood of its particles; NaN where there was none.
    pub fn ln_likelihood(&self) -> f64 {
        let own = self.log_likelihood;
        match self.readings() {
            0 => f64::NAN,
            _ if !own.is_nan() => own,
            measured => gaussian_likelihood::log_likelihood(self.nis, self.ln_determinant(), measured),
        }
    }

    pub(crate) fn ln_determinant(&self) -> f64 {
        let Self { innovation, innovation_cov, determinant, ln_determinant, .. } = *self;
        if !ln_determinant.is_nan() {
            return ln_determinant;
        }
        gaussian_likelihood::ln_determinant(determinant, innovation_cov, innovation.len())
    }
}

pub(crate) fn readings(innovation: &[f64]) -> u32 {
    innovation.iter().map(|e| u32::from(!e.is_nan())).sum()
}

/// The variances of an adaptive filter.
#[derive(Clone, Copy, Debug, Default)]
pub struct AssumedNoise<'a> {
    /// Diagonal of Q, n numbers, in the state's units squared.
    pub process: &'a [f64],
    /// Diagonal of R, m numbers, in the sensors' units squared.
    pub sensors: &'a [f64],
    /// The variance of each number of [`Self::sensors`]; zero where R is not learnt.
    pub uncertainty: &'a [f64],
    /// Mean and std of ln s, s the factor on the settings' √Q; NaN for a filter with one scale.
    pub process_scale: [f64; 2],
}

/// Receives the samples of one filter in turn, as [`Estimates`](crate::Estimates) and [`Scores`](crate::Scores) do.
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

    /// Whether samples are to have the belief before the update too, which is copied then.
    fn wants_prior(&self) -> bool {
        false
    }

    /// The passages of a smoother's sink, to which the filter adds those of each step.
    #[doc(hidden)]
    fn passages(&mut self) -> Option<&mut Passages> {
        None
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

/// The vectors and matrices of a sample: what is not there is empty.
pub(crate) fn parts<'a>(sample: &Sample<'a>) -> [&'a [f64]; 11] {
    let Sample { mean, cov, prior_mean, prior_cov, innovation, innovation_cov, gain, weights, .. } = *sample;
    let AssumedNoise { process, sensors, uncertainty, .. } = sample.noise.unwrap_or_default();
    [mean, cov, prior_mean, prior_cov, innovation, innovation_cov, gain, weights, process, sensors, uncertainty]
}

pub(crate) const SCALARS: usize = 9;

pub(crate) fn scalars(sample: &Sample<'_>) -> [f64; SCALARS] {
    let Sample { nis, determinant, ln_determinant, log_likelihood, effective_samples, .. } = *sample;
    let (earlier, widened) = (f64::from(sample.earlier), f64::from(u8::from(sample.has_widened)));
    let [mean, std] = sample.noise.unwrap_or_default().process_scale;
    [nis, determinant, ln_determinant, log_likelihood, effective_samples, earlier, widened, mean, std]
}

pub(crate) fn sample_of<'a>(parts: [&'a [f64]; 11], scalars: [f64; SCALARS], has_noise: bool) -> Sample<'a> {
    let [mean, cov, prior_mean, prior_cov, innovation, innovation_cov, gain, weights, noise @ ..] = parts;
    let [nis, determinant, ln_determinant, log_likelihood, effective_samples, earlier, widened, process_scale @ ..] =
        scalars;
    let [process, sensors, uncertainty] = noise;
    let noise = has_noise.then_some(AssumedNoise { process, sensors, uncertainty, process_scale });
    let (earlier, has_widened) = (earlier as u32, widened != 0.0);
    let sample =
        Sample { mean, cov, prior_mean, prior_cov, innovation, innovation_cov, gain, weights, ..Sample::default() };
    let sample = Sample { nis, determinant, ln_determinant, log_likelihood, effective_samples, ..sample };
    Sample { earlier, has_widened, noise, ..sample }
}

/// A sink that keeps the last sample alone, in memory that it uses again, with the belief before its update.
#[derive(Clone, Debug, Default)]
pub struct LastSample {
    parts: [Vec<f64>; 11],
    scalars: [f64; SCALARS],
    has_noise: bool,
    without_prior: bool,
}

impl LastSample {
    /// Sets whether it wants the belief before the update.
    pub fn want_prior(&mut self, wants: bool) {
        self.without_prior = !wants;
    }

    /// The sample; without numbers before the first one.
    pub fn sample(&self) -> Sample<'_> {
        sample_of(self.parts.each_ref().map(Vec::as_slice), self.scalars, self.has_noise)
    }
}

impl Sink for LastSample {
    fn push(&mut self, sample: &Sample<'_>) {
        for (kept, part) in self.parts.iter_mut().zip(parts(sample)) {
            kept.clear();
            kept.extend_from_slice(part);
        }
        (self.scalars, self.has_noise) = (scalars(sample), sample.noise.is_some());
    }

    fn stop_at(&mut self, _: Stop) {}

    fn wants_prior(&self) -> bool {
        !self.without_prior
    }
}
