//! First-order linearisation at the mean: KF, EKF and iterated EKF.

use std::borrow::Cow;

use super::kalman::{self, Expected};
use super::propagation::{Propagation, Transition};
use super::{Belief, Correction, FilterError, FilterInfo, Gaussian, Noise, Observation, Step};
use crate::linalg::{Matrix, Vector, copy_vector, multiply_rows, multiply_symmetric};
use crate::{FilterSettings, Model};

/// A Gaussian that moves and is measured as if plant and sensors were linear around its mean.
///
/// With `iterations` of more than one the update is a Gauss-Newton descent to the most probable state, each step
/// linearising the sensors anew where the last has led:
///
/// ```text
/// yᵢ₊₁ = y⁻ + Kᵢ (z - h(yᵢ) - Hᵢ (y⁻ - yᵢ)),  y₀ = y⁻
/// ```
///
/// It stops after `iterations`, or as soon as no component moves by more than 1e-6 of its standard deviation. The correction
/// reports innovation, S, NIS and likelihood of the first iteration, at y⁻; gain and covariance are those of the last.
///
/// Source: Huang and Yuen (2023), *Bayesian Real-Time System Identification*; Gelb, ed. (1974), *Applied Optimal
/// Estimation*, section 6.1; Bell and Cathey (1993), The iterated Kalman filter update as a Gauss-Newton method.
#[derive(Clone, Debug)]
pub struct Linearised {
    belief: Gaussian,
    propagation: Propagation,
    iterations: usize,
    transition: Transition,
    /// The first rows of Φ P.
    half: Matrix,
    expected: Expected,
    work: kalman::Work,
    /// The belief before the update, and an iteration of it.
    prior: Gaussian,
    iteration: Correction,
}

impl Linearised {
    /// A belief that moves by `propagation` and linearises the sensors up to `iterations` times an update.
    pub fn new(belief: Gaussian, propagation: Propagation, iterations: usize) -> Self {
        Self {
            prior: belief.clone(),
            belief,
            propagation,
            iterations,
            transition: Transition::default(),
            half: Matrix::zeros(0, 0),
            expected: Expected::default(),
            work: kalman::Work::default(),
            iteration: Correction::default(),
        }
    }

    /// The belief.
    pub(super) fn belief(&self) -> &Gaussian {
        &self.belief
    }

    /// The belief, to be changed.
    pub(super) fn belief_mut(&mut self) -> &mut Gaussian {
        &mut self.belief
    }

    /// Puts the belief elsewhere, as uncertain as it is.
    pub(crate) fn move_to(&mut self, mean: Vector) {
        self.belief.mean = mean;
    }

    /// Goes on from the first step of the descent.
    fn descend(
        &mut self,
        model: &Model,
        observation: &Observation,
        correction: &mut Correction,
    ) -> Result<(), FilterError> {
        let Self { belief, iterations, expected, work, prior, iteration, .. } = self;
        let n = model.size();
        for _ in 1..*iterations {
            expected.linearise(prior, model, &belief.mean, observation, work);
            // h(y) + H (y⁻ - y)
            let jacobian = expected.jacobian.iter().flat_map(|jacobian| jacobian.column_iter());
            for ((column, prior), at) in jacobian.zip(prior.mean.iter()).zip(belief.mean.iter()) {
                expected.mean.axpy(prior - at, &column, 1.0);
            }
            work.rates.clear();
            work.rates.extend_from_slice(belief.mean.as_slice());
            belief.copy_from(prior);
            iteration.clear(n, observation.all_sensors());
            kalman::condition(belief, expected, observation, iteration)?;
            correction.gain.copy_from(&iteration.gain);
            let small = |i: usize| {
                let moved = belief.mean[i] - work.rates[i];
                moved * moved <= CONVERGED * belief.cov[(i, i)]
            };
            if (0..n).all(small) {
                break;
            }
        }
        std::mem::swap(&mut correction.last, &mut iteration.last);
        Ok(())
    }
}

