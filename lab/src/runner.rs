//! The runs of an ensemble's cells.

use std::sync::{Arc, Mutex, PoisonError};

use kalmanscope_core::score::Outcome;
use kalmanscope_core::setting::RECORD_GAIN;
use kalmanscope_core::{Pass, Record, Scenario, Source, simulate};

use crate::ensemble::{Ensemble, EnsembleError, Plan};
use crate::outcome;

const KEPT: usize = 16;

/// The valid scenario of a cell, and its record.
#[derive(Clone, Debug)]
pub struct CellRun {
    /// The scenario.
    pub scenario: Scenario,
    /// The record: one for all cells that have the same.
    pub record: Arc<Record>,
}

/// Runs the cells of an ensemble, in any order and on any number of threads: a cell's row always has the same bits.
pub struct Runner {
    ensemble: Ensemble,
    source: Source,
    records: Mutex<Vec<(usize, Arc<Record>)>>,
}

impl Runner {
    /// A runner over simulated records, or over a given one.
    ///
    /// # Errors
    /// [`EnsembleError::Run`] where the given record does not fit the scenario, [`EnsembleError::Fixed`] where an axis would
    /// change a given record.
    pub fn new(ensemble: Ensemble, source: Source) -> Result<Self, EnsembleError> {
        if let Some(record) = source.record() {
            if let Some(key) = ensemble.first_that_changes_record() {
                return Err(EnsembleError::Fixed(key.to_owned()));
            }
            for &place in &ensemble.plan().filters {
                Pass::columns(ensemble.scenario(), place, record)?;
            }
        }
        Ok(Self { ensemble, source, records: Mutex::new(Vec::new()) })
    }

    /// The ensemble.
    pub fn ensemble(&self) -> &Ensemble {
        &self.ensemble
    }

    /// The source of the samples.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// The time that the filters of a cell take on an ordinary processor, to within a factor of three \[s\].
    pub fn time_of_cell(&self) -> f64 {
        let scenario = self.ensemble.scenario();
        let samples = self.source.record().map_or_else(|| scenario.samples(), |record| record.len());
        let time = |&place: &usize| scenario.filters[place].time_of_step(scenario);
        1e-9 * samples as f64 * self.ensemble.plan().filters.iter().map(time).sum::<f64>()
    }

    /// The rows of some cells, one after the other. The row of an impossible scenario is NaN. Lanes run the filters
    /// that they serve side by side, so a portion should have eight cells or more.
    pub fn rows(&self, cells: &[usize]) -> Vec<f64> {
        let runs = self.runs(cells);
        let outcomes: Vec<Vec<Option<Outcome>>> = if self.needs_history() {
            vec![Vec::new(); self.ensemble.plan().filters.len()]
        } else {
            let trace = self.ensemble.trace();
            self.ensemble.plan().filters.iter().map(|&place| outcomes_of(&runs, place, trace.samples())).collect()
        };
        self.rows_of(&runs, &outcomes)
    }

    /// The number of cells to compute at once: the number of lanes if lanes serve the filters of this cell, else one.
    pub fn at_once(&self, cell: usize) -> usize {
        let runs = self.runs(&[cell]);
        let is_served = |run: &CellRun| self.ensemble.plan().filters.iter().all(|&place| is_served(run, place));
        if !self.needs_history() && runs.iter().flatten().all(is_served) { ABREAST } else { 1 }
    }

    /// The runs of some cells; `None` for a cell with an impossible scenario.
    pub fn runs(&self, cells: &[usize]) -> Vec<Option<CellRun>> {
        // Cells with the same record come after each other, so that it is simulated once.
        let mut order: Vec<usize> = (0..cells.len()).collect();
        order.sort_by_key(|&at| self.ensemble.record_of(cells[at]));
        let mut runs = vec![None; cells.len()];
        for at in order {
            let scenario = self.ensemble.at(cells[at]);
            if scenario.validate().is_ok() {
                let record = self.record(cells[at], &scenario);
                runs[at] = Some(CellRun { scenario, record });
            }
        }
        runs
    }

    /// Whether the rows need every estimate of a run, not its outcome alone.
    pub fn needs_history(&self) -> bool {
        self.ensemble.plan().measures.iter().any(|measure| measure.info().needs_history())
    }

    /// The rows of some runs, from their outcomes: for each filter of the plan those of all runs. Missing outcomes are
    /// computed here; the others must have the looks at the plan's times.
    pub fn rows_of(&self, runs: &[Option<CellRun>], outcomes: &[Vec<Option<Outcome>>]) -> Vec<f64> {
        let width = self.ensemble.width();
        let mut rows = vec![f64::NAN; runs.len() * width];
        let plan = self.ensemble.plan();
        let trace = self.ensemble.trace();
        for (nth, (&place, outcomes)) in plan.filters.iter().zip(outcomes).enumerate() {
            for (at, (row, run)) in rows.chunks_mut(width).zip(runs).enumerate() {
                let Some(run) = run else { continue };
                let CellRun { scenario, record } = run;
                if let Some(outcome) = outcomes.get(at).and_then(Option::as_ref) {
                    self.fill(nth, run, outcome, row);
                } else if let Ok(scores) = outcome::any(scenario, place, record, &plan.measures) {
                    self.fill_scores(nth, &scores, row);
                    if !trace.samples().is_empty()
                        && let Ok(outcome) = Outcome::at(scenario, place, record, trace.samples())
                    {
                        trace.fill(nth, &outcome.sample_scores, row);
                    }
                }
            }
        }
        rows
    }

