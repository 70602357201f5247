//! The statistics of the scenario over many seeds.
//!
//! ```text
//! Session ──scenario──▶ SeedRuns ──seeds──▶ Team ──rows──▶ MonteCarlo ──▶ view
//! ```
//! Rows are taken into the statistics as they come and are not kept. The earlier statistics stay on screen until those
//! of another scenario have enough seeds.

#[cfg(test)]
mod tests;

use std::fmt::Write as _;
use std::ops::RangeInclusive;
use std::rc::Rc;
use std::sync::Arc;

use egui::Context;
use kalmanscope_core::{Channel, Run, Scenario, Source};
use kalmanscope_lab::{Ensemble, MonteCarlo, RunVerdicts, Runner, Slice};
use serde::{Deserialize, Serialize};

use super::WorkState;
use super::choice::{is_same_but_for_names, part_of};
use super::survey::quoted;
use crate::team::{CellBatch, Dispatch, Precision, Priority, Team};

pub const SEEDS: RangeInclusive<usize> = 10..=10_000;

/// The initial number of seeds: fewer on the page, where a run takes longer.
const USUAL: usize = if cfg!(target_arch = "wasm32") { 100 } else { 200 };

const TIMES: usize = 60;

const ENOUGH: usize = 10;

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeedChoice {
    pub seeds: usize,
    /// The parameter to show errors and estimates of. `None` for the first one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parameter: Option<Channel>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub verdicts: bool,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub causes: bool,
}

impl Default for SeedChoice {
    fn default() -> Self {
        Self { seeds: USUAL, parameter: None, verdicts: false, causes: false }
    }
}

impl SeedChoice {
    fn judged(&self) -> RunVerdicts {
        match (self.verdicts, self.causes) {
            (_, true) => RunVerdicts::Causes,
            (true, false) => RunVerdicts::Verdicts,
            (false, false) => RunVerdicts::Not,
        }
    }

    pub fn check(&self) -> Result<(), String> {
        let (least, most) = (SEEDS.start(), SEEDS.end());
        if SEEDS.contains(&self.seeds) {
            Ok(())
        } else {
            Err(format!("it has {} seeds, but must have {least} to {most}", self.seeds))
        }
    }
}

pub struct SeedRuns {
    ensemble: Ensemble,
    judged: RunVerdicts,
    pub filters: Vec<u32>,
    pub statistics: MonteCarlo,
    known: Vec<bool>,
    work: Option<Dispatch>,
}

impl SeedRuns {
    fn new(scenario: &Scenario, filters: &[u32], choice: &SeedChoice) -> Result<Self, String> {
        let (seeds, judged) = (choice.seeds, choice.judged());
        let places = (0..filters.len()).collect();
        let ensemble = MonteCarlo::ensemble(bare(scenario, filters), places, seeds, TIMES, judged);
        let ensemble = ensemble.map_err(|error| error.to_string())?;
        let statistics = MonteCarlo::new(&ensemble);
        Ok(Self { ensemble, judged, filters: filters.to_vec(), statistics, known: vec![false; seeds], work: None })
    }

    pub fn scenario(&self) -> &Scenario {
        self.ensemble.scenario()
    }

    pub fn seeds(&self) -> usize {
        self.known.len()
    }

    fn is_complete(&self) -> bool {
        self.statistics.done() >= self.seeds()
    }

    fn is_of(&self, scenario: &Scenario, filters: &[u32]) -> bool {
        self.filters == filters && is_same_but_for_names(self.scenario(), &bare(scenario, filters))
    }

    fn continue_from(&mut self, before: &Self) {
        let is_same = before.is_of(self.scenario(), &self.filters) && before.judged == self.judged;
        if is_same && before.seeds() <= self.seeds() {
            self.statistics = before.statistics.clone();
            self.known[..before.seeds()].copy_from_slice(&before.known);
        }
    }

    fn follow(&mut self, team: &Rc<dyn Team>, ctx: &Context) -> Result<bool, String> {
        if self.is_complete() {
            self.work = None;
            return Ok(false);
        }
        let Self { ensemble, statistics, known, work, .. } = self;
        let work = match work {
            Some(work) => work,
            none => {
                let order = (0..known.len()).filter(|seed| !known[*seed]).collect();
                let runner = Runner::new(ensemble.clone(), Source::Simulated).map_err(|error| error.to_string())?;
                let (precision, priority) = (Precision::Double, Priority::Seeds);
                none.insert(Dispatch::new(
                    team,
                    CellBatch { runner: Arc::new(runner), order, precision, priority },
                    ctx,
                ))
            }
        };
        let rows = work.take();
        let has_come = !rows.is_empty();
        for rows in rows {
            rows.cells.iter().for_each(|cell| known[*cell] = true);
            statistics.take(ensemble, &Slice { cells: rows.cells, rows: rows.numbers });
        }
        Ok(has_come)
    }
}

fn bare(scenario: &Scenario, filters: &[u32]) -> Scenario {
    // Each run sets its own seed: another one of the scenario must not begin the statistics again.
    Scenario { seed: 0, ..part_of(scenario, filters) }
}

#[derive(Default)]
pub struct Seeds {
    pub choice: SeedChoice,
    runs: Option<SeedRuns>,
    before: Option<SeedRuns>,
    /// Its number changes while seeds come in, whenever there are 5 % more.
    pub state: WorkState,
    counted: usize,
}

impl Seeds {
    pub fn choose(&mut self, choice: SeedChoice) {
        self.choice = choice;
        self.state.is_stopped = false;
    }

