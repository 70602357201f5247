//! Beliefs as a sample of states: the ensemble Kalman filter, and the bootstrap particle filter, whose states have weights.

use std::borrow::Cow;

use super::{
    Algorithm, Belief, Correction, FilterError, FilterInfo, Gaussian, Noise, Normal, Observation, Step, System, kalman,
};
use crate::linalg::{Matrix, Vector, lower_root, symmetric};

/// The ensemble Kalman filter: every member moves by a Runge-Kutta step and a draw of Q, and is corrected with the gain
/// of the ensemble's own covariances, as if its sensors had read their values plus a draw of R.
///
/// ```text
/// C = cov(yᵢ, h(yᵢ)),  S = cov(h(yᵢ)) + R,  K = C S⁻¹,  yᵢ ← yᵢ + K (z + rᵢ - h(yᵢ))
/// ```
///
/// Draws are centred, so that they move no mean. Fading stretches the ensemble about its mean.
///
/// Source: Evensen (2003), The ensemble Kalman filter: theoretical formulation and practical implementation; Burgers, van
/// Leeuwen and Evensen (1998), Analysis scheme in the ensemble Kalman filter.
#[derive(Clone, Debug)]
pub struct Ensemble {
    /// Each a column.
    members: Matrix,
    normal: Normal,
    origin: Option<Gaussian>,
}

/// Every member draws numbers for at least this many sensors, so that one more does not change the draws of Q.
const DRAWN_SENSORS: usize = 4;

impl Ensemble {
    /// `size` members drawn from a Gaussian; at least 2.
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] and [`FilterError::NotFinite`] where the Gaussian's covariance has no root.
    pub fn new(belief: Gaussian, size: usize, mut normal: Normal) -> Result<Self, FilterError> {
        let mut members = Matrix::from_fn(belief.size(), size.max(2), |i, _| belief.mean[i]);
        let draws = centred_draws(belief.size(), members.ncols(), &mut normal);
        members.gemm(1.0, &lower_root(&belief.cov)?, &draws, 1.0);
        Ok(Self { members, normal, origin: Some(belief) })
    }
}

impl Belief for Ensemble {
    fn predict(&mut self, system: &mut dyn System, step: Step<'_>, noise: &Noise) -> Result<(), FilterError> {
        let Self { members, normal, origin } = self;
        *origin = None;
        system.advance(members.as_mut_slice(), step);
        if noise.fading != 1.0 {
            stretch(members, &mean(members), noise.fading.sqrt());
        }
        let draws = centred_draws(members.nrows(), members.ncols(), normal);
        members.gemm(1.0, &lower_root(&noise.process)?, &draws, 1.0);
        Ok(())
    }

    fn condition(
        &mut self,
        system: &mut dyn System,
        observation: &Observation,
        out: &mut Correction,
    ) -> Result<(), FilterError> {
        let Self { members, normal, .. } = self;
        let readings = observation.read(system, members.as_slice());
        let (count, others) = (members.ncols() as f64, (members.ncols() - 1) as f64);
        let gain = report(members, &readings, [&|_| 1.0 / count, &|_| 1.0 / others], observation, out)?;
        let draws = centred_draws(observation.readings.len().max(DRAWN_SENSORS), members.ncols(), normal);
        let errors = Matrix::from_fn(observation.len(), members.ncols(), |i, member| {
            observation.values[i] + observation.variances[i].sqrt() * draws[(i, member)] - readings[(i, member)]
        });
        members.gemm(1.0, &gain, &errors, 1.0);
        self.gaussian().check()
    }

    fn renew(&mut self, place: usize, kept: f64, variance: f64) -> Result<(), FilterError> {
        let Self { members, normal, .. } = self;
        let draws = centred_draws(1, members.ncols(), normal);
        let renewed = members.row(place) * kept + draws.row(0) * variance.sqrt();
        members.row_mut(place).copy_from(&renewed);
        Ok(())
    }

    fn gaussian(&self) -> Cow<'_, Gaussian> {
        // Until it moves, the belief is what was given: the moments of a draw differ from it by chance.
        if let Some(origin) = &self.origin {
            return Cow::Borrowed(origin);
        }
        let Self { members, .. } = self;
        let mean = mean(members);
        let cov = covariance([members, members], [&mean; 2], |_| 1.0 / (members.ncols() - 1) as f64);
        Cow::Owned(Gaussian { mean, cov: symmetric(cov) })
    }
}

