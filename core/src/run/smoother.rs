//! Smoothed estimates, in the light of later samples: the modified Bryson-Frazier smoother runs the adjoint of the filter backward.
//!
//! ```text
//! Λ̂ₖ = Φᵀ Λ̃ₖ₊₁ Φ,                          λ̂ₖ = Φᵀ λ̃ₖ₊₁,  both zero at the last sample
//! Λ̃ₖ = Hᵀ S⁻¹ H + (I - K H)ᵀ Λ̂ₖ (I - K H),  λ̃ₖ = (I - K H)ᵀ λ̂ₖ - Hᵀ S⁻¹ e
//! Pₖˢ = Pₖ - Pₖ Λ̂ₖ Pₖ,                       yₖˢ = yₖ - Pₖ λ̂ₖ
//! ```
//!
//! In exact arithmetic it is the smoother of Rauch, Tung and Striebel, `G = Pₖ Φᵀ (P⁻ₖ₊₁)⁻¹`. But G grows where a motion without
//! process noise dies out, and with it the rounding of later samples; the adjoint decays, and needs no inverse but that of S.
//!
//! Φ and H are those that the filter linearises with; those of sigma points are regressions on the state. For an update without
//! an H, division by P⁻ gives it. Fading counts as process noise, `(λ - 1) Φ P Φᵀ + Q`, and so does what a jump adds to P⁻.
//!
//! Source: Bierman (1973), Fixed interval smoothing with discrete measurements; Rauch, Tung and Striebel (1965), Maximum
//! likelihood estimates of linear dynamic systems; Särkkä (2008), Unscented Rauch-Tung-Striebel smoother.

use std::collections::VecDeque;

use kalmanscope_filters::Stop;
use kalmanscope_filters::filter::{FilterError, Gaussian};
use kalmanscope_filters::linalg::{Matrix, Vector};
use kalmanscope_records::Record;

use crate::run::estimator::update::InUnits;
use crate::run::estimator::{FilterContext, Truncating, Truncation};
use crate::run::passage::{Adjoint, Passage, PassageUpdate, Passages, congruence};
use crate::run::sink::{Sample, Sink};
use crate::run::waste::Piecewise;
use crate::{Estimates, FilterSettings, Pass};

/// A smoother in progress. If its filter stops, it ends with the last sample before.
pub trait Smoother: Piecewise {
    /// Continues for at most `steps` steps over the first `samples` samples, all if it `is_whole`. Returns whether all is done.
    fn advance(&mut self, record: &Record, samples: usize, is_whole: bool, steps: usize, out: &mut Estimates) -> bool;

    /// The share of its work that is done, from 0 to 1.
    fn progress(&self, samples: usize) -> f64;

    /// Whether it takes in more samples later; else it needs the last one.
    fn goes_along(&self) -> bool {
        false
    }
}

impl Piecewise for Box<dyn Smoother> {
    fn free_piece(&mut self) -> bool {
        (**self).free_piece()
    }
}

/// A filter whose beliefs are smoothed later: a pass over the record, which keeps its passages.
pub(crate) struct Forward {
    pass: Pass,
    sink: Passages,
    hindsight: Hindsight,
}

pub(crate) struct Hindsight {
    in_units: Option<Box<InUnits<f64>>>,
    truncation: Truncation,
}

impl Forward {
    /// The filter with these settings before its first sample, over sensors in these columns of a record. `None` if it has no passages.
    pub(crate) fn new(settings: &FilterSettings, context: &FilterContext, sensors: Vec<usize>) -> Option<Self> {
        let one = FilterSettings { guesses: 1, process_scales: 1, walk: 0.0, ..settings.clone() };
        let mut pass = Pass::with(&one, context.clone(), sensors);
        pass.keep_passages().then(|| Self {
            pass,
            sink: Passages::default(),
            hindsight: Hindsight::new(settings, context),
        })
    }

