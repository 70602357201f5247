//! Tuning: the best values of some settings of one filter.

mod cost;
mod information;

use std::sync::Arc;

use argmin::core::{IterState, Problem, Solver, State as _, TerminationStatus};
use argmin::solver::neldermead::NelderMead;
use kalmanscope_core::{Axis, Measure, Quantity, Record, Scenario, Task, VerdictKind};
use serde::{Deserialize, Serialize};

use crate::EnsembleError;

pub use information::Remark;

use cost::{Cost, Objective, Point};
use information::Information;

/// The number of values of a setting that are tried first, along its axis.
const SCAN: usize = 9;

const ITERATIONS: u64 = 300;

/// The size of the first simplex, as a share of each axis.
const SIMPLEX: f64 = 0.08;

/// The search ends when the scores of the simplex differ by less than this, relative to their size or absolutely.
const TOLERANCE: f64 = 1e-7;

/// A search for the settings of a filter with the best score, in small portions: first along each axis alone, then by the
/// method of Nelder and Mead.
///
/// Source: Nelder and Mead (1965), A simplex method for function minimization.
pub struct Tuner {
    cost: Arc<Cost>,
    stage: Stage,
    best: Vec<f64>,
    path: Vec<Try>,
    bands: Option<Vec<[f64; 2]>>,
    runs: u64,
}

enum Stage {
    /// The axis, and the place on it, to try next.
    Scanning(usize, usize),
    Searching(Box<Search>),
    Looking(Box<Information>),
    Done,
}

struct Search {
    solver: NelderMead<Point, f64>,
    problem: Problem<Objective>,
    state: Option<IterState<Point, (), (), (), (), f64>>,
    iterations: u64,
}

/// A try that was better than all before.
#[derive(Clone, Debug, PartialEq)]
pub struct Try {
    /// The settings' values.
    pub values: Vec<f64>,
    /// The goal's number; more is better.
    pub score: f64,
}

/// The result of a search.
#[derive(Clone, Debug)]
pub struct Tuned {
    /// The scenario with the best values.
    pub scenario: Scenario,
    /// Each try that was better than all before; the scenario's own values come first.
    pub path: Vec<Try>,
    /// The values two standard deviations below and above the best one of each setting, by the curvature of the likelihood; `None` for
    /// another goal, and where the likelihood has no maximum there.
    pub bands: Option<Vec<[f64; 2]>>,
    /// The verdict on the tuned filter, if there are enough measurements for one.
    pub verdict: Option<VerdictKind>,
    /// Warnings about the result.
    pub remarks: Vec<Remark>,
    /// The number of runs that it took.
    pub runs: u64,
}

impl Tuner {
    /// A search over the given axes for the filter at `place`, from the scenario's present values on. The axes' counts have
    /// no effect.
    ///
    /// # Errors
    /// [`EnsembleError`] where an axis is impossible or varies no number of a filter, or the record does not fit.
    pub fn new(
        scenario: Scenario,
        place: usize,
        record: Arc<Record>,
        axes: Vec<Axis>,
        goal: Goal,
    ) -> Result<Self, EnsembleError> {
        let cost = Arc::new(Cost::new(scenario, place, record, axes, goal)?);
        let best = cost.present();
        // The present values count even if they are beyond an axis.
        let path = vec![Try { values: cost.present_values(), score: -cost.of_scenario(&cost.scenario) }];
        Ok(Self { cost, stage: Stage::Scanning(0, 0), best, path, bands: None, runs: 1 })
    }

    /// Tries these values of the settings before the search, one an axis, such as the best ones of a map. Values beyond an axis
    /// count as its nearest end.
    pub fn try_values(&mut self, values: &[f64]) {
        let share = |(axis, &value): (&Axis, &f64)| {
            let share = axis.share_of(value);
            if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) }
        };
        let shares: Vec<f64> = self.cost.axes.iter().zip(values).map(share).collect();
        if shares.len() == self.best.len() {
            let cost = self.cost.of(&shares);
            self.runs += 1;
            self.keep(&shares, cost);
        }
    }

    /// Each try that was better than all before; the scenario's own values come first.
    pub fn path(&self) -> &[Try] {
        &self.path
    }

    fn scan(&mut self, axis: usize, place: usize) -> Stage {
        if axis >= self.cost.axes.len() {
            return self.begin_search();
        }
        let mut shares = self.best.clone();
        shares[axis] = place as f64 / (SCAN - 1) as f64;
        let cost = self.cost.of(&shares);
        self.runs += 1;
        self.keep(&shares, cost);
        if place + 1 < SCAN { Stage::Scanning(axis, place + 1) } else { Stage::Scanning(axis + 1, 0) }
    }

    fn begin_search(&mut self) -> Stage {
        if self.best.is_empty() {
            return Stage::Done;
        }
        let mut simplex = vec![Point(self.best.clone())];
        for axis in 0..self.best.len() {
            let mut corner = self.best.clone();
            corner[axis] += if corner[axis] > 0.5 { -SIMPLEX } else { SIMPLEX };
            simplex.push(Point(corner));
        }
        let mut solver = NelderMead::new(simplex);
        let mut problem = Problem::new(Objective(Arc::clone(&self.cost)));
        match solver.init(&mut problem, IterState::new()) {
            Ok((state, _)) => Stage::Searching(Box::new(Search { solver, problem, state: Some(state), iterations: 0 })),
            Err(_) => Stage::Done,
        }
    }

    fn search(&mut self, mut search: Box<Search>) -> Stage {
        let Search { solver, problem, state, iterations } = &mut *search;
        let Some(before) = state.take() else { return Stage::Done };
        let Ok((after, _)) = solver.next_iter(problem, before) else { return Stage::Done };
        *iterations += 1;
        let cost = after.get_cost();
        if let Some(Point(shares)) = after.get_param() {
            self.keep(shares, cost);
        }
        let tolerance = TOLERANCE * cost.abs().max(1.0);
        if let Ok(tolerant) = solver.clone().with_sd_tolerance(tolerance) {
            *solver = tolerant;
        }
        let status = Solver::<Objective, _>::terminate(solver, &after);
        let is_done = matches!(status, TerminationStatus::Terminated(_)) || *iterations >= ITERATIONS;
        let runs = problem.counts.get("cost_count").copied().unwrap_or(0);
        *state = Some(after);
        if is_done {
            self.runs += runs;
            return self.look();
        }
        Stage::Searching(search)
    }

    /// The likelihood's maximum is looked at; another goal has no curvature that means anything.
    fn look(&self) -> Stage {
        match self.path.last().filter(|_| self.cost.goal == Goal::Likelihood) {
            Some(best) => Stage::Looking(Box::new(Information::new(&self.cost, best.values.clone(), best.score))),
            None => Stage::Done,
        }
    }

    fn keep(&mut self, shares: &[f64], cost: f64) {
        if self.path.last().is_none_or(|best| -cost > best.score || best.score.is_nan()) && cost < cost::FORBIDDEN {
            self.best = shares.to_vec();
            self.path.push(Try { values: self.cost.values(shares), score: -cost });
        }
    }
}