    pub fn shown(&self) -> Option<&SeedRuns> {
        self.before.as_ref().or(self.runs.as_ref()).filter(|runs| runs.statistics.done() > 0)
    }

    pub fn is_shown_old(&self) -> bool {
        self.before.is_some()
    }

    pub fn progress(&self) -> Option<[usize; 2]> {
        let runs = self.runs.as_ref().filter(|runs| !runs.is_complete())?;
        Some([runs.statistics.done(), runs.seeds()])
    }

    pub fn is_working(&self) -> bool {
        self.runs.as_ref().is_some_and(|runs| runs.work.is_some())
    }

    pub fn set_stopped(&mut self, stopped: bool) -> bool {
        let changes = self.state.set_stopped(stopped, self.progress().is_some());
        if changes {
            self.rest();
        }
        changes
    }

    pub(super) fn follow(&mut self, run: &Run, filters: &[u32], team: Option<&Rc<dyn Team>>, ctx: &Context) {
        if let Some(problem) = problem(run, filters) {
            self.forget(problem);
            return;
        }
        let (scenario, seeds, judged) = (run.scenario(), self.choice.seeds, self.choice.judged());
        let is_it = |runs: &SeedRuns| runs.seeds() == seeds && runs.judged == judged && runs.is_of(scenario, filters);
        if !self.runs.as_ref().is_some_and(is_it) {
            match SeedRuns::new(scenario, filters, &self.choice) {
                Ok(next) => self.begin(next),
                Err(problem) => return self.forget(format!("There are no statistics: {problem}.")),
            }
        }
        for runs in [&mut self.runs, &mut self.before].into_iter().flatten() {
            runs.ensemble.call_filters(scenario);
        }
        match team.filter(|_| !self.state.is_stopped) {
            Some(team) => self.work(team, ctx),
            None => self.rest(),
        }
    }

    pub(super) fn rest(&mut self) {
        self.runs.iter_mut().for_each(|runs| runs.work = None);
    }

    fn forget(&mut self, problem: String) {
        (self.runs, self.before) = (None, None);
        self.state.fail(problem);
    }

    fn begin(&mut self, mut next: SeedRuns) {
        self.state.begin();
        self.rest();
        if let Some(last) = self.runs.take() {
            next.continue_from(&last);
            if last.statistics.done() >= ENOUGH {
                self.before = Some(last);
            }
        }
        self.runs = Some(next);
        self.show_new();
    }

    fn work(&mut self, team: &Rc<dyn Team>, ctx: &Context) {
        let Some(runs) = &mut self.runs else { return };
        match runs.follow(team, ctx) {
            Ok(true) => self.show_new(),
            Ok(false) => {}
            Err(problem) => self.forget(format!("There are no statistics: {problem}.")),
        }
    }

    fn show_new(&mut self) {
        let Some(runs) = &self.runs else { return };
        let done = runs.statistics.done();
        let is_enough = done >= ENOUGH.min(runs.seeds());
        if is_enough && self.before.take().is_some() {
            self.counted = 0;
        }
        if self.before.is_none()
            && (done < self.counted || runs.is_complete() || done > self.counted + self.counted / 20)
        {
            self.state.version += 1;
            self.counted = done;
        }
    }
}

fn problem(run: &Run, filters: &[u32]) -> Option<String> {
    if run.source().is_measured() {
        let sentence = "This record is measured, and there is only one of it. Monte Carlo simulates the scenario anew for each seed.";
        return Some(sentence.to_owned());
    }
    if filters.is_empty() {
        return Some("No filter is shown.".to_owned());
    }
    let samples = run.samples();
    let is_long = samples > crate::session::Session::LONGEST_WHOLE + 1;
    is_long.then(|| format!("The record has {samples} samples: too many to run it for every seed."))
}

const SHARES: [f64; 3] = [0.025, 0.5, 0.975];

impl SeedRuns {
    pub fn to_csv(&self) -> String {
        let (scenario, statistics) = (self.scenario(), &self.statistics);
        let channels = kalmanscope_lab::channels(self.ensemble.scenario(), &self.ensemble.plan().filters);
        let mut text = "filter,t,seeds,mean_nees,mean_nis".to_owned();
        for channel in &channels {
            for column in ["error_2.5", "error_50", "error_97.5", "rmse", "std"] {
                // Writing to a string cannot fail.
                let _ = write!(text, ",{}.{column}", channel.key());
            }
        }
        text.push('\n');
        for (nth, filter) in scenario.filters.iter().enumerate() {
            let columns: Vec<Option<Vec<[f64; 5]>>> = channels
                .iter()
                .map(|channel| {
                    let at = statistics.channels(nth).iter().position(|other| other == channel)?;
                    let quantiles = statistics.quantiles(nth, at, SHARES).into_iter();
                    let both = statistics.rmse(nth, at).zip(statistics.std(nth, at));
                    Some(quantiles.zip(both).map(|([a, b, c], (rmse, std))| [a, b, c, rmse, std]).collect())
                })
                .collect();
            let squares = statistics.nees(nth).zip(statistics.nis(nth));
            for (time, (sample, (nees, nis))) in statistics.samples().iter().zip(squares).enumerate() {
                let t = *sample as f64 * scenario.dt;
                let _ = write!(text, "{},{t},{}", quoted(&filter.name), statistics.done());
                let of_channels = columns.iter().flat_map(|column| match column {
                    Some(rows) => rows[time],
                    None => [f64::NAN; 5],
                });
                for number in [nees, nis].into_iter().chain(of_channels) {
                    let _ = if number.is_nan() { write!(text, ",") } else { write!(text, ",{number}") };
                }
                text.push('\n');
            }
        }
        text
    }
}
