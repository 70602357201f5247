//! The run of one cell in slices of time.

use std::sync::Arc;

use kalmanscope_core::Simulator;
use kalmanscope_core::score::ScoredPass;
use kalmanscope_core::{FirstCause, Record, RunError, Scenario, Task};

use crate::outcome::{HistoryPass, number_of, place_of_cause};
use crate::runner::{CellRun, Runner};

/// Limits the time between two checks of the clock on an ordinary processor \[ns\].
const PIECE: f64 = 1e6;

/// The time to simulate one sample of an ordinary plant, to within a factor of three \[ns\].
const OF_SAMPLE: f64 = 500.0;

/// The run of one cell, as far as it has come. Its row has the bits of [`Runner::rows`], into whatever slices the work
/// is divided.
pub struct CellTask {
    runner: Arc<Runner>,
    cell: usize,
    stage: Stage,
    row: Vec<f64>,
    /// The time since the last check of the clock, as estimated \[ns\].
    spent: f64,
}

enum Stage {
    Record {
        scenario: Scenario,
        simulator: Box<Simulator>,
        record: Record,
    },
    /// The filters run, the plan's `nth` one now.
    Filter {
        run: CellRun,
        nth: usize,
        pass: Option<FilterPass>,
    },
    /// The first cause of the verdict on the plan's `nth` filter is searched.
    Cause {
        run: CellRun,
        nth: usize,
        search: Box<FirstCause>,
    },
    Done,
}

/// The run of a filter: with all estimates if a measure needs them, or with sums alone.
enum FilterPass {
    History(Box<HistoryPass>),
    Sums(Box<ScoredPass>),
}

impl CellTask {
    /// The run of a cell before its first sample.
    pub fn new(runner: Arc<Runner>, cell: usize) -> Self {
        let row = vec![f64::NAN; runner.ensemble().width()];
        let scenario = runner.ensemble().at(cell);
        let stage = if scenario.validate().is_err() {
            Stage::Done
        } else if let Some(record) = runner.record_at_hand(cell, &scenario) {
            Stage::Filter { run: CellRun { scenario, record }, nth: 0, pass: None }
        } else {
            let simulator = Box::new(Simulator::new(&scenario));
            Stage::Record { record: simulator.empty_record(), scenario, simulator }
        };
        Self { runner, cell, stage, row, spent: 0.0 }
    }

    fn piece(&mut self) {
        self.stage = match std::mem::replace(&mut self.stage, Stage::Done) {
            Stage::Record { scenario, mut simulator, mut record } => {
                let samples = scenario.samples();
                let goal = samples.min(record.len() + self.samples_for(OF_SAMPLE));
                let begin = record.len();
                let goes_on = simulator.advance_some(&mut record, goal);
                // The simulation of a hard truth stops before its goal once its time is up.
                let is_slow = goes_on && record.len() < goal;
                self.spent += if is_slow { PIECE } else { OF_SAMPLE * (record.len() - begin) as f64 };
                if goes_on && record.len() < samples {
                    Stage::Record { scenario, simulator, record }
                } else {
                    let record = self.runner.keep(self.cell, record);
                    Stage::Filter { run: CellRun { scenario, record }, nth: 0, pass: None }
                }
            }
            Stage::Filter { run, nth, pass } => self.filter(run, nth, pass),
            Stage::Cause { run, nth, mut search } => {
                // It asks after each piece of about the same time.
                self.spent = PIECE;
                if search.advance(&mut || false) {
                    self.fill_cause(nth, *search);
                    self.after_history(run, nth)
                } else {
                    Stage::Cause { run, nth, search }
                }
            }
            Stage::Done => Stage::Done,
        };
    }

    /// The number of samples until the next check of the clock, if each takes `each` nanoseconds.
    fn samples_for(&self, each: f64) -> usize {
        ((PIECE - self.spent) / each).clamp(1.0, 1e5) as usize
    }

