//! From one sample to the next.

use crate::mathematics::engine::step;
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

    /// The engine's form of it.
    pub(super) fn of_engine(self) -> step::Step<f64> {
        let Self { forces, hold, dt } = self;
        step::Step { forces, has_slope: hold == Hold::First, dt }
    }

    /// The slope of the force over mass \[m/s³\].
    pub fn slope(&self) -> f64 {
        let [begin, end] = self.forces;
        (end - begin) / self.dt
    }
}
