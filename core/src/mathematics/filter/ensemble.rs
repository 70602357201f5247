//! Beliefs as a sample of states, all of the same weight: EnKF.

use std::borrow::Cow;

use super::{Belief, Correction, FilterError, FilterInfo, Gaussian, Noise, Normal, Observation, Step, Way, kalman};
use crate::Model;
use crate::mathematics::engine::states::States;
use crate::mathematics::linalg::{Matrix, Vector, lower_root, symmetric};

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
    engine: Option<Box<States>>,
    /// The belief that the ensemble was drawn from, until it first moves.
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
        Ok(Self { members, normal, engine: None, origin: Some(belief) })
    }

    /// `P ← λ P + Q`
    fn spread(&mut self, Noise { process, fading, .. }: &Noise) -> Result<(), FilterError> {
        let Self { members, normal, .. } = self;
        if *fading != 1.0 {
            stretch(members, &mean(members), fading.sqrt());
        }
        let draws = centred_draws(members.nrows(), members.ncols(), normal);
        members.gemm(1.0, &lower_root(process)?, &draws, 1.0);
        Ok(())
    }
}

impl Belief for Ensemble {
    fn predict(&mut self, model: &Model, step: Step, noise: &Noise) -> Result<(), FilterError> {
        let Self { members, engine, origin, .. } = self;
        *origin = None;
        States::of(engine, model).advance(members.as_mut_slice(), &step.of_engine());
        self.spread(noise)
    }

    fn condition(
        &mut self,
        model: &Model,
        observation: &Observation,
        correction: &mut Correction,
    ) -> Result<(), FilterError> {
        let Self { members, normal, engine, .. } = self;
        let weight = |_| 1.0 / (members.ncols() - 1) as f64;
        let readings = observation.read_all(States::of(engine, model), members);
        let reading_mean = mean(&readings);
        let cross = covariance([members, &readings], [&mean(members), &reading_mean], weight);
        let mut innovation_cov = symmetric(covariance([&readings, &readings], [&reading_mean; 2], weight));
        observation.add_noise(&mut innovation_cov);

        let factor = kalman::factor(&innovation_cov)?;
        let gain = factor.divide(&cross);
        let innovation = observation.innovation(&reading_mean);
        let draws = centred_draws(observation.readings.len().max(DRAWN_SENSORS), members.ncols(), normal);
        let errors = Matrix::from_fn(observation.len(), members.ncols(), |i, member| {
            observation.values[i] + observation.variances[i].sqrt() * draws[(i, member)] - readings[(i, member)]
        });
        members.gemm(1.0, &gain, &errors, 1.0);
        correction.report(&observation.sensors, &innovation, &innovation_cov, &factor, &gain);
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
pub(super) fn weighted_sum(sample: &Matrix, weight: impl Fn(usize) -> f64) -> Vector {
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
pub(super) fn covariance(
    [a, b]: [&Matrix; 2],
    [a_mean, b_mean]: [&Vector; 2],
    weight: impl Fn(usize) -> f64,
) -> Matrix {
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

fn about(sample: &Matrix, centre: &Vector) -> Matrix {
    let mut deviations = sample.clone();
    for element in deviations.as_mut_slice().chunks_exact_mut(centre.len()) {
        element.iter_mut().zip(centre.as_slice()).for_each(|(x, centre)| *x -= centre);
    }
    deviations
}

pub(super) fn stretch(sample: &mut Matrix, centre: &Vector, factor: f64) {
    for element in sample.as_mut_slice().chunks_exact_mut(centre.len()) {
        element.iter_mut().zip(centre.as_slice()).for_each(|(x, centre)| *x = centre + (*x - centre) * factor);
    }
}

/// Standard normal numbers in `count` columns of `n`, shifted so that the mean of the columns is zero.
fn centred_draws(n: usize, count: usize, normal: &mut Normal) -> Matrix {
    let draws = Matrix::from_fn(n, count, |_, _| normal.sample());
    // Centring takes one degree of freedom.
    about(&draws, &mean(&draws)) * (count as f64 / (count as f64 - 1.0)).sqrt()
}

pub(super) static ENKF: FilterInfo = FilterInfo {
    key: "enkf",
    name: "EnKF",
    description: "moves an ensemble and corrects each member",
    reference: "Evensen (2003), The ensemble Kalman filter: theoretical formulation and practical implementation",
    is_sampled: true,
    has_own_likelihood: false,
    evaluations: |settings, _| 4 * settings.ensemble_size,
    time: |settings, n| settings.members() * 75.0 * n as f64,
    has_propagation: false,
    way: Way::Belief(|initial, settings, normal| Ok(Box::new(Ensemble::new(initial, settings.ensemble_size, normal)?))),
};