    fn filter(&mut self, run: CellRun, nth: usize, pass: Option<FilterPass>) -> Stage {
        let Some(&place) = self.runner.ensemble().plan().filters.get(nth) else { return Stage::Done };
        let first = || if self.runner.needs_history() { self.history(&run, place) } else { self.sums(&run, place) };
        let Ok(mut pass) = pass.map_or_else(first, Ok) else {
            return Stage::Filter { run, nth: nth + 1, pass: None };
        };
        let time = run.scenario.filters[place].time_of_step(&run.scenario);
        let goal = pass.done() + self.samples_for(time);
        let begin = pass.done();
        let is_done = pass.advance(&run.record, goal);
        self.spent += time * (pass.done() - begin) as f64;
        if !is_done {
            return Stage::Filter { run, nth, pass: Some(pass) };
        }
        let CellRun { scenario, record } = &run;
        match pass {
            FilterPass::History(pass) => {
                // The search for the first cause has its own slices.
                let mut measures = self.runner.ensemble().plan().measures.clone();
                let place_of_cause = place_of_cause(&measures);
                place_of_cause.map(|place| measures.remove(place));
                let mut scores = pass.measures(scenario, place, record, &measures);
                if let Some(place) = place_of_cause {
                    scores.insert(place, f64::NAN);
                }
                self.runner.fill_scores(nth, &scores, &mut self.row);
                if place_of_cause.is_some() {
                    let search = Box::new(pass.first_cause(scenario, place, record));
                    return Stage::Cause { run, nth, search };
                }
                return self.after_history(run, nth);
            }
            FilterPass::Sums(pass) => {
                let outcome = pass.outcome();
                if self.runner.needs_history() {
                    self.runner.ensemble().trace().fill(nth, &outcome.sample_scores, &mut self.row);
                } else {
                    self.runner.fill(nth, &run, &outcome, &mut self.row);
                }
            }
        }
        Stage::Filter { run, nth: nth + 1, pass: None }
    }

    /// After all estimates of the plan's `nth` filter: the looks at it. Without samples to look at, no second run is needed.
    fn after_history(&self, run: CellRun, nth: usize) -> Stage {
        let place = self.runner.ensemble().plan().filters[nth];
        let is_looked_at = !self.runner.ensemble().trace().samples().is_empty();
        let pass = if is_looked_at { self.sums(&run, place).ok() } else { None };
        Stage::Filter { run, nth: if pass.is_some() { nth } else { nth + 1 }, pass }
    }

    fn fill_cause(&mut self, nth: usize, search: FirstCause) {
        let measures = &self.runner.ensemble().plan().measures;
        if let Some(place) = place_of_cause(measures) {
            self.row[nth * measures.len() + place] = number_of(search);
        }
    }

    fn history(&self, CellRun { scenario, record }: &CellRun, place: usize) -> Result<FilterPass, RunError> {
        Ok(FilterPass::History(Box::new(HistoryPass::new(scenario, place, record)?)))
    }

    fn sums(&self, CellRun { scenario, record }: &CellRun, place: usize) -> Result<FilterPass, RunError> {
        let trace = self.runner.ensemble().trace();
        Ok(FilterPass::Sums(Box::new(ScoredPass::new(scenario, place, record, trace.samples())?)))
    }
}

impl Task for CellTask {
    type Outcome = Vec<f64>;

    fn progress(&self) -> f64 {
        let filters = self.runner.ensemble().plan().filters.len() as f64;
        match &self.stage {
            Stage::Record { .. } => 0.0,
            Stage::Filter { nth, .. } => *nth as f64 / filters,
            Stage::Cause { nth, search, .. } => (*nth as f64 + search.progress()) / filters,
            Stage::Done => 1.0,
        }
    }

    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        while !matches!(self.stage, Stage::Done) {
            self.piece();
            if self.spent >= PIECE {
                self.spent = 0.0;
                if !while_time() {
                    break;
                }
            }
        }
        matches!(self.stage, Stage::Done)
    }

    fn finish(self) -> Vec<f64> {
        self.row
    }
}

impl FilterPass {
    fn done(&self) -> usize {
        match self {
            Self::History(pass) => pass.done(),
            Self::Sums(pass) => pass.done(),
        }
    }

    fn advance(&mut self, record: &Record, samples: usize) -> bool {
        match self {
            Self::History(pass) => pass.advance(record, samples),
            Self::Sums(pass) => pass.advance(record, samples),
        }
    }
}

#[cfg(test)]
mod tests;