impl Belief for Linearised {
    /// `y⁻` and `P⁻ = λ Φ P Φᵀ + Q`
    fn predict(&mut self, model: &Model, step: Step, noise: &Noise) -> Result<(), FilterError> {
        let Self { belief, propagation, transition, half, .. } = self;
        propagation.step_into(model, &belief.mean, step, transition);
        copy_vector(&mut belief.mean, &transition.mean);
        congruence(model.motion(), &transition.matrix, &mut belief.cov, half);
        noise.spread(&mut belief.cov);
        Ok(())
    }

    fn condition(
        &mut self,
        model: &Model,
        observation: &Observation,
        correction: &mut Correction,
    ) -> Result<(), FilterError> {
        let Self { belief, iterations, expected, work, prior, .. } = self;
        let goes_on = *iterations > 1 && !observation.is_linear();
        if goes_on {
            prior.copy_from(belief);
        }
        expected.linearise(belief, model, &belief.mean, observation, work);
        kalman::condition(belief, expected, observation, correction)?;
        if goes_on { self.descend(model, observation, correction) } else { Ok(()) }
    }

    fn renew(&mut self, place: usize, variance: f64) -> Result<(), FilterError> {
        self.belief.renew(place, variance);
        Ok(())
    }

    fn gaussian(&self) -> Cow<'_, Gaussian> {
        Cow::Borrowed(&self.belief)
    }

    /// Φ
    fn transition(&self, model: &Model, step: Step) -> Result<Matrix, FilterError> {
        Ok(self.propagation.step(model, &self.belief.mean, step).1)
    }
}

/// Makes of P the lower triangle of `Φ P Φᵀ`, where the first `motion` rows of Φ are full and the rest is diagonal; `half` is
/// memory to work in.
///
/// ```text
/// Φ = [T; 0 D],  Φ P Φᵀ = [T P Tᵀ, ·; D (T P)ᵀ, D P D]
/// ```
fn congruence(motion: usize, transition: &Matrix, cov: &mut Matrix, half: &mut Matrix) {
    let n = cov.nrows();
    multiply_rows(half, motion, transition, cov);
    multiply_symmetric(cov, 1.0, half, transition);
    for j in 0..motion {
        for i in motion..n {
            cov[(i, j)] = transition[(i, i)] * half[(j, i)];
        }
    }
    for j in motion..n {
        for i in j..n {
            cov[(i, j)] *= transition[(i, i)] * transition[(j, j)];
        }
    }
}

/// The descent has converged when a step is this small, squared, against the variance.
const CONVERGED: f64 = 1e-12;

/// A Jacobian counts as n evaluations, one a column, as it would take by differences.
fn evaluations(settings: &FilterSettings, n: usize) -> usize {
    match settings.propagation {
        Propagation::LocalLinearisation | Propagation::Euler => 1 + n,
        Propagation::RungeKutta => 4 * (1 + n),
    }
}

pub(super) static KF: FilterInfo = FilterInfo {
    key: "kf",
    name: "KF",
    description: "takes the parameters for known; optimal on a linear plant",
    reference: "Kalman (1960), A new approach to linear filtering and prediction problems",
    is_sampled: false,
    has_own_likelihood: false,
    evaluations,
    begin: |initial, settings, _| Ok(Box::new(Linearised::new(initial, settings.propagation, 1))),
};

pub(super) static EKF: FilterInfo = FilterInfo {
    key: "ekf",
    name: "EKF",
    description: "linearises plant and sensors at the mean",
    reference: "Huang and Yuen (2023), Bayesian Real-Time System Identification",
    is_sampled: false,
    has_own_likelihood: false,
    evaluations,
    begin: |initial, settings, _| Ok(Box::new(Linearised::new(initial, settings.propagation, 1))),
};

pub(super) static IEKF: FilterInfo = FilterInfo {
    key: "iekf",
    name: "IEKF",
    description: "linearises the sensors again where the update leads, by Gauss-Newton",
    reference: "Bell and Cathey (1993), The iterated Kalman filter update as a Gauss-Newton method",
    is_sampled: false,
    has_own_likelihood: false,
    evaluations,
    begin: |initial, settings, _| Ok(Box::new(Linearised::new(initial, settings.propagation, settings.iterations))),
};