/// The mean of the columns, taken about the first, so that the mean of equal values is that value to the last bit.
fn mean(sample: &Matrix) -> Vector {
    weighted_sum(sample, |_| 1.0 / sample.ncols() as f64)
}

/// The sum of the columns times their weights, which add up to one, taken about the first.
fn weighted_sum(sample: &Matrix, weight: impl Fn(usize) -> f64) -> Vector {
    let n = sample.nrows();
    let first = &sample.as_slice()[..n];
    let mut sum = Vector::zeros(n);
    for (j, element) in sample.as_slice().chunks_exact(n).enumerate() {
        let (weight, sum) = (weight(j), sum.as_mut_slice());
        sum.iter_mut().zip(element).zip(first).for_each(|((sum, x), first)| *sum += (x - first) * weight);
    }
    sum.iter_mut().zip(first).for_each(|(sum, first)| *sum += first);
    sum
}

/// `Σ wⱼ (aⱼ - ā) (bⱼ - b̄)ᵀ` over the columns of two samples with these means.
fn covariance([a, b]: [&Matrix; 2], [a_mean, b_mean]: [&Vector; 2], weight: impl Fn(usize) -> f64) -> Matrix {
    let (n, m) = (a.nrows(), b.nrows());
    let mut cov = Matrix::zeros(n, m);
    for (j, (a, b)) in a.as_slice().chunks_exact(n).zip(b.as_slice().chunks_exact(m)).enumerate() {
        let weight = weight(j);
        for ((column, b), b_mean) in cov.as_mut_slice().chunks_exact_mut(n).zip(b).zip(b_mean.as_slice()) {
            let by = (b - b_mean) * weight;
            column.iter_mut().zip(a).zip(a_mean.as_slice()).for_each(|((entry, a), mean)| *entry += (a - mean) * by);
        }
    }
    cov
}

fn stretch(sample: &mut Matrix, centre: &Vector, factor: f64) {
    for element in sample.as_mut_slice().chunks_exact_mut(centre.len()) {
        element.iter_mut().zip(centre.as_slice()).for_each(|(x, centre)| *x = centre + (*x - centre) * factor);
    }
}

/// Reports a Gaussian's update by the moments of a sample, with the weights of a mean and of a covariance; returns the gain.
fn report(
    sample: &Matrix,
    readings: &Matrix,
    [of_mean, of_cov]: [&dyn Fn(usize) -> f64; 2],
    observation: &Observation,
    update: &mut Correction,
) -> Result<Matrix, FilterError> {
    let expected = weighted_sum(readings, of_mean);
    let cross = covariance([sample, readings], [&weighted_sum(sample, of_mean), &expected], of_cov);
    let mut innovation_cov = symmetric(covariance([readings, readings], [&expected; 2], of_cov));
    observation.add_noise(&mut innovation_cov);
    let factor = kalman::factor(&innovation_cov)?;
    let gain = factor.divide(&cross);
    update.report(&observation.sensors, &observation.innovation(&expected), &innovation_cov, &factor, &gain);
    Ok(gain)
}

fn centred_draws(n: usize, count: usize, normal: &mut Normal) -> Matrix {
    let mut draws = Matrix::from_fn(n, count, |_, _| normal.sample());
    let centre = mean(&draws);
    for element in draws.as_mut_slice().chunks_exact_mut(n) {
        element.iter_mut().zip(centre.as_slice()).for_each(|(x, centre)| *x -= centre);
    }
    // Centring takes one degree of freedom.
    draws * (count as f64 / (count as f64 - 1.0)).sqrt()
}

const SAMPLED: FilterInfo = FilterInfo {
    key: "enkf",
    name: "EnKF",
    description: "moves an ensemble and corrects each member",
    reference: "Evensen (2003), The ensemble Kalman filter: theoretical formulation and practical implementation",
    is_sampled: true,
    has_own_likelihood: false,
    evaluations: |settings, _| 4 * settings.ensemble_size,
    time: |settings, n| settings.ensemble_size.max(1) as f64 * 75.0 * n as f64,
    has_propagation: false,
    algorithm: Algorithm::Belief(|initial, settings, normal| {
        Ok(Box::new(Ensemble::new(initial, settings.ensemble_size, normal)?))
    }),
};

