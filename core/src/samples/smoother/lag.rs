//! The smoother with a fixed lag: it goes along with the filter, and knows each sample in the light of the next few.
//!
//! Each report needs the way back over all passages of the lag. The window moves by one passage a sample, and the ways
//! back compose: two stacks keep the composition of the window at about three compositions a sample, whatever the lag.
//!
//! Source: Anderson and Moore (1979), Optimal filtering, chapter 7; Särkkä and García-Fernández (2021), Temporal
//! parallelization of Bayesian smoothers; Tangwongsan, Hirzel and Schneider (2015), General incremental sliding-window
//! aggregation.

use std::collections::VecDeque;

use super::Smoother;
use super::forward::Forward;
use crate::mathematics::filter::Gaussian;
use crate::mathematics::linalg::{Matrix, Vector};
use crate::samples::passage::{Adjoint, Passage, Update, congruence};
use crate::samples::waste::Piecewise;
use crate::{Estimates, Record, Stop};

pub(crate) struct FixedLag {
    forward: Forward,
    lag: usize,
    beliefs: VecDeque<Gaussian>,
    reported: usize,
    window: Window,
    stop: Option<Stop>,
}

impl FixedLag {
    /// The smoother of a filter before its first sample, with a lag of at least one sample.
    pub(crate) fn new(forward: Forward, lag: usize) -> Self {
        let lag = lag.max(1);
        Self { forward, lag, beliefs: VecDeque::new(), reported: 0, window: Window::default(), stop: None }
    }

    fn report(&mut self, estimates: &mut Estimates) {
        let Some(mut belief) = self.beliefs.pop_front() else { return };
        if self.reported >= estimates.forgotten() {
            self.window.adjoint(belief.size()).tell(&mut belief);
            self.forward.report(&belief, estimates);
        }
        self.window.pop();
        self.reported += 1;
    }
}

impl Smoother for FixedLag {
    fn advance(
        &mut self,
        record: &Record,
        samples: usize,
        is_whole: bool,
        steps: usize,
        estimates: &mut Estimates,
    ) -> bool {
        for _ in 0..steps {
            let filtered = self.reported + self.beliefs.len();
            let is_end = self.stop.is_some() || (is_whole && filtered == samples);
            if self.beliefs.len() > self.lag || (is_end && !self.beliefs.is_empty()) {
                if !self.window.turn_one() {
                    self.report(estimates);
                }
            } else if is_end || filtered == samples {
                if let Some(stop) = self.stop {
                    estimates.set_stop(stop);
                }
                return true;
            } else {
                match self.forward.filter(record) {
                    Ok((belief, passages)) => {
                        self.beliefs.push_back(belief);
                        self.window.push(&passages);
                    }
                    Err(at) => self.stop = Some(at),
                }
            }
        }
        false
    }

    fn progress(&self, samples: usize) -> f64 {
        (self.reported + self.beliefs.len()) as f64 / samples.max(1) as f64
    }

    fn goes_along(&self) -> bool {
        true
    }
}

impl Piecewise for FixedLag {
    fn free_piece(&mut self) -> bool {
        self.beliefs.pop_back().is_some() || self.window.older.pop().is_some() || self.window.newer.pop().is_some()
    }
}

/// The way back over several passages.
///
/// ```text
/// λ ↦ Aᵀ λ - b,  Λ ↦ Aᵀ Λ A + C
/// ```
struct WayBack {
    /// A, n × n.
    closed_loop: Matrix,
    /// b, n numbers.
    score: Vector,
    /// C, n × n.
    information: Matrix,
}

impl WayBack {
    fn over(Passage { transition, update }: &Passage) -> Self {
        let n = transition.nrows();
        let Some(Update { kept, information, score }) = update else {
            return Self { closed_loop: transition.clone(), score: Vector::zeros(n), information: Matrix::zeros(n, n) };
        };
        let mut gained = information.clone();
        congruence(&mut gained, transition);
        Self { closed_loop: kept * transition, score: transition.tr_mul(score), information: gained }
    }

    /// The way back over later passages and then over these.
    fn after(&self, later: &Self) -> Self {
        let mut gained = later.information.clone();
        congruence(&mut gained, &self.closed_loop);
        Self {
            closed_loop: &later.closed_loop * &self.closed_loop,
            score: &self.score + self.closed_loop.tr_mul(&later.score),
            information: &self.information + gained,
        }
    }
}

/// The ways back over the passages of a window, as two stacks.
#[derive(Default)]
struct Window {
    /// For each of the older passages, the way back from the last of them over all to it; the oldest is the last.
    older: Vec<WayBack>,
    newer: Vec<WayBack>,
    over_newer: Option<WayBack>,
}

impl Window {
    fn push(&mut self, passages: &[Passage]) {
        let over = |passages: &[Passage]| {
            let ways = passages.iter().map(WayBack::over);
            ways.reduce(|before, next| before.after(&next))
        };
        let Some(one) = over(passages) else { return };
        self.over_newer = match &self.over_newer {
            Some(newer) => Some(newer.after(&one)),
            None => over(passages),
        };
        self.newer.push(one);
    }

    /// Where no older passages are left, turns one of the newer into the older. Returns whether there was one to turn.
    fn turn_one(&mut self) -> bool {
        let turns = self.older.is_empty() || self.over_newer.is_none();
        let Some(one) = self.newer.pop_if(|_| turns) else { return false };
        self.over_newer = None;
        let turned = match self.older.last() {
            Some(later) => one.after(later),
            None => one,
        };
        self.older.push(turned);
        true
    }

    fn pop(&mut self) {
        self.older.pop();
    }

    /// All that the window tells about the sample before it.
    fn adjoint(&self, n: usize) -> Adjoint {
        let told =
            |WayBack { score, information, .. }: &WayBack| Adjoint { score: -score, information: information.clone() };
        match (self.older.last(), &self.over_newer) {
            (Some(older), Some(newer)) => told(&older.after(newer)),
            (Some(all), None) => told(all),
            (None, _) => Adjoint::nothing(n),
        }
    }
}
