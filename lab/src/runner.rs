//! The runs of an ensemble's cells, in one go or in slices of time.

use std::sync::{Arc, Mutex, PoisonError};

use kalmanscope_core::score::{Outcome, ScoredPass};
use kalmanscope_core::setting::RECORD_GAIN;
use kalmanscope_core::{Estimates, Pass, Record, Scenario, Simulator, Source, Task as _, Work, simulate};
use kalmanscope_diagnosis::{FirstCause, Measure, Observed, Times, Value, Whole};
use kalmanscope_lanes::{InstructionSet, LANES, LaneRun, outcomes, serves};
use kalmanscope_records::task::{Progress, at_once, pause};

use crate::ensemble::{Ensemble, EnsembleError, Plan};

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
    /// The source of the samples.
    pub source: Source,
    records: Mutex<Vec<(usize, Arc<Record>)>>,
}

impl Runner {
    /// A runner over simulated records, or over a given one.
    ///
    /// # Errors
    /// [`EnsembleError::Run`] where the record does not fit the scenario, [`EnsembleError::Fixed`] where an axis would change it.
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
        if self.needs_history() {
            let row = |&cell: &usize| at_once(self.row(cell, &Progress::default()));
            return cells.iter().flat_map(row).collect();
        }
        let runs = self.runs(cells);
        let (width, trace) = (self.ensemble.width(), self.ensemble.trace());
        let mut rows = vec![f64::NAN; runs.len() * width];
        for (nth, &place) in self.ensemble.plan().filters.iter().enumerate() {
            let outcomes = outcomes_of(&runs, place, trace.samples());
            for ((row, run), outcome) in rows.chunks_mut(width).zip(&runs).zip(&outcomes) {
                if let (Some(run), Some(outcome)) = (run, outcome) {
                    self.fill(nth, run, outcome, None, row);
                }
            }
        }
        rows
    }

    /// The number of cells to compute at once: the number of lanes if lanes serve the filters of this cell, else one.
    pub fn at_once(&self, cell: usize) -> usize {
        let runs = self.runs(&[cell]);
        let is_served = |CellRun { scenario, record }: &CellRun, place: usize| {
            serves(&LaneRun { scenario, place, record }).is_ok_and(|is_served| is_served)
        };
        let are_served = |run: &CellRun| self.ensemble.plan().filters.iter().all(|&place| is_served(run, place));
        if !self.needs_history() && runs.iter().flatten().all(are_served) { LANES } else { 1 }
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
                let record = self.record_at_hand(cells[at], &scenario);
                let record = record.unwrap_or_else(|| self.keep(cells[at], simulate(&scenario)));
                runs[at] = Some(CellRun { scenario, record });
            }
        }
        runs
    }

    /// Whether the rows need every estimate of a run, not its outcome alone.
    pub fn needs_history(&self) -> bool {
        self.ensemble.plan().measures.iter().any(|measure| measure.info().needs_history())
    }

    /// The row of a run from the outcomes of all filters, if scores need no more than sums; NaN for an impossible scenario.
    pub fn row_of_sums(&self, run: Option<&CellRun>, outcomes: &[&Outcome]) -> Vec<f64> {
        let mut row = vec![f64::NAN; self.ensemble.width()];
        if let Some(run) = run {
            for (nth, outcome) in outcomes.iter().enumerate() {
                self.fill(nth, run, outcome, None, &mut row);
            }
        }
        row
    }

    async fn row(&self, cell: usize, progress: &Progress) -> Vec<f64> {
        let (mut row, mut spent) = (vec![f64::NAN; self.ensemble.width()], Spent::default());
        let scenario = self.ensemble.at(cell);
        if scenario.validate().is_err() {
            return row;
        }
        let record = match self.record_at_hand(cell, &scenario) {
            Some(record) => record,
            None => self.keep(cell, simulated(&scenario, &mut spent).await),
        };
        let run = CellRun { scenario, record };
        let CellRun { scenario, record } = &run;
        let (trace, Plan { filters, measures, .. }) = (self.ensemble.trace(), self.ensemble.plan());
        let share = |filter: f64| progress.set(filter / filters.len() as f64);
        for (nth, &place) in filters.iter().enumerate() {
            share(nth as f64);
            let pass = ScoredPass::new(scenario, place, record, trace.samples(), self.needs_history());
            let Ok(mut pass) = pass else { continue };
            let time = scenario.filters[place].time_of_step(scenario);
            let mut is_done = false;
            while !is_done {
                let begin = pass.done();
                is_done = pass.advance(record, begin + spent.samples_left(time));
                spent.add(time * (pass.done() - begin) as f64).await;
            }
            let (outcome, history) = pass.finish();
            self.fill(nth, &run, &outcome, history.as_ref(), &mut row);
            let cause = measures.iter().position(|measure| *measure == Measure::CAUSE);
            if let (Some(estimates), Some(cause)) = (history, cause) {
                let mut search = FirstCause::new(scenario, place, &estimates, record);
                while !search.advance(&mut || false) {
                    share(nth as f64 + search.progress());
                    pause().await;
                }
                row[nth * measures.len() + cause] = Value::Cause(search.finish()).number();
            }
        }
        row
    }

    /// The first cause of a verdict is left out.
    fn fill(&self, nth: usize, run: &CellRun, outcome: &Outcome, history: Option<&Estimates>, row: &mut [f64]) {
        let Plan { filters, measures, .. } = self.ensemble.plan();
        let numbers = numbers(&run.scenario, filters[nth], &run.record, measures, (outcome, history));
        row[nth * measures.len()..][..measures.len()].copy_from_slice(&numbers);
        self.ensemble.trace().fill(nth, &outcome.sample_scores, row);
    }

    fn record_at_hand(&self, cell: usize, scenario: &Scenario) -> Option<Arc<Record>> {
        // A given record was imported with the gain of the ensemble's scenario.
        let [gain, own] = [scenario, self.ensemble.scenario()].map(RECORD_GAIN.get);
        let factor = if gain.is_nan() || own.is_nan() { 1.0 } else { gain / own };
        if let Some(record) = self.source.record()
            && factor == 1.0
        {
            return Some(Arc::clone(record));
        }
        let number = self.ensemble.record_of(cell);
        let records = self.records.lock().unwrap_or_else(PoisonError::into_inner);
        let kept = records.iter().find(|(other, _)| *other == number).map(|(_, record)| Arc::clone(record));
        // Before a record is made: to keep it takes the lock again.
        drop(records);
        let of_given = |record: &Arc<Record>| self.keep(cell, Record::clone(record).with_input_times(factor));
        kept.or_else(|| self.source.record().map(of_given))
    }

    fn keep(&self, cell: usize, record: Record) -> Arc<Record> {
        let record = Arc::new(record);
        let mut records = self.records.lock().unwrap_or_else(PoisonError::into_inner);
        if records.len() >= KEPT {
            records.remove(0);
        }
        records.push((self.ensemble.record_of(cell), Arc::clone(&record)));
        record
    }
}

