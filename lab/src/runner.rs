//! The runs of an ensemble's cells.

use std::sync::{Arc, Mutex, PoisonError};

use kalmanscope_core::score::Outcome;
use kalmanscope_core::simulate::Simulator;
use kalmanscope_core::{Pass, Record, Scenario, Source};

use crate::ensemble::{Ensemble, EnsembleError, Plan};
use crate::outcome;
use crate::setting::record_gain;

/// The records that are kept for the next cells.
const KEPT: usize = 16;

/// The scenario of a cell, which is possible, and its record.
#[derive(Clone, Debug)]
pub struct CellRun {
    /// The scenario.
    pub scenario: Scenario,
    /// The record: one for all cells that have the same.
    pub record: Arc<Record>,
}

/// Runs the cells of an ensemble, in any order and on any number of threads: a cell's row has the same bits always.
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
        if let Source::Measured(record) = &source {
            if let Some(setting) = ensemble.settings().iter().find(|setting| !setting.suits_given_record()) {
                return Err(EnsembleError::Fixed(setting.key().to_owned()));
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
        let samples = match &self.source {
            Source::Measured(record) => record.len(),
            Source::Simulated => scenario.samples(),
        };
        let time = |&place: &usize| scenario.filters[place].time_of_step(scenario.plant.kind);
        1e-9 * samples as f64 * self.ensemble.plan().filters.iter().map(time).sum::<f64>()
    }

    /// The rows of some cells, one after the other. The row of an impossible scenario is NaN. Filters that lanes serve go
    /// side by side, so a portion should have eight cells or more.
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

    /// The number of cells that are best computed at once: where lanes take the filters of this cell, as many as run side by
    /// side in the time of one or two, else one.
    pub fn at_once(&self, cell: usize) -> usize {
        let runs = self.runs(&[cell]);
        let is_served = |run: &CellRun| self.ensemble.plan().filters.iter().all(|&place| is_served(run, place));
        if !self.needs_history() && runs.iter().flatten().all(is_served) { ABREAST } else { 1 }
    }

    /// The runs of some cells; none where a scenario is impossible.
    pub fn runs(&self, cells: &[usize]) -> Vec<Option<CellRun>> {
        // Those with one record after each other, so that it is simulated once.
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
        self.ensemble.plan().measures.iter().any(|measure| measure.needs_history())
    }

    /// The rows of some runs, from their outcomes: for each filter of the plan those of all runs. An outcome that is missing is
    /// computed here; the others have the looks that the plan's times ask for.
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
                    // To look at nothing needs no second run.
                    if !trace.samples().is_empty()
                        && let Ok(outcome) = Outcome::at(scenario, place, record, trace.samples())
                    {
                        trace.fill(nth, &outcome.looks, row);
                    }
                }
            }
        }
        rows
    }

    /// The row of a run from the outcomes of all filters of the plan, whose scores need no more than sums. The row of an
    /// impossible scenario is NaN.
    pub fn row_of_sums(&self, run: Option<&CellRun>, outcomes: &[&Outcome]) -> Vec<f64> {
        let mut row = vec![f64::NAN; self.ensemble.width()];
        if let Some(run) = run {
            for (nth, outcome) in outcomes.iter().enumerate() {
                self.fill(nth, run, outcome, &mut row);
            }
        }
        row
    }

    /// Writes what the outcome of the plan's `nth` filter says into the row of a run.
    pub(crate) fn fill(&self, nth: usize, CellRun { scenario, record }: &CellRun, outcome: &Outcome, row: &mut [f64]) {
        let Plan { filters, measures, .. } = self.ensemble.plan();
        let scores = outcome::of_sums(scenario, filters[nth], record, measures, outcome);
        self.fill_scores(nth, &scores, row);
        self.ensemble.trace().fill(nth, &outcome.looks, row);
    }

    /// The factor on the input of a given record in a scenario: it was imported with the gain of the ensemble's scenario.
    fn input_factor(&self, scenario: &Scenario) -> f64 {
        let own = record_gain(self.ensemble.scenario());
        record_gain(scenario).zip(own).map_or(1.0, |(gain, own)| gain / own)
    }

    /// The record of a cell with this scenario, which is possible.
    fn record(&self, cell: usize, scenario: &Scenario) -> Arc<Record> {
        self.record_at_hand(cell, scenario).unwrap_or_else(|| self.keep(cell, simulate(scenario)))
    }

    /// The same, unless it is yet to be simulated.
    pub(crate) fn record_at_hand(&self, cell: usize, scenario: &Scenario) -> Option<Arc<Record>> {
        let factor = self.input_factor(scenario);
        if let Source::Measured(record) = &self.source
            && factor == 1.0
        {
            return Some(Arc::clone(record));
        }
        let number = self.ensemble.record_of(cell);
        let records = self.records.lock().unwrap_or_else(PoisonError::into_inner);
        let kept = records.iter().find(|(other, _)| *other == number).map(|(_, record)| Arc::clone(record));
        drop(records);
        match &self.source {
            Source::Measured(record) => {
                kept.or_else(|| Some(self.keep(cell, Record::clone(record).with_input_times(factor))))
            }
            Source::Simulated => kept,
        }
    }

    /// Keeps the record of a cell for the next ones.
    pub(crate) fn keep(&self, cell: usize, record: Record) -> Arc<Record> {
        let record = Arc::new(record);
        let mut records = self.records.lock().unwrap_or_else(PoisonError::into_inner);
        if records.len() >= KEPT {
            records.remove(0);
        }
        records.push((self.ensemble.record_of(cell), Arc::clone(&record)));
        record
    }

    /// Writes what the history of the plan's `nth` filter says into the row of a run.
    pub(crate) fn fill_scores(&self, nth: usize, scores: &[f64], row: &mut [f64]) {
        let width = self.ensemble.plan().measures.len();
        row[nth * width..][..width].copy_from_slice(scores);
    }
}

