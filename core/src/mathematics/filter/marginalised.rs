//! Beliefs as a weighted sample of parameters, each with a Gaussian over the rest: the Rao-Blackwellised particle filter.

use std::borrow::Cow;

use super::kind::time_of_linearised;
use super::particles::{bandwidth_square, weighted_mean};
use super::{
    Belief, Correction, FilterError, FilterInfo, Gaussian, MethodSettings, Moments, Noise, Normal, Observation, Step,
    kalman,
};
use crate::mathematics::gaussian_likelihood::{ln_determinant, log_likelihood};
use crate::mathematics::linalg::{Ldl, Matrix, Vector, lower_root, symmetric};
use crate::{Model, Propagation};

/// The Rao-Blackwellised particle filter: a particle has values of the plant's parameters θ and a Kalman filter of the
/// motion x and the augmentations, which treats θ as known. With a linear plant that filter is exact, so that only θ is
/// sampled: a hundred particles do better than thousands of a bootstrap filter. Other plants are linearised, as an EKF
/// does.
///
/// ```text
/// p(x, θ | z) ≈ Σ wᵢ δ(θ - θᵢ) N(x; xᵢ, Pᵢ),   wᵢ ← wᵢ N(z; ẑᵢ, Sᵢ)
/// ```
///
/// Once the effective sample size `1/Σwᵢ²` is below half the particles, they are resampled systematically, shrunk
/// towards their mean and spread by a normal kernel, which keeps mean and covariance; xᵢ moves along by its regression
/// on θ. So parameters that do not change keep their variety. Fading stretches the sample about its mean.
///
/// Innovation, S and gain are those of a Gaussian with the sample's moments; the log likelihood is the particles' own.
///
/// Source: Doucet, de Freitas, Murphy and Russell (2000), Rao-Blackwellised particle filtering for dynamic Bayesian networks;
/// Liu and West (2001), Combined parameter and state estimation in simulation-based filtering (the kernel).
pub struct Marginalised {
    particles: Vec<Moments>,
    weights: Vec<f64>,
    size: usize,
    propagation: Propagation,
    normal: Normal,
    /// The belief that the particles will be drawn from when they first move.
    origin: Option<Gaussian>,
    /// The correction of one particle.
    own: Correction,
}

/// The effect of a measurement on one particle. The moments of all particles are made from these.
struct Told {
    mean: Vector,
    innovation: Vector,
    cov: Matrix,
    cross: Matrix,
    log_likelihood: f64,
}

impl Marginalised {
    /// `size` particles drawn from a Gaussian; at least 2.
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] and [`FilterError::NotFinite`] where the Gaussian's covariance has no root.
    pub fn new(belief: Gaussian, size: usize, propagation: Propagation, normal: Normal) -> Result<Self, FilterError> {
        lower_root(&belief.cov)?;
        let (size, own) = (size.max(2), Correction::default());
        let weights = vec![1.0 / size as f64; size];
        Ok(Self { particles: Vec::new(), weights, size, propagation, normal, origin: Some(belief), own })
    }

    /// Draws the particles from the initial belief.
    fn draw(&mut self, model: &Model) -> Result<(), FilterError> {
        let Some(Gaussian { mean, cov }) = self.origin.take() else { return Ok(()) };
        let root = lower_root(&of_parameters(model, &cov))?;
        let rest = of_the_rest(model, &cov);
        for _ in 0..self.size {
            let drawn = &mean + &root * standard(mean.len(), &mut self.normal);
            let belief = Gaussian { mean: drawn, cov: rest.clone() };
            self.particles.push(Moments::linearised(belief, self.propagation, 1));
        }
        Ok(())
    }

    /// The means of all particles, each a column.
    fn means(&self) -> Matrix {
        let n = self.particles.first().map_or(0, |particle| particle.belief().size());
        Matrix::from_fn(n, self.particles.len(), |i, particle| self.particles[particle].belief().mean[i])
    }

    fn moments(&self) -> Gaussian {
        let means = self.means();
        let mean = weighted_mean(&means, &self.weights);
        let mut cov = Matrix::zeros(mean.len(), mean.len());
        for ((particle, place), &weight) in self.particles.iter().zip(means.column_iter()).zip(&self.weights) {
            let deviation = place - &mean;
            cov.ger(weight, &deviation, &deviation, 1.0);
            cov += &particle.belief().cov * weight;
        }
        Gaussian { mean, cov: symmetric(cov) }
    }

    /// Sets the weight of diverged particles to zero: they explain no measurement. Each becomes a copy of the heaviest
    /// other particle, without a weight, until the next resampling.
    fn drop(&mut self, lost: &[usize]) -> Result<(), FilterError> {
        let Self { particles, weights, .. } = self;
        if lost.is_empty() {
            return Ok(());
        }
        lost.iter().for_each(|&place| weights[place] = 0.0);
        normalise(weights)?;
        let heaviest = (0..weights.len()).max_by(|&a, &b| weights[a].total_cmp(&weights[b])).unwrap_or(0);
        for &place in lost {
            particles[place] = particles[heaviest].clone();
        }
        Ok(())
    }

    /// Resamples: copies each particle in proportion to its weight, within one copy, and moves each copy by a draw from
    /// a kernel in θ, so that copies separate. The rest of its mean follows by regression; the residual is added to its
    /// covariance.
    fn resample(&mut self, model: &Model) {
        let means = self.means();
        let Self { particles, weights, normal, .. } = self;
        let count = particles.len();
        let mean = weighted_mean(&means, weights);
        let mut cov = Matrix::zeros(mean.len(), mean.len());
        for (place, &weight) in means.column_iter().zip(weights.iter()) {
            let deviation = place - &mean;
            cov.ger(weight, &deviation, &deviation, 1.0);
        }
        let places: Vec<usize> = parameters(model).filter(|&i| cov[(i, i)] > 0.0).collect();
        let own = Matrix::from_fn(places.len(), places.len(), |i, j| cov[(places[i], places[j])]);
        let cross = Matrix::from_fn(mean.len(), places.len(), |i, j| cov[(i, places[j])]);
        let regression = Ldl::semidefinite(&own).divide(&cross);
        let square = bandwidth_square(places.len(), count);
        let unexplained = unexplained(model, &cov, &regression, &own) * square;
        let root = lower_root(&(own * square));
        let offset = normal.uniform();
        let (mut at, mut reached) = (0, weights[0]);
        let mut drawn = Vec::with_capacity(count);
        for i in 0..count {
            let target = (i as f64 + offset) / count as f64;
            while reached < target && at + 1 < count {
                at += 1;
                reached += weights[at];
            }
            let mut particle = particles[at].clone();
            // If rounding makes the covariance of a thin sample indefinite, the particles stay where they were drawn.
            if let Ok(root) = &root {
                let Gaussian { mean: moved, cov } = particle.belief_mut();
                let deviation = means.column(at) - &mean;
                *moved =
                    &mean + deviation * (1.0 - square).sqrt() + &regression * (root * standard(places.len(), normal));
                *cov += &unexplained;
            }
            drawn.push(particle);
        }
        *particles = drawn;
        weights.fill(1.0 / count as f64);
    }
}

