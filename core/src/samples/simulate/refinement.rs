//! One step of a plant that is not linear, by Runge-Kutta steps that are halved where needed, such as around kinks of the rate.

use super::TruthError;
use crate::mathematics::integrate::runge_kutta;
use crate::mathematics::linalg::Vector;
use crate::mathematics::model::Model;

/// Limits the difference between a Runge-Kutta step and two steps of half its length, relative to the largest value of
/// each component so far. After extrapolation the error is a hundredth of that, and below 1e-9 of the signal after a
/// minute.
const ACCURACY: f64 = 3e-12;

/// After a failed integration, the plant counts as diverged if its state is this many times as large as ever before.
const RUNAWAY: f64 = 100.0;

/// Limits the times that the steps of one sample are halved.
const MOST: u64 = 4096;

/// A plant under a load over one sample.
pub(super) struct Motion<'a> {
    pub(super) model: &'a Model,
    pub(super) forces: [f64; 2],
    pub(super) disturbance: f64,
    /// The time between samples \[s\].
    pub(super) dt: f64,
}

impl Motion<'_> {
    /// One Runge-Kutta step over a share of the sample.
    fn step(&self, state: &Vector, from: f64, share: f64) -> Vector {
        let [begin, end] = self.forces;
        runge_kutta(state, share * self.dt, |s, y| {
            let force = if begin == end { begin } else { begin + (end - begin) * (from + share * s) };
            let acting = self.model.acting_force(y.as_slice(), force) + self.disturbance;
            self.model.rate_under(y.as_slice(), acting)
        })
    }
}

/// A step under way: the sample is divided into parts that are halved until the difference of one step to two is small enough.
///
/// Source: Hairer, Nørsett and Wanner (1993), *Solving Ordinary Differential Equations I*, section II.4.
pub(super) struct Refinement {
    /// The state at the beginning of the part.
    state: Vector,
    /// Where the part begins and its length, as shares of the sample.
    part: (f64, f64),
    /// The result of one step over the part.
    coarse: Vector,
    /// The parts after this one, the next one last.
    rest: Vec<(f64, f64)>,
    halved: u64,
}

impl Refinement {
    /// The step from a state, before its first halving.
    pub(super) fn new(motion: &Motion<'_>, state: &Vector) -> Self {
        let coarse = motion.step(state, 0.0, 1.0);
        Self { state: state.clone(), part: (0.0, 1.0), coarse, rest: Vec::new(), halved: 0 }
    }

    /// The number of times that steps have been halved.
    pub(super) fn halved(&self) -> u64 {
        self.halved
    }

    /// The state at the end of the step, once it is done.
    pub(super) fn into_state(self) -> Vector {
        self.state
    }

    /// Goes on until all parts are done, or steps have been halved `most` times. Returns whether the step is done. `size` is the
    /// largest absolute value of each component so far.
    pub(super) fn advance(&mut self, motion: &Motion<'_>, size: &Vector, most: u64) -> Result<bool, TruthError> {
        let begin = self.halved;
        loop {
            let (from, share) = self.part;
            let half = 0.5 * share;
            let middle = motion.step(&self.state, from, half);
            let fine = motion.step(&middle, from + half, half);
            let difference = &fine - &self.coarse;
            let close = |i: usize| difference[i].abs() <= ACCURACY * size[i].max(fine[i].abs());
            let is_close = (0..fine.len()).all(close);
            if is_close || fine.iter().any(|x| !x.is_finite()) {
                // A plant that diverges ends with the next sample, which reports it.
                self.state = if is_close { fine + difference / 15.0 } else { fine };
                let Some((from, share)) = self.rest.pop() else { return Ok(true) };
                self.coarse = motion.step(&self.state, from, share);
                self.part = (from, share);
                continue;
            }
            if self.halved >= MOST {
                return Err(self.failure(motion, size));
            }
            self.halved += 1;
            self.rest.push((from + half, half));
            (self.part, self.coarse) = ((from, half), middle);
            if self.halved - begin >= most {
                return Ok(false);
            }
        }
    }

    /// The reason why no number of halvings is enough: a diverging plant does so within ever shorter times.
    fn failure(&self, motion: &Motion<'_>, size: &Vector) -> TruthError {
        let far = (0..size.len()).find(|&i| size[i] > 0.0 && self.state[i].abs() > RUNAWAY * size[i]);
        far.map_or(TruthError::StepTooLong, |i| TruthError::Channel(motion.model.channels()[i]))
    }
}
