//! The smoother of a whole record: the filter goes forward, its adjoint backward.

use super::Smoother;
use super::forward::Forward;
use crate::mathematics::filter::Gaussian;
use crate::samples::passage::{Adjoint, Passage};
use crate::samples::waste::Piecewise;
use crate::{Estimates, Record, Stop};

/// Limits the samples freed in one call, which takes about a millisecond.
const FREED: usize = 4_000;

pub(crate) struct FixedInterval {
    forward: Forward,
    /// The belief after each sample: of the filter, then of the smoother.
    beliefs: Vec<Gaussian>,
    /// From each sample to the next, one or several.
    passages: Vec<Vec<Passage>>,
    adjoint: Adjoint,
    stop: Option<Stop>,
    stage: Stage,
}

#[derive(Clone, Copy)]
enum Stage {
    Forth,
    Back(usize),
    Report(usize),
}

impl FixedInterval {
    pub(crate) fn new(forward: Forward) -> Self {
        let (beliefs, passages) = (Vec::new(), Vec::new());
        Self { forward, beliefs, passages, adjoint: Adjoint::nothing(0), stop: None, stage: Stage::Forth }
    }

    fn smooth(&mut self, k: usize) {
        let Self { beliefs, passages, adjoint, .. } = self;
        if k + 1 == passages.len() {
            *adjoint = Adjoint::nothing(beliefs[k].size());
        }
        passages[k].iter().rev().for_each(|passage| adjoint.pass(passage));
        adjoint.tell(&mut beliefs[k]);
    }
}

impl Smoother for FixedInterval {
    /// The samples must be the same in each call: this smoother needs the last one.
    fn advance(&mut self, record: &Record, samples: usize, _: bool, steps: usize, estimates: &mut Estimates) -> bool {
        for _ in 0..steps {
            match self.stage {
                Stage::Forth => {
                    let Self { forward, beliefs, passages, stop, .. } = self;
                    let k = beliefs.len();
                    if k == 0 {
                        // Reserves memory now: growing a large vector copies it, which takes long.
                        beliefs.reserve(samples);
                        passages.reserve(samples);
                    }
                    if k == samples || stop.is_some() {
                        self.stage = Stage::Back(k.saturating_sub(1));
                        continue;
                    }
                    match forward.filter(record) {
                        Ok((belief, passage)) => {
                            beliefs.push(belief);
                            if k > 0 {
                                passages.push(passage);
                            }
                        }
                        Err(at) => *stop = Some(at),
                    }
                }
                Stage::Back(0) => self.stage = Stage::Report(0),
                Stage::Back(k) => {
                    self.smooth(k - 1);
                    self.stage = Stage::Back(k - 1);
                }
                Stage::Report(k) if k == self.beliefs.len() => {
                    if let Some(stop) = self.stop {
                        estimates.set_stop(stop);
                    }
                    return true;
                }
                Stage::Report(k) => {
                    self.forward.report(&self.beliefs[k], estimates);
                    self.stage = Stage::Report(k + 1);
                }
            }
        }
        false
    }

    fn progress(&self, samples: usize) -> f64 {
        let of = |done: usize| done as f64 / samples.max(1) as f64;
        match self.stage {
            // The way forth takes the most time.
            Stage::Forth => 0.6 * of(self.beliefs.len()),
            Stage::Back(k) => 0.6 + 0.3 * (1.0 - of(k)),
            Stage::Report(k) => 0.9 + 0.1 * of(k),
        }
    }

    fn goes_along(&self) -> bool {
        false
    }
}

impl Piecewise for FixedInterval {
    fn free_piece(&mut self) -> bool {
        let end = self.beliefs.len().saturating_sub(FREED);
        let had_any = !self.beliefs.is_empty();
        self.beliefs.truncate(end);
        self.passages.truncate(end);
        had_any
    }
}
