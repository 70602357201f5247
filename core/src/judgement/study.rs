//! A run with its analysis, over the same samples.

use std::sync::Arc;

use crate::data::scenario::cost;
use crate::judgement::analysis::Subject;
use crate::samples::waste::Spare;
use crate::{Analysis, Record, Run, RunError, Scenario, Source, Wanted};

/// Keep the memory of at most this many samples for the next edit; return the rest to the system.
const KEPT_SPARE: usize = 100_000;

/// The least window: a part of it is forgotten, and a part is kept.
const LEAST_WINDOW: usize = 4;

/// A quarter stays at the limit of a window: all that stays is moved, and analysed again, within one frame.
pub(crate) fn forgotten_of(window: usize) -> usize {
    window - window / 4
}

/// A run and its analysis, which make one picture. The run can be extended ([`Self::advance_to`]), or replaced by one
/// that a [`Job`](crate::Job) has computed beside it.
pub struct Study {
    pub(crate) run: Run,
    pub(crate) analysis: Analysis,
    pub(crate) spare: Spare,
    pub(crate) window: usize,
}

impl Study {
    /// A study before the first sample. It keeps at most `window` samples of a simulated run, and forgets the first
    /// three quarters of them at that limit.
    ///
    /// # Errors
    /// [`RunError`] where the scenario is impossible, or the source does not fit it.
    pub fn new(scenario: &Scenario, source: Source, window: usize) -> Result<Self, RunError> {
        let run = Run::from_source(scenario, source)?;
        Ok(Self { run, analysis: Analysis::default(), spare: Spare::default(), window: window.max(LEAST_WINDOW) })
    }

    /// The run.
    pub fn run(&self) -> &Run {
        &self.run
    }

    /// Its analysis.
    pub fn analysis(&self) -> &Analysis {
        &self.analysis
    }

    /// Takes in a live record that has more samples now, as [`Run::lengthen`] does, for [`Self::advance_to`] to go on.
    pub fn lengthen(&mut self, record: Arc<Record>) -> bool {
        self.run.lengthen(record)
    }

    /// Limits the samples of a simulated run that are kept from now on.
    pub fn keep(&mut self, window: usize) {
        self.window = window.max(LEAST_WINDOW);
    }

    /// Sets the results to compute from now on, in addition to the estimates.
    pub fn want(&mut self, wanted: Wanted) {
        self.analysis.want(wanted);
    }

    /// Says whether to put off the diagnoses of new samples and of [`Job`](crate::Job)s begun from now on. While a number is
    /// dragged, they change faster than anybody reads.
    pub fn put_off_diagnoses(&mut self, wait: bool) {
        self.analysis.waits = wait;
    }

    /// Whether diagnoses are put off. Once they no longer are, [`Self::advance_to`] makes them.
    pub fn puts_off_diagnoses(&self) -> bool {
        self.analysis.waits
    }

    /// Returns unused memory to the system, except for what the next edit needs. Calls `while_time` after each piece and
    /// returns early if it is false. Returns whether everything is done.
    pub fn free(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        while self.analysis.free_one() {
            if !while_time() {
                return false;
            }
        }
        true
    }

    /// Runs all filters side by side until `samples` samples, counted from the beginning, are done, and the analysis
    /// with them. Calls `while_time` after each piece of work of about a millisecond and returns early if it is false.
    /// Returns whether everything is done.
    pub fn advance_to(&mut self, samples: usize, while_time: &mut dyn FnMut() -> bool) -> bool {
        if !self.free(while_time) {
            return false;
        }
        let Self { run, analysis, spare, window } = self;
        while spare.len() > KEPT_SPARE && spare.free_one() {
            if !while_time() {
                return false;
            }
        }
        if !analysis.advance(&Subject::of(run), while_time) {
            return false;
        }
        let scenario = run.scenario();
        let costs = scenario.filters.iter().map(|filter| filter.time_of_step(scenario));
        let chunk = cost::chunk(cost::OF_RECORD + costs.sum::<f64>());
        let is_measured = run.source().is_measured();
        while run.done() < samples.min(run.samples()) {
            let end = if is_measured { usize::MAX } else { run.record().forgotten().saturating_add(*window) };
            if run.done() >= end {
                // The analysis covers everything that is forgotten.
                run.forget(forgotten_of(*window));
                analysis.forget_before(run.record().forgotten());
                continue;
            }
            let goal = samples.min(run.done() + chunk).min(end);
            if !run.simulate(goal, while_time) {
                return false;
            }
            // Where one sample of all filters takes long, each filter is a piece of work.
            if chunk == 1 && !run.prepare(while_time) {
                return false;
            }
            run.advance_to(goal);
            if !analysis.advance(&Subject::of(run), while_time) || !while_time() {
                break;
            }
        }
        run.done() >= samples.min(run.samples()) && analysis.advance(&Subject::of(run), while_time)
    }
}
