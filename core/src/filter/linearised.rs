//! First-order linearisation at the mean: KF, EKF and iterated EKF.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use super::kalman::{self, Expected};
use super::{Belief, Correction, FilterError, FilterInfo, Gaussian, Noise, Observation, Step};
use crate::integrate::{Integrals, exponential_integrals};
use crate::linalg::{Matrix, Vector};
use crate::{FilterSettings, Model};

/// How the mean of a linearising filter moves, and with which transition matrix its covariance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Propagation {
    /// `y⁻ = y + dt φ₁(A dt) g(y, f)` and `Φ = exp(A dt)`: exact where the parameters are known and the plant is linear.
    #[default]
    LocalLinearisation,
    /// One classical Runge-Kutta step, and its derivative.
    RungeKutta,
    /// `y⁻ = y + dt g(y, f)` and `Φ = I + A dt`: the textbooks' first example, and unstable for a long dt.
    Euler,
}

impl Propagation {
    /// Every way.
    pub const ALL: [Self; 3] = [Self::LocalLinearisation, Self::RungeKutta, Self::Euler];

    /// The state after a step and its transition matrix Φ, n × n. The rows of Φ below those that move are diagonal.
    pub fn step(self, model: &Model, state: &Vector, step: Step) -> (Vector, Matrix) {
        match self {
            Self::LocalLinearisation => local_linearisation(model, state, step),
            Self::RungeKutta => runge_kutta(model, state, step),
            Self::Euler => {
                let (force, dt) = (step.force(0.0), step.dt);
                let transition = model.jacobian(state.as_slice(), force) * dt;
                let mean = state + model.rate(state.as_slice(), force) * dt;
                (mean, Matrix::identity(state.len(), state.len()) + transition)
            }
        }
    }
}

/// One step of local linearisation. A force that is not held has a slope ḟ.
///
/// ```text
/// y⁻ = y + Γ₁ g(y, f) + Γ₂ b ḟ,  Φ = exp(A dt),  Γ₁ = dt φ₁(A dt),  Γ₂ = dt² φ₂(A dt),  b = ∂g/∂f
/// ```
///
/// The column of an input gain g in A is `∂g/∂F f`, and changes with the force: its column of Φ is `Γ₁ ∂g/∂F f + Γ₂ ∂g/∂F ḟ`.
/// Only what moves needs an exponential, together with parameters that decay:
///
/// ```text
/// A = [F, C; 0, 0],  exp(A dt) = [exp(F dt), Γ₁ C; 0, I],  Γ₁ and Γ₂ of F
/// ```
///
/// Source: Huang and Yuen (2023), *Bayesian Real-Time System Identification*, with `A⁻¹(exp(A dt) - I)` read as the entire
/// function `dt φ₁(A dt)`, which a singular A does not trouble; Van Loan (1978), Computing integrals involving the matrix
/// exponential.
fn local_linearisation(model: &Model, state: &Vector, step: Step) -> (Vector, Matrix) {
    let n = model.size();
    let moving = if model.eta() == 0.0 { model.motion() } else { n };
    let a = model.jacobian(state.as_slice(), step.force(0.0));
    let rate = model.rate(state.as_slice(), step.force(0.0));
    let Integrals { transition, constant, slope } =
        exponential_integrals(&a.view((0, 0), (moving, moving)).into_owned(), step.dt);

    let mut mean = state.clone();
    mean.rows_mut(0, moving).gemv(1.0, &constant, &rate.rows(0, moving), 1.0);
    let mut whole = Matrix::identity(n, n);
    whole.view_mut((0, 0), (moving, moving)).copy_from(&transition);
    whole.view_mut((0, moving), (moving, n - moving)).gemm(
        1.0,
        &constant,
        &a.view((0, moving), (moving, n - moving)),
        0.0,
    );
    if step.slope() != 0.0 {
        let by_force = &slope * model.by_force(state.as_slice()).rows(0, moving) * step.slope();
        mean.rows_mut(0, moving).axpy(model.gain(state.as_slice()), &by_force, 1.0);
        if let Some(gain) = model.gain_place() {
            whole.view_mut((0, gain), (moving, 1)).column_mut(0).axpy(1.0, &by_force, 1.0);
        }
    }
    (mean, whole)
}

/// One Runge-Kutta step, and its derivative by the state that it starts from: the chain rule, stage by stage.
fn runge_kutta(model: &Model, state: &Vector, step: Step) -> (Vector, Matrix) {
    let n = model.size();
    let identity = Matrix::identity(n, n);
    let (mut rates, mut derivatives) = (Vector::zeros(n), Matrix::zeros(n, n));
    let (mut rate, mut derivative) = (Vector::zeros(n), Matrix::zeros(n, n));
    for (share, weight) in [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
        let stage = state + &rate * (share * step.dt);
        derivative = model.jacobian(stage.as_slice(), step.force(share)) * (&identity + derivative * (share * step.dt));
        rate = model.rate(stage.as_slice(), step.force(share));
        derivatives += &derivative * weight;
        rates += &rate * weight;
    }
    (state + rates * (step.dt / 6.0), identity + derivatives * (step.dt / 6.0))
}