    pub(crate) fn filter(&mut self, record: &Record) -> Result<(Gaussian, Vec<Passage>), Stop> {
        let Self { pass, sink, .. } = self;
        pass.follow(record, pass.done() + 1, sink);
        let passages = std::mem::take(&mut sink.all);
        match (sink.stop, sink.belief.take()) {
            (None, Some(belief)) => Ok((belief, passages)),
            (stop, _) => Err(stop.unwrap_or(Stop { sample: pass.done(), reason: FilterError::NotFinite })),
        }
    }
}

impl Hindsight {
    pub(crate) fn new(settings: &FilterSettings, context: &FilterContext) -> Self {
        let model = context.model(settings);
        let in_units = InUnits::new(&model.state.logarithms, model.size(), 0);
        Self { in_units, truncation: Truncation::of(settings, model.channels()) }
    }

    pub(crate) fn report(&mut self, Gaussian { mean, cov }: &Gaussian, sink: &mut dyn Sink) {
        let Self { in_units, truncation } = self;
        let sample = Sample::unmeasured(mean.as_slice(), cov.as_slice());
        let mut sink = Truncating { truncation, sink };
        match in_units.as_deref_mut() {
            Some(in_units) => sink.push(&in_units.take(sample).0),
            None => sink.push(&sample),
        }
    }
}

/// Limits the samples freed in one call, which takes about a millisecond.
const FREED: usize = 4_000;

/// The smoother of a whole record: the filter goes forward, its adjoint backward.
pub(crate) struct FixedInterval {
    forward: Forward,
    beliefs: Vec<Gaussian>,
    passages: Vec<Vec<Passage>>,
    adjoint: Adjoint,
    stop: Option<Stop>,
    stage: SmootherStage,
}

#[derive(Clone, Copy)]
enum SmootherStage {
    Forth,
    Back(usize),
    Report(usize),
}

impl FixedInterval {
    pub(crate) fn new(forward: Forward) -> Self {
        let (beliefs, passages) = (Vec::new(), Vec::new());
        Self { forward, beliefs, passages, adjoint: Adjoint::nothing(0), stop: None, stage: SmootherStage::Forth }
    }
}

