//! Beliefs as a weighted sample of states: the bootstrap particle filter.

use std::borrow::Cow;

use super::kalman::{check, factor, report};
use super::{Belief, Correction, FilterError, Noise, Observation};
use crate::kernel::gaussian::{Gaussian, Matrix, Vector, lower_root};
use crate::kernel::model::Model;
use crate::random::Normal;

/// The regularised bootstrap particle filter: every particle moves by a Runge-Kutta step and a draw of Q, and is
/// weighted by the likelihood of the measurement. Once the effective sample size `1/Σwᵢ²` is below half the particles,
/// they are resampled systematically and spread by a normal kernel, without the kernel, constant parameters would soon
/// have a single value left. Fading stretches the sample about its mean.
///
/// Innovation, S and gain are those of a Gaussian with the sample's moments, for diagnostics; the log likelihood is the
/// particles' own.
///
/// Source: Gordon, Salmond and Smith (1993), Novel approach to nonlinear/non-Gaussian Bayesian state estimation; Kitagawa
/// (1996), Monte Carlo filter and smoother for non-Gaussian nonlinear state space models (systematic resampling); Musso,
/// Oudjane and Le Gland (2001), Improving regularised particle filters; Liu and West (2001), Combined parameter and state
/// estimation in simulation-based filtering (a kernel that keeps mean and covariance).
#[derive(Clone, Debug)]
pub struct Particles<const N: usize> {
    particles: Vec<Vector<N>>,
    weights: Vec<f64>,
    normal: Normal,
    /// The belief that the particles were drawn from, until they first move.
    origin: Option<Gaussian<N>>,
}

impl<const N: usize> Particles<N> {
    /// `size` particles drawn from a Gaussian; at least 2.
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] where the Gaussian's covariance has no root.
    pub(crate) fn new(belief: Gaussian<N>, size: usize, mut normal: Normal) -> Result<Self, FilterError> {
        let size = size.max(2);
        let mut particles = vec![belief.mean; size];
        add_draws(&mut particles, &belief.cov, &mut normal)?;
        Ok(Self { particles, weights: vec![1.0 / size as f64; size], normal, origin: Some(belief) })
    }

    fn mean(&self) -> Vector<N> {
        weighted_mean(&self.particles, &self.weights)
    }

    fn moments(&self) -> Gaussian<N> {
        let mean = self.mean();
        let mut cov = Matrix::<N, N>::zeros();
        for (particle, weight) in self.particles.iter().zip(&self.weights) {
            let deviation = particle - mean;
            cov += deviation * deviation.transpose() * *weight;
        }
        Gaussian { mean, cov }
    }

    /// Makes the weights' sum one.
    fn normalise(&mut self) -> Result<(), FilterError> {
        let total: f64 = self.weights.iter().sum();
        if !(total > 0.0 && total.is_finite()) {
            return Err(FilterError::NotFinite);
        }
        for weight in &mut self.weights {
            *weight /= total;
        }
        Ok(())
    }

    /// Resamples: copies each particle in proportion to its weight, within one copy, and moves each copy by a draw from
    /// a kernel, so that copies separate. Shrinking the particles towards their mean first keeps mean and covariance.
    fn resample(&mut self) {
        let Gaussian { mean, cov } = self.moments();
        let Self { particles, weights, normal, .. } = self;
        let count = particles.len();
        let offset = normal.uniform();
        let mut drawn = Vec::with_capacity(count);
        let (mut at, mut reached) = (0, weights[0]);
        for i in 0..count {
            let target = (i as f64 + offset) / count as f64;
            while reached < target && at + 1 < count {
                at += 1;
                reached += weights[at];
            }
            drawn.push(particles[at]);
        }
        let square = bandwidth_square::<N>(count);
        let kept = (1.0 - square).sqrt();
        // If rounding makes the covariance of a thin sample indefinite, the particles stay where they were drawn.
        if let Ok(root) = lower_root(&(cov * square)) {
            for particle in &mut drawn {
                *particle = mean + (*particle - mean) * kept + root * standard(normal);
            }
        }
        *particles = drawn;
        weights.fill(1.0 / count as f64);
    }

    /// `P ← λ P + Q`
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] and [`FilterError::NotFinite`] where Q has no root.
    fn spread(&mut self, Noise { process, fading, .. }: &Noise<N>) -> Result<(), FilterError> {
        if *fading != 1.0 {
            let mean = self.mean();
            let stretch = fading.sqrt();
            for particle in &mut self.particles {
                *particle = mean + (*particle - mean) * stretch;
            }
        }
        add_draws(&mut self.particles, process, &mut self.normal)
    }
}

impl<P: Model<N>, const N: usize> Belief<P, N> for Particles<N> {
    const PADDED: bool = true;

