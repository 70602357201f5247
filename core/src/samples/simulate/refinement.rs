//! One step of a plant that is not linear, by Runge-Kutta steps that are halved where needed, such as around kinks of the rate.

use super::TruthError;
use crate::mathematics::engine::runge_kutta::classical;
use crate::mathematics::model::Model;

/// Limits the difference between a Runge-Kutta step and two steps of half its length, relative to the largest value of
/// each component so far. After extrapolation the error is a hundredth of that, and below 1e-9 of the signal after a
/// minute.
const ACCURACY: f64 = 3e-12;

/// After a failed integration, the plant counts as diverged if its state is this many times as large as ever before.
const RUNAWAY: f64 = 100.0;

const MOST: u64 = 4096;

pub(super) struct Motion<'a> {
    pub(super) model: &'a Model,
    pub(super) forces: [f64; 2],
    pub(super) disturbance: f64,
    /// The time between samples \[s\].
    pub(super) dt: f64,
}

impl Motion<'_> {
    /// Makes `to` the state after one Runge-Kutta step from another one, over a share of the sample.
    fn step(&self, memory: &mut [Vec<f64>; 5], to: &mut Vec<f64>, state: &[f64], (from, share): (f64, f64)) {
        let [begin, end] = self.forces;
        to.clear();
        to.extend_from_slice(state);
        memory.iter_mut().for_each(|numbers| numbers.resize(state.len(), 0.0));
        let rate = |y: &[f64], s: f64, rate: &mut [f64]| {
            let force = if begin == end { begin } else { begin + (end - begin) * (from + share * s) };
            let acting = self.model.acting_force(y, force) + self.disturbance;
            self.model.rate_under_into(y, acting, rate);
        };
        classical(rate, to, [0.0, 0.5, 1.0], share * self.dt, memory.each_mut().map(Vec::as_mut_slice));
    }
}

/// A step under way: the sample is divided into parts that are halved until the difference of one step to two is small enough.
/// Source: Hairer, Nørsett and Wanner (1993), *Solving Ordinary Differential Equations I*, section II.4.
#[derive(Default)]
pub(super) struct Refinement {
    /// The state at the beginning of the part, and at the end of the step once that is done.
    pub(super) state: Vec<f64>,
    /// Where the part begins and its length, as shares of the sample.
    part: (f64, f64),
    coarse: Vec<f64>,
    middle: Vec<f64>,
    fine: Vec<f64>,
    rest: Vec<(f64, f64)>,
    pub(super) halved: u64,
    /// Memory of a Runge-Kutta step.
    memory: [Vec<f64>; 5],
}

impl Refinement {
    pub(super) fn begin(&mut self, motion: &Motion<'_>, from: &[f64]) {
        let Self { state, part, coarse, rest, halved, memory, .. } = self;
        state.clear();
        state.extend_from_slice(from);
        (*part, *halved) = ((0.0, 1.0), 0);
        rest.clear();
        motion.step(memory, coarse, state, *part);
    }

    /// Halves steps at most `most` times; returns whether all parts are done. `size` are the largest absolute values.
    pub(super) fn advance(&mut self, motion: &Motion<'_>, size: &[f64], most: u64) -> Result<bool, TruthError> {
        let Self { state, part, coarse, middle, fine, rest, halved, memory } = self;
        let begin = *halved;
        loop {
            let (from, share) = *part;
            let half = 0.5 * share;
            motion.step(memory, middle, state, (from, half));
            motion.step(memory, fine, middle, (from + half, half));
            let close = |i: usize| (fine[i] - coarse[i]).abs() <= ACCURACY * size[i].max(fine[i].abs());
            let is_close = (0..fine.len()).all(close);
            if is_close || fine.iter().any(|x| !x.is_finite()) {
                // A plant that diverges ends with the next sample, which reports it.
                for ((state, fine), coarse) in state.iter_mut().zip(&*fine).zip(&*coarse) {
                    *state = if is_close { fine + (fine - coarse) / 15.0 } else { *fine };
                }
                let Some(next) = rest.pop() else { return Ok(true) };
                motion.step(memory, coarse, state, next);
                *part = next;
                continue;
            }
            if *halved >= MOST {
                return Err(self.failure(motion, size));
            }
            *halved += 1;
            rest.push((from + half, half));
            *part = (from, half);
            std::mem::swap(coarse, middle);
            if *halved - begin >= most {
                return Ok(false);
            }
        }
    }

    /// The reason why no number of halvings is enough: a diverging plant does so within ever shorter times.
    fn failure(&self, motion: &Motion<'_>, size: &[f64]) -> TruthError {
        let far = (0..size.len()).find(|&i| size[i] > 0.0 && self.state[i].abs() > RUNAWAY * size[i]);
        far.map_or(TruthError::StepTooLong, |i| TruthError::Channel(motion.model.channels()[i]))
    }
}
