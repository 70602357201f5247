//! The motion of a linearising filter: the mean and its transition matrix.

use serde::{Deserialize, Serialize};

use super::Step;
use crate::Model;
use crate::engine::design::Method;
use crate::engine::single::Single;
use crate::linalg::{Matrix, Vector};

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

    /// The state after a step and its transition matrix Φ, n × n. The rows of Φ below those that move are an identity's.
    pub fn step(self, model: &Model, state: &Vector, step: Step) -> (Vector, Matrix) {
        let mut engine = Single::new(model, Method::Linearised(self, 1), Vec::new());
        let (mut mean, mut transition) = (state.clone(), Matrix::zeros(state.len(), state.len()));
        engine.step_into(self, mean.as_mut_slice(), &step.of_engine(), transition.as_mut_slice());
        (mean, transition)
    }
}