impl Smoother for FixedInterval {
    /// The samples must be the same in each call: this smoother needs the last one.
    fn advance(&mut self, record: &Record, samples: usize, _: bool, steps: usize, estimates: &mut Estimates) -> bool {
        for _ in 0..steps {
            match self.stage {
                SmootherStage::Forth => {
                    let Self { forward, beliefs, passages, stop, .. } = self;
                    let k = beliefs.len();
                    if k == 0 {
                        // Reserves memory now: growing a large vector copies it, which takes long.
                        beliefs.reserve(samples);
                        passages.reserve(samples);
                    }
                    if k == samples || stop.is_some() {
                        self.stage = SmootherStage::Back(k.saturating_sub(1));
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
                SmootherStage::Back(0) => self.stage = SmootherStage::Report(0),
                SmootherStage::Back(k) => {
                    let Self { beliefs, passages, adjoint, .. } = self;
                    if k == passages.len() {
                        *adjoint = Adjoint::nothing(beliefs[k - 1].size());
                    }
                    passages[k - 1].iter().rev().for_each(|passage| adjoint.pass(passage));
                    adjoint.correct(&mut beliefs[k - 1]);
                    self.stage = SmootherStage::Back(k - 1);
                }
                SmootherStage::Report(k) if k == self.beliefs.len() => {
                    if let Some(stop) = self.stop {
                        estimates.stop_at(stop);
                    }
                    return true;
                }
                SmootherStage::Report(k) => {
                    self.forward.hindsight.report(&self.beliefs[k], estimates);
                    self.stage = SmootherStage::Report(k + 1);
                }
            }
        }
        false
    }

    fn progress(&self, samples: usize) -> f64 {
        let of = |done: usize| done as f64 / samples.max(1) as f64;
        match self.stage {
            SmootherStage::Forth => 0.6 * of(self.beliefs.len()),
            SmootherStage::Back(k) => 0.6 + 0.3 * (1.0 - of(k)),
            SmootherStage::Report(k) => 0.9 + 0.1 * of(k),
        }
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

/// The smoother with a fixed lag: two stacks compose the ways back over its window, by about three compositions a sample for any lag.
/// Source: Anderson and Moore (1979), Optimal filtering, chapter 7; Särkkä and García-Fernández (2021), Temporal parallelization of
/// Bayesian smoothers; Tangwongsan, Hirzel and Schneider (2015), General incremental sliding-window aggregation.
pub(crate) struct FixedLag {
    forward: Forward,
    lag: usize,
    beliefs: VecDeque<Gaussian>,
    reported: usize,
    window: LagWindow,
    stop: Option<Stop>,
}

impl FixedLag {
    pub(crate) fn new(forward: Forward, lag: usize) -> Self {
        let lag = lag.max(1);
        Self { forward, lag, beliefs: VecDeque::new(), reported: 0, window: LagWindow::default(), stop: None }
    }
}

impl Smoother for FixedLag {
    fn advance(&mut self, record: &Record, samples: usize, is_whole: bool, steps: usize, out: &mut Estimates) -> bool {
        for _ in 0..steps {
            let filtered = self.reported + self.beliefs.len();
            let is_end = self.stop.is_some() || (is_whole && filtered == samples);
            if self.beliefs.len() > self.lag || (is_end && !self.beliefs.is_empty()) {
                if self.window.turn_one() {
                    continue;
                }
                let Some(mut belief) = self.beliefs.pop_front() else { continue };
                if self.reported >= out.forgotten() {
                    self.window.adjoint(belief.size()).correct(&mut belief);
                    self.forward.hindsight.report(&belief, out);
                }
                self.window.older.pop();
                self.reported += 1;
            } else if is_end || filtered == samples {
                if let Some(stop) = self.stop {
                    out.stop_at(stop);
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
/// ```text
/// λ ↦ Aᵀ λ - b,  Λ ↦ Aᵀ Λ A + C
/// ```
#[derive(Clone)]
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
        let Some(PassageUpdate { kept, information, score }) = update else {
            return Self { closed_loop: transition.clone(), score: Vector::zeros(n), information: Matrix::zeros(n, n) };
        };
        let mut gained = information.clone();
        congruence(&mut gained, transition);
        Self { closed_loop: kept * transition, score: transition.tr_mul(score), information: gained }
    }

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

#[derive(Default)]
struct LagWindow {
    /// For each of the older passages, the way back from the last of them over all to it; the oldest is the last.
    older: Vec<WayBack>,
    newer: Vec<WayBack>,
    over_newer: Option<WayBack>,
}

impl LagWindow {
    fn push(&mut self, passages: &[Passage]) {
        let ways = passages.iter().map(WayBack::over);
        let Some(one) = ways.reduce(|before, next| before.after(&next)) else { return };
        self.over_newer = Some(self.over_newer.as_ref().map_or_else(|| one.clone(), |newer| newer.after(&one)));
        self.newer.push(one);
    }

    fn turn_one(&mut self) -> bool {
        let turns = self.older.is_empty() || self.over_newer.is_none();
        // One a call: to turn all at once would take as long as the lag.
        let Some(one) = self.newer.pop_if(|_| turns) else { return false };
        self.over_newer = None;
        let turned = match self.older.last() {
            Some(later) => one.after(later),
            None => one,
        };
        self.older.push(turned);
        true
    }

    fn adjoint(&self, n: usize) -> Adjoint {
        let adjoint_of =
            |WayBack { score, information, .. }: &WayBack| Adjoint { score: -score, information: information.clone() };
        match (self.older.last(), &self.over_newer) {
            (Some(older), Some(newer)) => adjoint_of(&older.after(newer)),
            (Some(all), None) => adjoint_of(all),
            (None, _) => Adjoint::nothing(n),
        }
    }
}