impl Task for Tuner {
    type Outcome = Tuned;

    /// A lower limit of the share of the search that is done, from 0 to 1.
    fn progress(&self) -> f64 {
        let axes = self.cost.axes.len().max(1) as f64;
        match &self.stage {
            Stage::Scanning(axis, place) => 0.2 * (*axis as f64 + *place as f64 / SCAN as f64) / axes,
            Stage::Searching(search) => 0.2 + 0.7 * search.iterations as f64 / ITERATIONS as f64,
            Stage::Looking(_) => 0.9,
            Stage::Done => 1.0,
        }
    }

    /// Each try or two are a piece of work.
    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        loop {
            self.stage = match std::mem::replace(&mut self.stage, Stage::Done) {
                Stage::Scanning(axis, place) => self.scan(axis, place),
                Stage::Searching(search) => self.search(search),
                Stage::Looking(mut information) => {
                    if information.advance(&self.cost) {
                        self.runs += information.runs();
                        self.bands = information.bands(&self.cost);
                        Stage::Done
                    } else {
                        Stage::Looking(information)
                    }
                }
                Stage::Done => return true,
            };
            if !while_time() {
                return matches!(self.stage, Stage::Done);
            }
        }
    }

    fn finish(self) -> Tuned {
        let Self { cost, path, bands, runs, .. } = self;
        let values = path.last().map(|best| best.values.clone()).unwrap_or_default();
        let scenario = cost.with_values(&values);
        let verdict = cost.verdict(&scenario);
        let remarks = information::remarks(&cost, &path, verdict);
        Tuned { scenario, path, bands, verdict, remarks, runs }
    }
}

#[cfg(test)]
mod tests;

/// The number that tuning optimises. In files it is the name of its measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "Measure", into = "Measure")]
pub enum Goal {
    /// The log likelihood of all measurements, from the innovations and their covariances.
    ///
    /// Source: Schweppe (1965), Evaluation of likelihood functions for Gaussian signals.
    Likelihood,
    /// The error of the identified model's free run, for one sensor.
    FreeRun(Quantity),
    /// The distance of the mean NIS from its expectation.
    Consistency,
}

impl Goal {
    /// The measure that it is about.
    pub const fn measure(self) -> Measure {
        match self {
            Self::Likelihood => Measure::LOG_LIKELIHOOD,
            Self::FreeRun(sensor) => Measure::free_run(sensor),
            Self::Consistency => Measure::NIS,
        }
    }

    /// The number for a value of the measure; more is better.
    pub fn score(self, value: f64) -> f64 {
        match self {
            Self::Likelihood => value,
            Self::FreeRun(_) => -libm::log(value),
            Self::Consistency => -libm::log(value).abs(),
        }
    }

    /// The largest change of the score that is not significant.
    const fn indifferent(self) -> f64 {
        match self {
            // A 95 % interval of one parameter: half the quantile 3.84 of χ² with one degree of freedom.
            Self::Likelihood => 1.92,
            Self::FreeRun(_) | Self::Consistency => 0.01,
        }
    }
}

impl From<Goal> for Measure {
    fn from(goal: Goal) -> Self {
        goal.measure()
    }
}

impl TryFrom<Measure> for Goal {
    type Error = String;

    fn try_from(measure: Measure) -> Result<Self, Self::Error> {
        if let Some(sensor) = measure.sensor().filter(|sensor| Measure::free_run(*sensor) == measure) {
            return Ok(Self::FreeRun(sensor));
        }
        let goals = [Self::Likelihood, Self::Consistency];
        goals.into_iter().find(|goal| goal.measure() == measure).ok_or_else(|| {
            format!("`{measure}` is no goal of tuning: it may be `log_likelihood`, `nis` or `free_run.SENSOR`")
        })
    }
}