    /// The row of a run from the outcomes of all filters of the plan. Its scores must need no more than sums. The row
    /// of an impossible scenario is NaN.
    pub fn row_of_sums(&self, run: Option<&CellRun>, outcomes: &[&Outcome]) -> Vec<f64> {
        let mut row = vec![f64::NAN; self.ensemble.width()];
        if let Some(run) = run {
            for (nth, outcome) in outcomes.iter().enumerate() {
                self.fill(nth, run, outcome, &mut row);
            }
        }
        row
    }

    pub(crate) fn fill(&self, nth: usize, CellRun { scenario, record }: &CellRun, outcome: &Outcome, row: &mut [f64]) {
        let Plan { filters, measures, .. } = self.ensemble.plan();
        let scores = outcome::of_sums(scenario, filters[nth], record, measures, outcome);
        self.fill_scores(nth, &scores, row);
        self.ensemble.trace().fill(nth, &outcome.sample_scores, row);
    }

    /// On the input of a given record, which was imported with the gain of the ensemble's scenario.
    fn input_factor(&self, scenario: &Scenario) -> f64 {
        let [gain, own] = [scenario, self.ensemble.scenario()].map(RECORD_GAIN.get);
        if gain.is_nan() || own.is_nan() { 1.0 } else { gain / own }
    }

    fn record(&self, cell: usize, scenario: &Scenario) -> Arc<Record> {
        self.record_at_hand(cell, scenario).unwrap_or_else(|| self.keep(cell, simulate(scenario)))
    }

    pub(crate) fn record_at_hand(&self, cell: usize, scenario: &Scenario) -> Option<Arc<Record>> {
        let factor = self.input_factor(scenario);
        if let Some(record) = self.source.record()
            && factor == 1.0
        {
            return Some(Arc::clone(record));
        }
        let number = self.ensemble.record_of(cell);
        let records = self.records.lock().unwrap_or_else(PoisonError::into_inner);
        let kept = records.iter().find(|(other, _)| *other == number).map(|(_, record)| Arc::clone(record));
        drop(records);
        let of_given = |record: &Arc<Record>| self.keep(cell, Record::clone(record).with_input_times(factor));
        kept.or_else(|| self.source.record().map(of_given))
    }

    pub(crate) fn keep(&self, cell: usize, record: Record) -> Arc<Record> {
        let record = Arc::new(record);
        let mut records = self.records.lock().unwrap_or_else(PoisonError::into_inner);
        if records.len() >= KEPT {
            records.remove(0);
        }
        records.push((self.ensemble.record_of(cell), Arc::clone(&record)));
        record
    }

    pub(crate) fn fill_scores(&self, nth: usize, scores: &[f64], row: &mut [f64]) {
        let width = self.ensemble.plan().measures.len();
        row[nth * width..][..width].copy_from_slice(scores);
    }
}

#[cfg(feature = "lanes")]
const ABREAST: usize = kalmanscope_lanes::LANES;

#[cfg(not(feature = "lanes"))]
const ABREAST: usize = 1;

#[cfg(feature = "lanes")]
fn is_served(CellRun { scenario, record }: &CellRun, place: usize) -> bool {
    kalmanscope_lanes::serves(&kalmanscope_lanes::LaneRun { scenario, place, record }).is_ok_and(|is_served| is_served)
}

#[cfg(not(feature = "lanes"))]
fn is_served(_: &CellRun, _: usize) -> bool {
    false
}

/// The outcomes of the filter at a place of some possible runs, with looks at it at these samples.
#[cfg(feature = "lanes")]
pub fn outcomes_of(runs: &[Option<CellRun>], place: usize, samples: &[usize]) -> Vec<Option<Outcome>> {
    use kalmanscope_lanes::{LaneRun, Level, outcomes_with};
    let possible: Vec<_> =
        runs.iter().flatten().map(|CellRun { scenario, record }| LaneRun { scenario, place, record }).collect();
    let Ok(outcomes) = outcomes_with(Level::best(), &possible, samples) else { return vec![None; runs.len()] };
    let mut outcomes = outcomes.into_iter();
    runs.iter().map(|run| run.as_ref().and_then(|_| outcomes.next())).collect()
}

/// The outcomes of the filter at a place of some possible runs, with looks at it at these samples.
#[cfg(not(feature = "lanes"))]
pub fn outcomes_of(runs: &[Option<CellRun>], place: usize, samples: &[usize]) -> Vec<Option<Outcome>> {
    let one = |run: &CellRun| Outcome::at(&run.scenario, place, &run.record, samples).ok();
    runs.iter().map(|run| run.as_ref().and_then(one)).collect()
}

#[cfg(test)]
mod tests;
