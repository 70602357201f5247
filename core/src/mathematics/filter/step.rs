//! From one sample to the next.

use crate::Model;
use crate::mathematics::integrate::RungeKutta;
use crate::mathematics::linalg::Matrix;
use crate::mathematics::model::Hold;

/// A step from one sample to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The recorded force over mass at its beginning and at its end, linear in between \[m/s²\]; the same where it is held.
    pub forces: [f64; 2],
    /// The course of the force between samples.
    pub hold: Hold,
    /// The time that it takes \[s\].
    pub dt: f64,
}

impl Step {
    /// The force over mass after a share of the step, from 0 to 1 \[m/s²\].
    pub fn force(&self, share: f64) -> f64 {
        let [begin, end] = self.forces;
        begin + (end - begin) * share
    }

    /// A part of the step, of this many that take the same time.
    pub(super) fn part(&self, i: usize, parts: usize) -> Self {
        let [begin, end] = self.forces;
        let force = |i: usize| match i {
            0 => begin,
            i if i == parts => end,
            i => self.force(i as f64 / parts as f64),
        };
        Self { forces: [force(i), force(i + 1)], dt: self.dt / parts as f64, ..*self }
    }

    /// The slope of the force over mass \[m/s³\].
    pub fn slope(&self) -> f64 {
        let [begin, end] = self.forces;
        (end - begin) / self.dt
    }

    /// Moves states, each a column of n numbers, by one classical fourth-order Runge-Kutta step of `ẏ = g(y, f)`.
    /// Components that do not move keep every bit.
    pub fn advance(&self, model: &Model, states: &mut Matrix, method: &mut RungeKutta) {
        let columns = states.as_mut_slice().chunks_exact_mut(model.size());
        if model.eta() == 0.0 {
            let rate = |share, state: &[f64], rate: &mut [f64]| model.motion_rate_into(state, self.force(share), rate);
            columns.for_each(|state| method.advance(state, model.motion(), self.dt, rate));
        } else {
            let rate = |share, state: &[f64], rate: &mut [f64]| model.rate_into(state, self.force(share), rate);
            columns.for_each(|state| method.advance(state, model.size(), self.dt, rate));
        }
    }
}