impl Belief for Marginalised {
    fn predict(&mut self, model: &Model, step: Step, noise: &Noise) -> Result<(), FilterError> {
        self.draw(model)?;
        let root = lower_root(&of_parameters(model, &noise.process))?;
        let rest = Noise { process: of_the_rest(model, &noise.process), sensors: Vec::new(), fading: noise.fading };
        let mut lost = Vec::new();
        for (place, particle) in self.particles.iter_mut().enumerate() {
            particle.predict(model, step, &rest)?;
            if !particle.belief().is_finite() {
                lost.push(place);
            }
        }
        self.drop(&lost)?;
        let means = self.means();
        let mean = weighted_mean(&means, &self.weights);
        let stretch = noise.fading.sqrt();
        let is_still = root.iter().all(|entry| *entry == 0.0);
        for (particle, place) in self.particles.iter_mut().zip(means.column_iter()) {
            let moved = &mut particle.belief_mut().mean;
            if noise.fading != 1.0 {
                *moved = &mean + (place - &mean) * stretch;
            }
            if !is_still {
                *moved += &root * standard(mean.len(), &mut self.normal);
            }
        }
        Ok(())
    }

    fn condition(
        &mut self,
        model: &Model,
        observation: &Observation,
        correction: &mut Correction,
    ) -> Result<(), FilterError> {
        self.draw(model)?;
        let Self { particles, own, .. } = self;
        let (n, m) = (model.size(), observation.len());
        let mut told = Vec::with_capacity(particles.len());
        let mut lost = Vec::new();
        let mut reason = FilterError::NotFinite;
        for (place, particle) in particles.iter_mut().enumerate() {
            let mean = particle.belief().mean.clone();
            own.clear(n, observation.all_sensors());
            if let Err(error) = particle.condition(model, observation, own) {
                (reason, _) = (error, lost.push(place));
                continue;
            }
            let last = &own.last;
            let ln_determinant = ln_determinant(own.determinant, last.innovation_cov.as_slice(), m);
            told.push(Told {
                mean,
                innovation: last.innovation.clone(),
                cross: &last.gain * &last.innovation_cov,
                cov: last.innovation_cov.clone(),
                log_likelihood: log_likelihood(own.nis, ln_determinant, m as u32),
            });
        }
        if told.is_empty() {
            return Err(reason);
        }
        self.drop(&lost)?;
        let kept: Vec<usize> = (0..self.weights.len()).filter(|place| !lost.contains(place)).collect();
        let shares: Vec<f64> = kept.iter().map(|&place| self.weights[place]).collect();
        report_moments(&told, &shares, observation, correction)?;

        let best = told.iter().map(|told| told.log_likelihood).fold(f64::NEG_INFINITY, f64::max);
        if !best.is_finite() {
            return Err(if best.is_nan() { FilterError::NotFinite } else { FilterError::ImpossibleMeasurement });
        }
        for (&place, told) in kept.iter().zip(&told) {
            self.weights[place] *= libm::exp(told.log_likelihood - best);
        }
        let total: f64 = self.weights.iter().sum();
        normalise(&mut self.weights)?;
        correction.log_likelihood = best + libm::log(total);
        correction.effective_samples = 1.0 / self.weights.iter().map(|w| w * w).sum::<f64>();
        if correction.effective_samples < 0.5 * self.weights.len() as f64 {
            self.resample(model);
        }
        self.gaussian().check()
    }

