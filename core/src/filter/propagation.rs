//! The motion of a linearising filter: the mean and its transition matrix.

use serde::{Deserialize, Serialize};

use super::Step;
use crate::Model;
use crate::integrate::Integrals;
use crate::linalg::{Matrix, Vector, add_product, copy, copy_vector, fit, multiply};

/// The motion of a linearising filter's mean, and the transition matrix of its covariance.
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
            Self::RungeKutta => transition.runge_kutta(model, state, step),
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
    /// A stage of a Runge-Kutta step, and its derivative by the state.
    stage: Vector,
    derivative: Matrix,
}

impl Default for Transition {
    /// A transition of no component.
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
            stage: Vector::zeros(0),
            derivative: none(),
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
        let Self { mean, matrix, jacobian, block, integrals, rate, rows, .. } = self;
        fit(block, moving, moving);
        for (block, column) in
            block.as_mut_slice().chunks_exact_mut(moving.max(1)).zip(jacobian.as_slice().chunks_exact(n))
        {
            block.copy_from_slice(&column[..moving]);
        }
        integrals.compute(block, step.dt, slope != 0.0);
        let Integrals { transition, constant, slope: by_slope, .. } = &*integrals;

        copy_vector(mean, state);
        add_product(&mut mean.as_mut_slice()[..moving], constant, &rate[..moving]);
        fit(matrix, n, n);
        matrix.as_mut_slice().fill(0.0);
        let columns = matrix.as_mut_slice().chunks_exact_mut(n).zip(transition.as_slice().chunks_exact(moving.max(1)));
        columns.for_each(|(column, transition)| column[..moving].copy_from_slice(transition));
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

    /// One Runge-Kutta step, and its derivative by the state that it starts from: the chain rule, stage by stage.
    fn runge_kutta(&mut self, model: &Model, state: &Vector, step: Step) {
        let n = model.size();
        let mut stage = std::mem::replace(&mut self.stage, Vector::zeros(0));
        copy_vector(&mut self.mean, state);
        for matrix in [&mut self.matrix, &mut self.derivative, &mut self.block] {
            fit(matrix, n, n);
            matrix.fill(0.0);
        }
        self.matrix.fill_diagonal(1.0);
        self.rate.clear();
        self.rate.resize(n, 0.0);
        for (share, weight) in [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
            let (past, weight) = (share * step.dt, weight * step.dt / 6.0);
            copy_vector(&mut stage, state);
            stage.iter_mut().zip(&self.rate).for_each(|(stage, rate)| *stage += rate * past);
            self.rates(model, &stage, step.force(share));
            let Self { mean, matrix, jacobian, block, rate, derivative, .. } = self;
            block.copy_from(derivative);
            *block *= past;
            (0..n).for_each(|i| block[(i, i)] += 1.0);
            multiply(derivative, jacobian, block);
            matrix.iter_mut().zip(derivative.iter()).for_each(|(sum, part)| *sum += part * weight);
            mean.iter_mut().zip(&*rate).for_each(|(sum, part)| *sum += part * weight);
        }
        self.stage = stage;
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