pub(super) static ENKF: FilterInfo = SAMPLED;

/// The regularised bootstrap particle filter: every particle moves by a Runge-Kutta step and a draw of Q, and is weighted by the
/// likelihood of the measurement. Once the effective sample size `1/Σwᵢ²` is below half the particles, they are resampled
/// systematically and spread by a normal kernel: without it, constant parameters would soon have a single value left.
///
/// Innovation, S and gain are those of a Gaussian with the sample's moments; the log likelihood is the particles' own.
///
/// Source: Gordon, Salmond and Smith (1993), Novel approach to nonlinear/non-Gaussian Bayesian state estimation; Kitagawa
/// (1996), Monte Carlo filter and smoother for non-Gaussian nonlinear state space models (systematic resampling); Musso,
/// Oudjane and Le Gland (2001), Improving regularised particle filters; Liu and West (2001), Combined parameter and state
/// estimation in simulation-based filtering (a kernel that keeps mean and covariance).
#[derive(Clone, Debug)]
pub struct Particles {
    /// Each a column.
    particles: Matrix,
    weights: Vec<f64>,
    normal: Normal,
    origin: Option<Gaussian>,
}

impl Particles {
    /// `size` particles drawn from a Gaussian; at least 2.
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] and [`FilterError::NotFinite`] where the Gaussian's covariance has no root.
    pub fn new(belief: Gaussian, size: usize, mut normal: Normal) -> Result<Self, FilterError> {
        let size = size.max(2);
        let mut particles = Matrix::from_fn(belief.size(), size, |i, _| belief.mean[i]);
        add_draws(&mut particles, &lower_root(&belief.cov)?, &mut normal);
        Ok(Self { particles, weights: vec![1.0 / size as f64; size], normal, origin: Some(belief) })
    }

    fn mean(&self) -> Vector {
        weighted_sum(&self.particles, |j| self.weights[j])
    }

    fn moments(&self) -> Gaussian {
        let Self { particles, weights, .. } = self;
        let mean = self.mean();
        let cov = covariance([particles, particles], [&mean; 2], |j| weights[j]);
        Gaussian { mean, cov: symmetric(cov) }
    }

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

    /// Each weight gives its copies, and a kernel separates these; shrinking the particles first keeps mean and covariance.
    fn resample(&mut self) {
        let Gaussian { mean, cov } = self.moments();
        let Self { particles, weights, normal, .. } = self;
        let (n, count) = particles.shape();
        // One number for all: each particle gets its share of copies to within one, which single draws miss.
        let offset = normal.uniform();
        let mut drawn = Vec::with_capacity(count);
        let (mut at, mut reached) = (0, weights[0]);
        for i in 0..count {
            let target = (i as f64 + offset) / count as f64;
            while reached < target && at + 1 < count {
                at += 1;
                reached += weights[at];
            }
            drawn.push(at);
        }
        *particles = particles.select_columns(&drawn);
        let square = bandwidth_square(n, count);
        // If rounding makes the covariance of a thin sample indefinite, the particles stay where they were drawn.
        if let Ok(root) = lower_root(&(cov * square)) {
            stretch(particles, &mean, (1.0 - square).sqrt());
            add_draws(particles, &root, normal);
        }
        weights.fill(1.0 / count as f64);
    }

    fn weigh(&mut self, readings: &Matrix, observation: &Observation) -> Result<f64, FilterError> {
        let log_likelihood = |reading: &[f64]| {
            let errors = observation.values.iter().zip(reading).map(|(value, reading)| value - reading);
            -0.5 * errors.zip(&observation.variances).map(|(error, variance)| error * error / variance).sum::<f64>()
        };
        let log_likelihoods: Vec<f64> =
            readings.as_slice().chunks_exact(observation.len()).map(log_likelihood).collect();
        // Relative to the best, so that not all underflow.
        let best = log_likelihoods.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        for (weight, log_likelihood) in self.weights.iter_mut().zip(&log_likelihoods) {
            *weight *= libm::exp(log_likelihood - best);
        }
        let total: f64 = self.weights.iter().sum();
        if best == f64::NEG_INFINITY && readings.column_iter().all(|reading| reading.sum().is_finite()) {
            return Err(FilterError::ImpossibleMeasurement);
        }
        if !best.is_finite() {
            return Err(FilterError::NotFinite);
        }
        self.normalise()?;
        let ln_noise: f64 = observation.variances.iter().map(|r| libm::log(std::f64::consts::TAU * r)).sum();
        Ok(best + libm::log(total) - 0.5 * ln_noise)
    }
}