/// A Gaussian that moves and is measured as if plant and sensors were linear around its mean.
///
/// With `iterations` of more than one the update is a Gauss-Newton descent to the most probable state, each step
/// linearising the sensors anew where the last has led:
///
/// ```text
/// yᵢ₊₁ = y⁻ + Kᵢ (z - h(yᵢ) - Hᵢ (y⁻ - yᵢ)),  y₀ = y⁻
/// ```
///
/// Innovation and S are those at y⁻, gain and covariance those of the last step.
///
/// Source: Huang and Yuen (2023), *Bayesian Real-Time System Identification*; Gelb, ed. (1974), *Applied Optimal
/// Estimation*, section 6.1; Bell and Cathey (1993), The iterated Kalman filter update as a Gauss-Newton method.
#[derive(Clone, Debug)]
pub struct Linearised {
    belief: Gaussian,
    propagation: Propagation,
    iterations: usize,
}

impl Linearised {
    /// A belief that moves by `propagation` and linearises the sensors up to `iterations` times an update.
    pub fn new(belief: Gaussian, propagation: Propagation, iterations: usize) -> Self {
        Self { belief, propagation, iterations }
    }

    /// Puts the belief elsewhere, as uncertain as it is.
    pub(crate) fn move_to(&mut self, mean: Vector) {
        self.belief.mean = mean;
    }
}

impl Belief for Linearised {
    /// `y⁻` and `P⁻ = λ Φ P Φᵀ + Q`
    fn predict(&mut self, model: &Model, step: Step, noise: &Noise) -> Result<(), FilterError> {
        let Self { belief, propagation, iterations: _ } = self;
        let (mean, transition) = propagation.step(model, &belief.mean, step);
        belief.mean = mean;
        belief.cov = congruence(model.motion(), &transition, &belief.cov);
        noise.spread(&mut belief.cov);
        Ok(())
    }

    fn condition(
        &mut self,
        model: &Model,
        observation: &Observation,
        correction: &mut Correction,
    ) -> Result<(), FilterError> {
        let Self { belief, propagation: _, iterations } = self;
        let prior = (*iterations > 1 && !observation.is_linear()).then(|| belief.clone());
        let at = belief.mean.as_slice();
        let (mean, jacobian) = (observation.read(model, at), observation.jacobian(model, at));
        let expected = Expected::linear(belief, mean, jacobian, observation);
        kalman::condition(belief, &expected, observation, correction)?;
        prior.map_or(Ok(()), |prior| descend(model, &prior, belief, observation, *iterations, correction))
    }

    fn gaussian(&self) -> Cow<'_, Gaussian> {
        Cow::Borrowed(&self.belief)
    }

    /// `P Φᵀ`
    fn cross(&self, model: &Model, step: Step) -> Result<Matrix, FilterError> {
        let (_, transition) = self.propagation.step(model, &self.belief.mean, step);
        Ok(&self.belief.cov * transition.transpose())
    }
}

/// `Φ P Φᵀ`, at least its lower triangle, where the first `motion` rows of Φ are full and the rest is diagonal.
///
/// ```text
/// Φ = [T; 0 D],  Φ P Φᵀ = [T P Tᵀ, ·; D (T P)ᵀ, D P D]
/// ```
fn congruence(motion: usize, transition: &Matrix, cov: &Matrix) -> Matrix {
    let rest = cov.nrows() - motion;
    let top = transition.rows(0, motion);
    let half = top * cov;
    let mut result = cov.clone();
    result.view_mut((0, 0), (motion, motion)).gemm(1.0, &half, &top.transpose(), 0.0);
    for j in 0..motion {
        for i in motion..motion + rest {
            result[(i, j)] = transition[(i, i)] * half[(j, i)];
        }
    }
    for j in motion..motion + rest {
        for i in j..motion + rest {
            result[(i, j)] *= transition[(i, i)] * transition[(j, j)];
        }
    }
    result
}

/// Goes on from the first step of the descent, which has led to `belief`.
fn descend(
    model: &Model,
    prior: &Gaussian,
    belief: &mut Gaussian,
    observation: &Observation,
    iterations: usize,
    correction: &mut Correction,
) -> Result<(), FilterError> {
    for _ in 1..iterations {
        let at = belief.mean.clone();
        let jacobian = observation.jacobian(model, at.as_slice());
        let mean = observation.read(model, at.as_slice()) + &jacobian * (&prior.mean - &at);
        let expected = Expected::linear(prior, mean, jacobian, observation);
        belief.clone_from(prior);
        let mut step = Correction::nothing(at.len(), observation.all_sensors());
        kalman::condition(belief, &expected, observation, &mut step)?;
        correction.gain = step.gain;
        let moved = &belief.mean - at;
        if (0..moved.len()).all(|i| moved[i] * moved[i] <= CONVERGED * belief.cov[(i, i)]) {
            break;
        }
    }
    Ok(())
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
    evaluations,
    begin: |initial, settings, _| Ok(Box::new(Linearised::new(initial, settings.propagation, 1))),
};

pub(super) static EKF: FilterInfo = FilterInfo {
    key: "ekf",
    name: "EKF",
    description: "linearises plant and sensors at the mean",
    reference: "Huang and Yuen (2023), Bayesian Real-Time System Identification",
    is_sampled: false,
    evaluations,
    begin: |initial, settings, _| Ok(Box::new(Linearised::new(initial, settings.propagation, 1))),
};

pub(super) static IEKF: FilterInfo = FilterInfo {
    key: "iekf",
    name: "IEKF",
    description: "linearises the sensors again where the update leads, by Gauss-Newton",
    reference: "Bell and Cathey (1993), The iterated Kalman filter update as a Gauss-Newton method",
    is_sampled: false,
    evaluations,
    begin: |initial, settings, _| Ok(Box::new(Linearised::new(initial, settings.propagation, settings.iterations))),
};
