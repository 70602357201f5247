//! The prediction of a linearising filter: the mean and its transition matrix.

use super::Step;
use crate::Model;
use crate::mathematics::engine::design::Method;
pub use crate::mathematics::engine::propagation::Propagation;
use crate::mathematics::engine::single::Single;
use crate::mathematics::linalg::{Matrix, Vector};

impl Propagation {
    /// The state after a step and its transition matrix Φ, n × n. The rows of Φ below those that move are an identity's.
    pub fn step(self, model: &Model, state: &Vector, step: Step) -> (Vector, Matrix) {
        let mut engine = Single::new(model, Method::Linearised(self, 1), Vec::new());
        let (mut mean, mut transition) = (state.clone(), Matrix::zeros(state.len(), state.len()));
        engine.step_into(self, mean.as_mut_slice(), &step.of_engine(), transition.as_mut_slice());
        (mean, transition)
    }
}