impl Belief for Particles {
    fn predict(&mut self, system: &mut dyn System, step: Step<'_>, noise: &Noise) -> Result<(), FilterError> {
        self.origin = None;
        let Self { particles, weights, .. } = self;
        let mut moved = particles.clone();
        system.advance(moved.as_mut_slice(), step);
        // A diverged particle explains no measurement and loses its weight.
        let mut lost = false;
        let places = particles.as_mut_slice().chunks_exact_mut(system.size());
        for ((next, place), weight) in moved.as_slice().chunks_exact(system.size()).zip(places).zip(weights) {
            if next.iter().map(|x| x * x).sum::<f64>().is_finite() {
                place.copy_from_slice(next);
            } else {
                (*weight, lost) = (0.0, true);
            }
        }
        if lost {
            self.normalise()?;
        }
        if noise.fading != 1.0 {
            let mean = self.mean();
            stretch(&mut self.particles, &mean, noise.fading.sqrt());
        }
        add_draws(&mut self.particles, &lower_root(&noise.process)?, &mut self.normal);
        Ok(())
    }

    fn condition(
        &mut self,
        system: &mut dyn System,
        observation: &Observation,
        out: &mut Correction,
    ) -> Result<(), FilterError> {
        let readings = observation.read(system, self.particles.as_slice());
        if observation.variances.contains(&0.0) {
            // With a variance of zero, no particle has a finite likelihood.
            return Err(FilterError::SingularInnovation);
        }
        let gain = report(&self.particles, &readings, [&|j| self.weights[j]; 2], observation, out)?;
        if !gain.sum().is_finite() {
            // The gain moves no particle, so that nothing later reports the error.
            return Err(FilterError::NotFinite);
        }
        out.log_likelihood = self.weigh(&readings, observation)?;
        out.effective_samples = 1.0 / self.weights.iter().map(|w| w * w).sum::<f64>();
        if out.effective_samples < 0.5 * self.weights.len() as f64 {
            self.resample();
        }
        self.gaussian().check()
    }

    fn renew(&mut self, place: usize, kept: f64, variance: f64) -> Result<(), FilterError> {
        let Self { particles, normal, .. } = self;
        for particle in particles.row_mut(place).iter_mut() {
            *particle = kept * *particle + variance.sqrt() * normal.sample();
        }
        Ok(())
    }

    fn gaussian(&self) -> Cow<'_, Gaussian> {
        self.origin.as_ref().map_or_else(|| Cow::Owned(self.moments()), Cow::Borrowed)
    }
}

/// In variances of the sample. Source: Silverman (1986), *Density Estimation for Statistics and Data Analysis*, equation 4.14.
fn bandwidth_square(n: usize, count: usize) -> f64 {
    let n = n as f64;
    libm::pow(4.0 / ((n + 2.0) * count as f64), 2.0 / (n + 4.0)).min(1.0)
}

fn add_draws(sample: &mut Matrix, root: &Matrix, normal: &mut Normal) {
    let draws = Matrix::from_fn(sample.nrows(), sample.ncols(), |_, _| normal.sample());
    sample.gemm(1.0, root, &draws, 1.0);
}

pub(super) static PF: FilterInfo = FilterInfo {
    key: "pf",
    name: "PF",
    description: "moves weighted particles and resamples them systematically",
    reference: "Gordon, Salmond and Smith (1993), Novel approach to nonlinear/non-Gaussian Bayesian state estimation",
    has_own_likelihood: true,
    algorithm: Algorithm::Belief(|initial, settings, normal| {
        Ok(Box::new(Particles::new(initial, settings.ensemble_size, normal)?))
    }),
    ..SAMPLED
};