    fn predict(&mut self, model: &P, force: f64, dt: f64, noise: &Noise<N>) -> Result<(), FilterError> {
        self.origin = None;
        // A diverged particle explains no measurement and loses its weight.
        let mut lost = false;
        for (particle, weight) in self.particles.iter_mut().zip(&mut self.weights) {
            let next = model.runge_kutta_step(particle, force, dt);
            if next.norm_squared().is_finite() {
                *particle = next;
            } else {
                (*weight, lost) = (0.0, true);
            }
        }
        if lost {
            self.normalise()?;
        }
        self.spread(noise)
    }

    fn condition<const M: usize>(
        &mut self,
        model: &P,
        observation: &Observation<M>,
        correction: &mut Correction<N>,
    ) -> Result<(), FilterError> {
        let readings: Vec<Vector<M>> = self.particles.iter().map(|p| observation.read(model, p)).collect();
        let (state_mean, reading_mean) = (self.mean(), weighted_mean(&readings, &self.weights));
        let mut innovation_cov = Matrix::<M, M>::zeros();
        let mut cross = Matrix::<N, M>::zeros();
        for ((particle, reading), weight) in self.particles.iter().zip(&readings).zip(&self.weights) {
            let deviation = reading - reading_mean;
            innovation_cov += deviation * deviation.transpose() * *weight;
            cross += (particle - state_mean) * deviation.transpose() * *weight;
        }
        observation.add_noise(&mut innovation_cov);
        if observation.active.iter().any(|sensor| sensor.variance == 0.0) {
            // With a variance of zero, no particle has a finite likelihood.
            return Err(FilterError::SingularInnovation);
        }
        let factor = factor(&innovation_cov, M)?;
        let gain = factor.divide(&cross);
        if !gain.sum().is_finite() {
            // The gain moves no particle here, so that nothing after this would report the error.
            return Err(FilterError::NotFinite);
        }
        let innovation = observation.values - reading_mean;
        report(observation.measured(), &innovation, &innovation_cov, &factor, &gain, correction);

        correction.log_likelihood = self.weigh(&readings, observation)?;
        let effective = 1.0 / self.weights.iter().map(|w| w * w).sum::<f64>();
        correction.effective_samples = effective;
        if effective < 0.5 * self.particles.len() as f64 {
            self.resample();
        }
        check(&Belief::<P, N>::gaussian(self))
    }

    fn gaussian(&self) -> Cow<'_, Gaussian<N>> {
        if let Some(origin) = &self.origin {
            return Cow::Borrowed(origin);
        }
        Cow::Owned(self.moments())
    }
}

impl<const N: usize> Particles<N> {
    /// Multiplies the weights by the particles' likelihoods and returns the logarithm of the mean of these.
    fn weigh<const M: usize>(
        &mut self,
        readings: &[Vector<M>],
        observation: &Observation<M>,
    ) -> Result<f64, FilterError> {
        let log_likelihoods: Vec<f64> = readings
            .iter()
            .map(|reading| {
                let square = |row: usize| {
                    let error = observation.values[row] - reading[row];
                    error * error / observation.active[row].variance
                };
                -0.5 * (0..M).map(square).sum::<f64>()
            })
            .collect();
        // Relative to the best, so that not all underflow.
        let best = log_likelihoods.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        for (weight, log_likelihood) in self.weights.iter_mut().zip(&log_likelihoods) {
            *weight *= libm::exp(log_likelihood - best);
        }
        let total: f64 = self.weights.iter().sum();
        if best == f64::NEG_INFINITY && readings.iter().all(|reading| reading.sum().is_finite()) {
            return Err(FilterError::ImpossibleMeasurement);
        }
        if !best.is_finite() {
            return Err(FilterError::NotFinite);
        }
        self.normalise()?;
        let ln_noise: f64 = observation.measured().iter().map(|a| libm::log(std::f64::consts::TAU * a.variance)).sum();
        Ok(best + libm::log(total) - 0.5 * ln_noise)
    }
}

/// The square of the bandwidth of a normal kernel around each of `count` particles, in the sample's standard deviations.
///
/// Source: Silverman (1986), *Density Estimation for Statistics and Data Analysis*, equation 4.14.
fn bandwidth_square<const N: usize>(count: usize) -> f64 {
    let n = N as f64;
    libm::pow(4.0 / ((n + 2.0) * count as f64), 2.0 / (n + 4.0)).min(1.0)
}

/// The weighted mean, taken about the first particle, so that the mean of equal values is that value to the last bit.
fn weighted_mean<const N: usize>(sample: &[Vector<N>], weights: &[f64]) -> Vector<N> {
    let sum: Vector<N> = sample.iter().zip(weights).map(|(x, weight)| (x - sample[0]) * *weight).sum();
    sample[0] + sum
}

/// Adds an independent draw from a normal distribution to every element.
fn add_draws<const N: usize>(
    sample: &mut [Vector<N>],
    cov: &Matrix<N, N>,
    normal: &mut Normal,
) -> Result<(), FilterError> {
    let root = lower_root(cov)?;
    for element in sample {
        *element += root * standard(normal);
    }
    Ok(())
}

/// Independent standard normal numbers.
fn standard<const N: usize>(normal: &mut Normal) -> Vector<N> {
    Vector::from_fn(|_, _| normal.sample())
}
