//! The input of a truth, kept as far back and drawn as far ahead as needed.

use std::collections::VecDeque;

use crate::Force;
use crate::mathematics::random::Normal;

/// The input of each sample, in its unit.
pub(super) struct Inputs {
    force: Force,
    dt: f64,
    noise: Normal,
    /// The number of the first sample that is kept.
    first: usize,
    kept: VecDeque<f64>,
}

impl Inputs {
    pub(super) fn new(force: Force, dt: f64, noise: Normal) -> Self {
        Self { force, dt, noise, first: 0, kept: VecDeque::new() }
    }

    /// The input of sample `k`, which has not been forgotten.
    pub(super) fn at(&mut self, k: usize) -> f64 {
        while self.first + self.kept.len() <= k {
            let next = self.force.sample(self.first + self.kept.len(), self.dt, &mut self.noise);
            self.kept.push_back(next);
        }
        self.kept[k - self.first]
    }

    /// The input `delay` samples before sample `k`, or after it if that is negative. Before the record the first input
    /// holds.
    pub(super) fn delayed(&mut self, k: usize, delay: i32) -> f64 {
        let steps = delay.unsigned_abs() as usize;
        self.at(if delay < 0 { k + steps } else { k.saturating_sub(steps) })
    }

    /// Forgets the samples before sample `k`.
    pub(super) fn forget_before(&mut self, k: usize) {
        while self.first < k && self.kept.pop_front().is_some() {
            self.first += 1;
        }
    }
}
