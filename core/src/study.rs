//! A run with its analysis, always about the same samples.

use crate::analysis::Subject;
use crate::spare::Spare;
use crate::{Analysis, Run, RunError, Scenario, Source, Wanted, cost};

/// Keep the memory of at most this many samples for the next edit; more is given back to the system.
const KEPT_SPARE: usize = 100_000;

/// A run and its analysis: the parts of one picture. The run can be lengthened ([`Self::advance_to`]), or replaced by
/// another one that a [`Job`](crate::Job) has computed beside it.
pub struct Study {
    pub(crate) run: Run,
    pub(crate) analysis: Analysis,
    pub(crate) spare: Spare,
    pub(crate) window: usize,
}

impl Study {
    /// A study before the first sample. Of a simulated run it keeps no more than `window` samples, and forgets half of them
    /// when they are reached.
    ///
    /// # Errors
    /// [`RunError`] where the scenario is impossible, or the source is not one of such a scenario.
    pub fn new(scenario: &Scenario, source: Source, window: usize) -> Result<Self, RunError> {
        let run = Run::from_source(scenario, source)?;
        Ok(Self { run, analysis: Analysis::default(), spare: Spare::default(), window: window.max(2) })
    }

    /// The run.
    pub fn run(&self) -> &Run {
        &self.run
    }

    /// Its analysis.
    pub fn analysis(&self) -> &Analysis {
        &self.analysis
    }

    /// Keeps no more than this many samples of a simulated run from now on.
    pub fn keep(&mut self, window: usize) {
        self.window = window.max(2);
    }

    /// Says what is to be computed beside the estimates from now on.
    pub fn want(&mut self, wanted: Wanted) {
        self.analysis.want(wanted);
    }

    /// Gives memory that is no longer needed back to the system, one piece after the other for as long as there is time; what
    /// the next edit needs is kept. Returns whether all is done.
    pub fn free(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        while self.analysis.free_one() {
            if !while_time() {
                return false;
            }
        }
        true
    }

    /// Lets all filters go on side by side until `samples` samples from the beginning are done, and the analysis with them.
    /// Asks after each little piece of work, of a millisecond or so, whether there is time for another. Returns whether all
    /// is done.
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
        let costs = scenario.filters.iter().map(|filter| cost::of_step(filter, scenario.plant.kind));
        let chunk = cost::chunk(cost::OF_RECORD + costs.sum::<f64>());
        let is_measured = matches!(run.source(), Source::Measured(_));
        while run.done() < samples.min(run.samples()) {
            let end = if is_measured { usize::MAX } else { run.record().forgotten().saturating_add(*window) };
            if run.done() >= end {
                // All of it has been analysed.
                run.forget(*window / 2);
                continue;
            }
            run.advance_to(samples.min(run.done() + chunk).min(end));
            if !analysis.advance(&Subject::of(run), while_time) || !while_time() {
                break;
            }
        }
        run.done() >= samples.min(run.samples()) && analysis.advance(&Subject::of(run), while_time)
    }
}