/// The measures of a whole run; NaN where one is not known, or needs a history that is not there.
pub(crate) fn numbers(
    scenario: &Scenario,
    place: usize,
    record: &Record,
    measures: &[Measure],
    (outcome, history): (&Outcome, Option<&Estimates>),
) -> Vec<f64> {
    let model = scenario.filters[place].model(&scenario.plant.kind, scenario.input);
    let whole = Whole { record, outcome, channels: model.channels() };
    let observed = history.map(|estimates| Observed::new(scenario, place, record, estimates));
    let number = |measure: &Measure| match &observed {
        Some(_) if *measure == Measure::CAUSE => f64::NAN,
        Some(observed) if measure.info().needs_history() => measure.of(observed, Times::default()).number(),
        _ => measure.of_whole(&whole),
    };
    measures.iter().map(number).collect()
}

pub(crate) fn outcomes_of(runs: &[Option<CellRun>], place: usize, samples: &[usize]) -> Vec<Option<Outcome>> {
    let possible: Vec<_> =
        runs.iter().flatten().map(|CellRun { scenario, record }| LaneRun { scenario, place, record }).collect();
    if let Ok(outcomes) = outcomes(InstructionSet::best(), &possible, samples) {
        let mut outcomes = outcomes.into_iter();
        return runs.iter().map(|run| run.as_ref().and_then(|_| outcomes.next())).collect();
    }
    let one = |run: &CellRun| Outcome::at(&run.scenario, place, &run.record, samples).ok();
    runs.iter().map(|run| run.as_ref().and_then(one)).collect()
}

/// Limits the time between two checks of the clock on an ordinary processor \[ns\].
const PIECE: f64 = 1e6;

/// The time to simulate one sample of an ordinary plant, to within a factor of three \[ns\].
const OF_SAMPLE: f64 = 500.0;

/// The run of a cell, which pauses about every millisecond. However it is divided, its row has the bits of [`Runner::rows`].
pub fn cell_task(runner: Arc<Runner>, cell: usize) -> Work<Vec<f64>> {
    Work::new(move |progress| async move { runner.row(cell, &progress).await })
}

/// The time since the last pause \[ns\].
#[derive(Default)]
struct Spent(f64);

impl Spent {
    fn samples_left(&self, each: f64) -> usize {
        ((PIECE - self.0) / each).clamp(1.0, 1e5) as usize
    }

    async fn add(&mut self, time: f64) {
        self.0 += time;
        if self.0 >= PIECE {
            self.0 = 0.0;
            pause().await;
        }
    }
}

async fn simulated(scenario: &Scenario, spent: &mut Spent) -> Record {
    let mut simulator = Simulator::new(scenario);
    let (mut record, samples) = (simulator.empty_record(), scenario.samples());
    loop {
        let begin = record.len();
        let goal = samples.min(begin + spent.samples_left(OF_SAMPLE));
        let goes_on = simulator.advance_some(&mut record, goal);
        // The simulation of a hard truth stops before its goal once its time is up.
        let is_slow = goes_on && record.len() < goal;
        spent.add(if is_slow { PIECE } else { OF_SAMPLE * (record.len() - begin) as f64 }).await;
        if !goes_on || record.len() >= samples {
            return record;
        }
    }
}