/// The runs that go side by side.
#[cfg(feature = "lanes")]
const ABREAST: usize = kalmanscope_lanes::LANES;

/// The runs that go side by side.
#[cfg(not(feature = "lanes"))]
const ABREAST: usize = 1;

/// Whether lanes take the filter at a place of a run.
#[cfg(feature = "lanes")]
fn is_served(CellRun { scenario, record }: &CellRun, place: usize) -> bool {
    kalmanscope_lanes::serves(&kalmanscope_lanes::LaneRun { scenario, place, record }).is_ok_and(|is_served| is_served)
}

/// Whether lanes take the filter at a place of a run.
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

/// The record of a possible scenario, as far as its truth goes.
pub fn simulate(scenario: &Scenario) -> Record {
    let mut simulator = Simulator::new(scenario);
    let mut record = simulator.empty_record();
    for _ in 0..scenario.samples() {
        if !simulator.step(&mut record) {
            break;
        }
    }
    record
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Measure, Plan};
    use kalmanscope_core::diagnostics::MeanSquare;
    use kalmanscope_core::{Channel, Diagnostics, Run, RunError};

    fn runner(axes: &[&str], measures: &[&str]) -> Runner {
        let scenario = Scenario { duration: 5.0, ..Scenario::default() };
        let axes = axes.iter().map(|text| Axis::parse(text).unwrap()).collect();
        let measures = measures.iter().map(|text| text.parse().unwrap()).collect();
        let ensemble =
            Ensemble::new(scenario, Plan { filters: vec![0, 1], measures, axes, ..Plan::default() }).unwrap();
        Runner::new(ensemble, Source::Simulated).unwrap()
    }

    #[test]
    fn a_row_has_the_numbers_of_the_run_on_a_screen() {
        let channel = Channel::NATURAL_FREQUENCY;
        let runner = runner(
            &["seed=3:5:3", "filters.*.initial_mean.natural_frequency=2:14:4"],
            &["nis", "nees", "log_likelihood", "rmse.natural_frequency", "estimate.natural_frequency", "diverged"],
        );
        for cell in 0..12 {
            let row = runner.rows(&[cell]);
            let mut run = Run::new(&runner.ensemble().at(cell)).unwrap();
            run.finish();
            for (estimates, row) in run.estimates().iter().zip(row.chunks(6)) {
                let diagnostics = Diagnostics::new(estimates, run.record());
                let place = estimates.place(channel).unwrap();
                let expected = [
                    per_degree(&diagnostics.mean_nis().unwrap()),
                    per_degree(&diagnostics.mean_nees().unwrap()),
                    diagnostics.log_likelihood(),
                    diagnostics.tally(channel, 0..estimates.len()).unwrap().rmse(),
                    estimates.canonical_mean(estimates.len() - 1, place),
                ];
                for (number, expected) in row.iter().zip(expected) {
                    assert!((number - expected).abs() <= 1e-12 * expected.abs(), "{row:?}: {expected}");
                }
            }
        }
    }

    #[test]
    fn a_cell_takes_the_time_of_its_filters_over_all_samples() {
        let of = |axes: &[&str]| runner(axes, &["nis"]).time_of_cell();
        let (short, many) = (of(&["seed=1:4:4"]), of(&["seed=1:9:9"]));
        assert_eq!(short, many, "a cell has no share in the others");
        // 501 samples, an EKF and a UKF.
        assert!((1e-4..3e-3).contains(&short), "{short}");
    }

    fn per_degree(mean: &MeanSquare) -> f64 {
        mean.mean / mean.expected
    }

    #[test]
    fn rows_do_not_depend_on_their_order() {
        let runner = runner(&["seed=1:4:4", "filters.EKF.process_std=0.1:10:5:log"], &["nis", "error.damping_ratio"]);
        let width = runner.ensemble().width();
        let all = runner.rows(&(0..20).collect::<Vec<_>>());
        for cell in [19, 0, 7, 12, 3] {
            assert_eq!(runner.rows(&[cell]), all[cell * width..(cell + 1) * width]);
        }
    }

    /// Numbers of the single filter, cell by cell, are those of [`Runner::rows`], bit by bit.
    #[cfg(feature = "lanes")]
    #[test]
    fn a_map_of_the_duffing_oscillator_is_served_by_lanes_and_has_the_numbers_of_the_single_filter() {
        let mut scenario = Scenario { duration: 5.0, ..Scenario::default() };
        scenario.set_plant(kalmanscope_core::PlantKind::DUFFING);
        let axes = ["seed=1:2:2", "filters.*.initial_mean.natural_frequency=3:9:6"];
        let axes = axes.iter().map(|text| Axis::parse(text).unwrap()).collect();
        let measures = vec![Measure::Nis, Measure::Nees, "estimate.cubic_stiffness".parse().unwrap()];
        let plan = Plan { filters: vec![0, 1], measures, axes, ..Plan::default() };
        let runner = Runner::new(Ensemble::new(scenario, plan).unwrap(), Source::Simulated).unwrap();
        let cells: Vec<usize> = (0..12).collect();
        let runs = runner.runs(&cells);
        for CellRun { scenario, record } in runs.iter().flatten() {
            let is_served = |place| kalmanscope_lanes::serves(&kalmanscope_lanes::LaneRun { scenario, place, record });
            assert!(is_served(0).unwrap() && is_served(1).unwrap());
        }
        let single = runner.rows_of(&runs, &[vec![], vec![]]);
        assert!(single.iter().all(|number| number.is_finite()), "{single:?}");
        assert_eq!(runner.rows(&cells), single);
    }

    /// The scenario of a measured record: a gain of the input, which is linear between samples.
    fn measured() -> Scenario {
        let mut scenario = Scenario { duration: 5.0, hold: kalmanscope_core::Hold::First, ..Scenario::default() };
        scenario.filters.iter_mut().for_each(|filter| filter.augment = vec![Channel::INPUT_GAIN]);
        scenario
    }

    #[test]
    fn the_row_of_a_cell_does_not_depend_on_those_beside_it() {
        let axes = vec![Axis::parse("filters.*.initial_mean.natural_frequency=3:9:11").unwrap()];
        let measures = vec![Measure::Nis, Measure::LogLikelihood, "estimate.input_gain".parse().unwrap()];
        let plan = Plan { filters: vec![0, 1], measures, axes, ..Plan::default() };
        let runner = Runner::new(Ensemble::new(measured(), plan).unwrap(), Source::Simulated).unwrap();
        let all = runner.rows(&(0..11).collect::<Vec<_>>());
        let single = runner.rows_of(&runner.runs(&(0..11).collect::<Vec<_>>()), &[vec![], vec![]]);
        for cell in 0..11 {
            assert_eq!(runner.rows(&[cell]), all[6 * cell..6 * cell + 6]);
            // That of the filter by itself, to rounding.
            for (number, single) in all[6 * cell..].iter().zip(&single[6 * cell..6 * cell + 6]) {
                assert!((number - single).abs() < 1e-9 * single.abs(), "{number} and {single}");
            }
        }
    }

    #[cfg(feature = "lanes")]
    #[test]
    fn cells_that_lanes_take_are_computed_together() {
        let at_once = |scenario: Scenario, measure: Measure| {
            let plan = Plan { filters: vec![0], measures: vec![measure], ..Plan::default() };
            Runner::new(Ensemble::new(scenario, plan).unwrap(), Source::Simulated).unwrap().at_once(0)
        };
        let alone = |kind| {
            let mut scenario = measured();
            scenario.filters[0].kind = kind;
            scenario
        };
        assert_eq!(at_once(measured(), Measure::Nis), 8);
        assert_eq!(at_once(Scenario { duration: 5.0, ..Scenario::default() }, Measure::Nis), 8);
        assert_eq!(at_once(measured(), Measure::Verdict), 1);
        assert_eq!(at_once(alone(kalmanscope_core::FilterKind::SR_UKF), Measure::Nis), 1);
    }

    #[test]
    fn the_row_of_an_impossible_scenario_is_empty() {
        let runner = runner(&["filters.EKF.fading=0.5:1.5:3"], &["nis"]);
        let rows = runner.rows(&[0, 1, 2]);
        assert!(rows[..2].iter().all(|number| number.is_nan()) && rows[2..].iter().all(|number| number.is_finite()));
    }

    #[test]
    fn measures_of_histories_are_those_of_the_screen() {
        let runner =
            runner(&["filters.*.sensor_std=0.1:10:3:log"], &["verdict", "free_run.velocity", "one_step.velocity"]);
        let rows = runner.rows(&[0, 1, 2]);
        let (verdict, free_run, one_step) = (rows[6], rows[7], rows[8]);
        assert!(verdict >= 0.0 && free_run > 0.0 && (0.05..0.2).contains(&one_step), "{rows:?}");
    }

    #[test]
    fn a_given_record_stays_as_it_is() {
        let scenario = Scenario { duration: 5.0, ..Scenario::default() };
        let record = Arc::new(simulate(&scenario));
        let plan = |key: &str| {
            let axes = vec![Axis::parse(&format!("{key}=1:2:2")).unwrap()];
            Plan { filters: vec![0], measures: vec![Measure::Nis], axes, ..Plan::default() }
        };
        let runner = |key: &str, scenario: &Scenario| {
            let ensemble = Ensemble::new(scenario.clone(), plan(key)).unwrap();
            Runner::new(ensemble, Source::Measured(Arc::clone(&record)))
        };
        assert!(runner("filters.EKF.process_std", &scenario).is_ok());
        let refused = runner("seed", &scenario).err().unwrap();
        assert!(refused.to_string().contains("`seed`"), "{refused}");
        let mut other = scenario;
        other.remove_sensor(kalmanscope_core::Quantity::VELOCITY);
        other.add_sensor(kalmanscope_core::Sensor {
            measures: kalmanscope_core::Quantity::ACCELERATION,
            noise_std: 0.1,
        });
        let refused = runner("filters.EKF.process_std", &other).err().unwrap();
        assert!(matches!(refused, EnsembleError::Run(RunError::MissingSensor(_))));
    }

    #[test]
    fn a_given_record_follows_the_gain_of_its_input() {
        let mapping = "file = \"a.csv\"\n[time]\nrate = 100.0\n[input]\ncolumn = \"u\"\ngain = 2.0\n";
        let mapping = format!("{mapping}[sensors.displacement]\ncolumn = \"x\"\n[sensors.velocity]\ncolumn = \"v\"\n");
        let mapping = kalmanscope_core::import::Mapping::from_toml(&mapping).unwrap();
        let scenario = Scenario { duration: 5.0, ..Scenario::default() };
        let record = Arc::new(simulate(&scenario));
        let scenario = Scenario { record: Some(mapping), ..scenario };
        let axes = vec![Axis::parse("record.input.gain=1:3:3").unwrap()];
        let plan = Plan { filters: vec![0], measures: vec![Measure::Nis], axes, ..Plan::default() };
        let source = Source::Measured(Arc::clone(&record));
        let runner = Runner::new(Ensemble::new(scenario, plan).unwrap(), source).unwrap();
        let runs = runner.runs(&[0, 1, 2]);
        for (run, factor) in runs.iter().zip([0.5, 1.0, 1.5]) {
            let input: Vec<f64> = record.input().iter().map(|u| factor * u).collect();
            assert_eq!(run.as_ref().unwrap().record.input(), input);
        }
        let nis = runner.rows(&[0, 1, 2]);
        assert!(nis[1] < nis[0] && nis[1] < nis[2], "the gain that the record has: {nis:?}");
    }
}
