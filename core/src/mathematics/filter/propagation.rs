//! The prediction of a linearising filter: the mean and its transition matrix.

use super::Step;
use crate::Model;
use crate::mathematics::engine::level::Baseline;
use crate::mathematics::engine::linearised::Linearised;
use crate::mathematics::engine::model;
pub use crate::mathematics::engine::propagation::Propagation;
use crate::mathematics::linalg::{Matrix, Vector};

impl Propagation {
    /// The state after a step and its transition matrix Φ, n × n. The rows of Φ below those that move are an identity's.
    pub fn step(self, model: &Model, state: &Vector, step: Step) -> (Vector, Matrix) {
        let engine = model::Model::of(model);
        let mut linearised = Linearised::new(&engine);
        let (mut mean, mut transition) = (state.clone(), Matrix::identity(state.len(), state.len()));
        linearised.step(Baseline, self, &engine, mean.as_mut_slice(), &step.of_engine());
        let moving = engine.moving();
        transition.rows_mut(0, moving).copy_from_slice(&linearised.rows);
        (mean, transition)
    }
}
