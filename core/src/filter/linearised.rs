//! First-order linearisation at the mean: KF, EKF and iterated EKF.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use super::kalman::{self, Expected};
use super::{Belief, Correction, FilterError, FilterInfo, Gaussian, Noise, Observation, Step};
use crate::integrate::Integrals;
use crate::linalg::{Matrix, Vector, add_product, copy, copy_vector, fit, multiply_rows, multiply_symmetric};
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
        let mut transition = Transition::default();
        self.step_into(model, state, step, &mut transition);
        (transition.mean, transition.matrix)
    }

    /// [`Self::step`] in place of what `transition` holds.
    pub fn step_into(self, model: &Model, state: &Vector, step: Step, transition: &mut Transition) {
        match self {
            Self::LocalLinearisation => transition.local_linearisation(model, state, step),
            Self::RungeKutta => {
                let (mean, matrix) = runge_kutta(model, state, step);
                (transition.mean, transition.matrix) = (mean, matrix);
            }
            Self::Euler => transition.euler(model, state, step),
        }
    }
}

/// Where a step leads, and the memory that it takes to know.
#[derive(Clone, Debug)]
pub struct Transition {
    /// The state after the step, n numbers.
    pub mean: Vector,
    /// Φ, n × n.
    pub matrix: Matrix,
    jacobian: Matrix,
    /// The part of A that moves.
    block: Matrix,
    integrals: Integrals,
    rate: Vec<f64>,
    rows: Vec<f64>,
}

impl Default for Transition {
    /// That of no component.
    fn default() -> Self {
        let none = || Matrix::zeros(0, 0);
        Self {
            mean: Vector::zeros(0),
            matrix: none(),
            jacobian: none(),
            block: none(),
            integrals: Integrals::default(),
            rate: Vec::new(),
            rows: Vec::new(),
        }
    }
}

impl Transition {
    /// One step of local linearisation. A force that is not held has a slope ḟ.
    ///
    /// ```text
    /// y⁻ = y + Γ₁ g(y, f) + Γ₂ b ḟ,  Φ = exp(A dt),  Γ₁ = dt φ₁(A dt),  Γ₂ = dt² φ₂(A dt),  b = ∂g/∂f
    /// ```
    ///
    /// The column of an input gain g in A is `∂g/∂F f`, and changes with the force: its column of Φ is
    /// `Γ₁ ∂g/∂F f + Γ₂ ∂g/∂F ḟ`. Only what moves needs an exponential, together with parameters that decay:
    ///
    /// ```text
    /// A = [F, C; 0, 0],  exp(A dt) = [exp(F dt), Γ₁ C; 0, I],  Γ₁ and Γ₂ of F
    /// ```
    ///
    /// Source: Huang and Yuen (2023), *Bayesian Real-Time System Identification*, with `A⁻¹(exp(A dt) - I)` read as the
    /// entire function `dt φ₁(A dt)`, which a singular A does not trouble; Van Loan (1978), Computing integrals involving
    /// the matrix exponential.
    fn local_linearisation(&mut self, model: &Model, state: &Vector, step: Step) {
        let (n, moving, slope) = (model.size(), model.moving(), step.slope());
        self.rates(model, state, step.force(0.0));
        let Self { mean, matrix, jacobian, block, integrals, rate, rows } = self;
        fit(block, moving, moving);
        block.copy_from(&jacobian.view((0, 0), (moving, moving)));
        integrals.compute(block, step.dt, slope != 0.0);
        let Integrals { transition, constant, slope: by_slope, .. } = &*integrals;

        copy_vector(mean, state);
        add_product(&mut mean.as_mut_slice()[..moving], constant, &rate[..moving]);
        fit(matrix, n, n);
        matrix.fill(0.0);
        matrix.view_mut((0, 0), (moving, moving)).copy_from(transition);
        let columns = matrix.as_mut_slice().chunks_exact_mut(n).zip(jacobian.as_slice().chunks_exact(n));
        for (j, (column, by_rate)) in columns.enumerate().skip(moving) {
            add_product(&mut column[..moving], constant, &by_rate[..moving]);
            column[j] = 1.0;
        }
        if slope != 0.0 {
            rows.clear();
            rows.resize(3 * moving, 0.0);
            let (by_force, work) = rows.split_at_mut(moving);
            let (effect, work) = work.split_at_mut(moving);
            let motion = model.motion();
            model.motion_by_force_into(state.as_slice(), &mut by_force[..motion], &mut work[..motion]);
            add_product(effect, by_slope, by_force);
            let gain = model.gain(state.as_slice());
            for (mean, effect) in mean.iter_mut().zip(&*effect) {
                *mean += gain * slope * effect;
            }
            if let Some(gain) = model.gain_place() {
                for (entry, effect) in matrix.column_mut(gain).iter_mut().zip(&*effect) {
                    *entry += slope * effect;
                }
            }
        }
    }

    fn euler(&mut self, model: &Model, state: &Vector, step: Step) {
        self.rates(model, state, step.force(0.0));
        let Self { mean, matrix, jacobian, rate, .. } = self;
        copy_vector(mean, state);
        mean.iter_mut().zip(&*rate).for_each(|(mean, rate)| *mean += rate * step.dt);
        copy(matrix, jacobian);
        *matrix *= step.dt;
        for i in 0..state.len() {
            matrix[(i, i)] += 1.0;
        }
    }

    /// Takes A and `g(y, f)` at a state.
    fn rates(&mut self, model: &Model, state: &Vector, force: f64) {
        let Self { jacobian, rate, rows, .. } = self;
        model.jacobian_into(state.as_slice(), force, rows, jacobian);
        rate.resize(model.size(), 0.0);
        model.rate_into(state.as_slice(), force, rate);
    }
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