    fn renew(&mut self, place: usize, variance: f64) -> Result<(), FilterError> {
        let Self { particles, origin, .. } = self;
        let beliefs = particles.iter_mut().map(Moments::belief_mut).chain(origin);
        beliefs.for_each(|belief| belief.renew(place, variance));
        Ok(())
    }

    fn gaussian(&self) -> Cow<'_, Gaussian> {
        self.origin.as_ref().map_or_else(|| Cow::Owned(self.moments()), Cow::Borrowed)
    }
}

/// Reports innovation, S and gain of a Gaussian with the moments of the particles before the update.
fn report_moments(
    told: &[Told],
    weights: &[f64],
    observation: &Observation,
    correction: &mut Correction,
) -> Result<(), FilterError> {
    let n = told[0].mean.len();
    let m = observation.len();
    let first = &told[0].mean;
    let (mut mean, mut innovation) = (Vector::zeros(n), Vector::zeros(m));
    for (told, &weight) in told.iter().zip(weights) {
        // About the first: a component that is the same in all particles stays exact.
        mean += (&told.mean - first) * weight;
        innovation.axpy(weight, &told.innovation, 1.0);
    }
    mean += first;
    let (mut cov, mut cross) = (Matrix::zeros(m, m), Matrix::zeros(n, m));
    for (told, &weight) in told.iter().zip(weights) {
        let reading = &innovation - &told.innovation;
        cov += &told.cov * weight;
        cov.ger(weight, &reading, &reading, 1.0);
        cross += &told.cross * weight;
        cross.ger(weight, &(&told.mean - &mean), &reading, 1.0);
    }
    let cov = symmetric(cov);
    let factor = kalman::factor(&cov)?;
    let gain = factor.divide(&cross);
    // No particle moves by this gain, so no other check would notice.
    if !gain.sum().is_finite() {
        return Err(FilterError::NotFinite);
    }
    correction.report(observation, &innovation, &cov, &factor, &gain);
    Ok(())
}

/// The places of the plant's parameters, which are sampled.
fn parameters(model: &Model) -> impl Iterator<Item = usize> {
    let channels = model.channels().iter().enumerate();
    channels.filter(|(_, channel)| channel.is_parameter() && !channel.is_augmentation()).map(|(place, _)| place)
}

/// The part of a covariance between parameters; zero elsewhere.
fn of_parameters(model: &Model, cov: &Matrix) -> Matrix {
    let mut own = Matrix::zeros(cov.nrows(), cov.ncols());
    for i in parameters(model) {
        parameters(model).for_each(|j| own[(i, j)] = cov[(i, j)]);
    }
    own
}

/// The part of a covariance that a regression on the parameters does not explain.
fn unexplained(model: &Model, cov: &Matrix, regression: &Matrix, own: &Matrix) -> Matrix {
    let mut rest = of_the_rest(model, &(cov - regression * own * regression.transpose()));
    for i in 0..rest.nrows() {
        if rest[(i, i)] <= 0.0 {
            // Zero up to rounding.
            rest.row_mut(i).fill(0.0);
            rest.column_mut(i).fill(0.0);
        }
    }
    symmetric(rest)
}

/// The part of a covariance between components that are not parameters.
fn of_the_rest(model: &Model, cov: &Matrix) -> Matrix {
    let mut rest = cov.clone();
    for i in parameters(model) {
        rest.row_mut(i).fill(0.0);
        rest.column_mut(i).fill(0.0);
    }
    rest
}

/// Makes the weights' sum one.
fn normalise(weights: &mut [f64]) -> Result<(), FilterError> {
    let total: f64 = weights.iter().sum();
    if !(total > 0.0 && total.is_finite()) {
        return Err(FilterError::NotFinite);
    }
    weights.iter_mut().for_each(|weight| *weight /= total);
    Ok(())
}

/// Standard normal numbers.
fn standard(n: usize, normal: &mut Normal) -> Vector {
    Vector::from_fn(n, |_, _| normal.sample())
}

/// A Jacobian counts as n evaluations, one a column.
fn evaluations(settings: &MethodSettings, n: usize) -> usize {
    settings.ensemble_size * (1 + n)
}

pub(super) static RBPF: FilterInfo = FilterInfo {
    key: "rbpf",
    name: "RBPF",
    description: "has particles for the parameters only, and for each a Kalman filter of the motion",
    reference: "Doucet, de Freitas, Murphy and Russell (2000), Rao-Blackwellised particle filtering for dynamic Bayesian networks",
    is_sampled: true,
    has_own_likelihood: true,
    evaluations,
    time: |settings, n| settings.members() * 4.0 * time_of_linearised(n),
    has_propagation: true,
    begin: |initial, settings, normal| {
        Ok(Box::new(Marginalised::new(initial, settings.ensemble_size, settings.propagation, normal)?))
    },
};
