//! From one sample to the next.

use crate::Model;
use crate::integrate::RungeKutta;
use crate::linalg::Matrix;

/// A step from one sample to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The recorded force over mass at its beginning and at its end, linear in between \[m/s²\].
    pub forces: [f64; 2],
    /// The time that it takes \[s\].
    pub dt: f64,
}

impl Step {
    /// The force over mass after a share of the step, from 0 to 1 \[m/s²\].
    pub fn force(&self, share: f64) -> f64 {
        let [begin, end] = self.forces;
        begin + (end - begin) * share
    }

    /// The slope of the force over mass \[m/s³\].
    pub fn slope(&self) -> f64 {
        let [begin, end] = self.forces;
        (end - begin) / self.dt
    }

    /// Moves states, each a column of n numbers, by one classical fourth-order Runge-Kutta step of `ẏ = g(y, f)`.
    pub fn advance(&self, model: &Model, states: &mut Matrix) {
        let mut method = RungeKutta::new(model.size());
        for state in states.as_mut_slice().chunks_exact_mut(model.size()) {
            method.advance(state, self.dt, |share, state, rate| model.rate_into(state, self.force(share), rate));
        }
    }
}
