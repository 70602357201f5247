//! Tuning: the best values of some settings of one filter.

mod information;

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use kalmanscope_core::score::ScoredPass;
use kalmanscope_core::setting::Address;
use kalmanscope_core::{Axis, Pass, Quantity, Record, Scenario, Task, Work};
use kalmanscope_diagnosis::{Measure, VerdictKind};
use kalmanscope_records::task::{Progress, pause};
use serde::{Deserialize, Serialize};

use crate::EnsembleError;
use crate::runner::numbers;

pub use information::TuneRemark;

const SCAN: usize = 9;

const ITERATIONS: u64 = 300;

const SIMPLEX: f64 = 0.08;

/// The search ends when the scores of the simplex differ by less than this, relative to their size or absolutely.
const TOLERANCE: f64 = 1e-7;

/// A search for the settings of a filter with the best score: first along each axis alone, then by the method of Nelder and Mead.
///
/// Source: Nelder and Mead (1965), A simplex method for function minimization.
pub struct Tuner {
    work: Work<Tuned>,
    path: Arc<Mutex<Vec<Try>>>,
}

struct TuneSearch {
    cost: Cost,
    best: Vec<f64>,
    path: Arc<Mutex<Vec<Try>>>,
    runs: u64,
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
    pub remarks: Vec<TuneRemark>,
    /// The number of runs that it took.
    pub runs: u64,
}

impl Tuner {
    /// A search over the given axes for the filter at `place`, from the scenario's present values on. The axes' counts have
    /// no effect. Before the search it tries a `guess` of the settings, one an axis, such as the best values of a map; values beyond
    /// an axis count as its nearest end.
    ///
    /// # Errors
    /// [`EnsembleError`] where an axis is impossible or varies no number of a filter, or the record does not fit.
    pub fn new(
        mut scenario: Scenario,
        place: usize,
        record: Arc<Record>,
        axes: Vec<Axis>,
        goal: Goal,
        guess: Option<&[f64]>,
    ) -> Result<Self, EnsembleError> {
        scenario.number_filters();
        let mut settings = Vec::new();
        for axis in &axes {
            axis.check()?;
            let setting = Address::parse(&scenario, &axis.key)?;
            if !setting.is_of_filters() {
                return Err(EnsembleError::Fixed(axis.key.clone()));
            }
            settings.push(setting);
        }
        Pass::new(&scenario, place, &record)?;
        let cost = Cost { scenario, place, record, axes, settings, goal };
        let values: Vec<f64> = cost.settings.iter().map(|setting| setting.get(&cost.scenario)).collect();
        let best = cost.shares(&values);
        // The present values count even if they are beyond an axis.
        let path = Arc::new(Mutex::new(vec![Try { values, score: -cost.of_scenario(&cost.scenario) }]));
        let mut search = TuneSearch { cost, best, path: Arc::clone(&path), runs: 1 };
        if let Some(guess) = guess.filter(|guess| guess.len() == search.best.len()) {
            search.attempt(&search.cost.shares(guess));
        }
        Ok(Self { work: Work::new(|progress| search.tuned(progress)), path })
    }

    /// Each try that was better than all before; the scenario's own values come first.
    pub fn path(&self) -> Vec<Try> {
        self.path.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

impl TuneSearch {
    async fn tuned(mut self, progress: Progress) -> Tuned {
        let mut bands = None;
        if !self.best.is_empty() {
            // A simplex goes down into the nearest valley: the scan looks for the deepest one.
            self.scan(&progress).await;
            self.search(&progress).await;
            let best = self.path().last().cloned();
            if let Some(best) = best.filter(|_| self.cost.goal == Goal::Likelihood) {
                bands = information::bands(&self.cost, best, &mut self.runs).await;
            }
        }
        let (Self { cost, runs, .. }, path) = (&self, self.path().clone());
        let values = path.last().map(|best| best.values.clone()).unwrap_or_default();
        let scenario = cost.with_values(&values);
        let verdict = cost.numbers(&scenario, &[Measure::VERDICT]).filter(|row| row[0] >= 0.0);
        let verdict = verdict.and_then(|row| VerdictKind::ALL.get(row[0] as usize).copied());
        let remarks = information::remarks(cost, &path, verdict);
        Tuned { scenario, path, bands, verdict, remarks, runs: *runs }
    }

    async fn scan(&mut self, progress: &Progress) {
        let axes = self.best.len();
        for at in 0..axes * SCAN {
            let mut shares = self.best.clone();
            shares[at / SCAN] = (at % SCAN) as f64 / (SCAN - 1) as f64;
            self.attempt(&shares);
            progress.set(0.2 * (at + 1) as f64 / (axes * SCAN) as f64);
            pause().await;
        }
    }

    async fn search(&mut self, progress: &Progress) {
        let n = self.best.len();
        let mut points = vec![self.best.clone(); n + 1];
        for (axis, corner) in points[1..].iter_mut().enumerate() {
            // Inwards, since beyond its axis a corner has no score.
            corner[axis] += if corner[axis] > 0.5 { -SIMPLEX } else { SIMPLEX };
        }
        self.runs += points.len() as u64;
        // Points in shares of the axes, each behind its cost; the best one first.
        let mut simplex: Vec<_> = points.into_iter().map(|point| (self.cost.of(&point), point)).collect();
        simplex.sort_by(by_cost);
        for iteration in 1..=ITERATIONS {
            pause().await;
            self.step(&mut simplex);
            progress.set(0.2 + 0.7 * iteration as f64 / ITERATIONS as f64);
            let mean = simplex.iter().map(|(cost, _)| cost).sum::<f64>() / simplex.len() as f64;
            let squares = simplex.iter().map(|(cost, _)| (cost - mean) * (cost - mean));
            if (1.0 / n as f64 * squares.sum::<f64>()).sqrt() < TOLERANCE * simplex[0].0.abs().max(1.0) {
                break;
            }
        }
    }

    fn step(&mut self, simplex: &mut [(f64, Vec<f64>)]) {
        let n = simplex.len() - 1;
        let centroid = |i: usize| 1.0 / n as f64 * simplex[..n].iter().map(|(_, point)| point[i]).sum::<f64>();
        let centroid: Vec<f64> = (0..n).map(centroid).collect();
        let mut beside = |from: &[f64], point: &[f64], by: f64| {
            let moved: Vec<f64> = from.iter().zip(point).map(|(from, x)| from + by * (x - from)).collect();
            self.runs += 1;
            (self.cost.of(&moved), moved)
        };
        let [best, second, worst] = [0, n - 1, n].map(|place| simplex[place].0);
        let (cost, reflected) = beside(&centroid, &simplex[n].1, -1.0);
        let other = if cost < best {
            Some(beside(&centroid, &reflected, 2.0)).filter(|(other, _)| *other < cost).or(Some((cost, reflected)))
        } else if cost < second {
            Some((cost, reflected))
        } else if cost < worst {
            Some(beside(&centroid, &reflected, 0.5)).filter(|(other, _)| *other <= cost)
        } else {
            Some(beside(&centroid, &simplex[n].1, 0.5)).filter(|(other, _)| *other < worst)
        };
        if let Some(other) = other {
            simplex[n] = other;
        } else {
            let (first, others) = simplex.split_at_mut(1);
            for other in others {
                *other = beside(&first[0].1, &other.1, 0.5);
            }
        }
        simplex.sort_by(by_cost);
        let (cost, point) = &simplex[0];
        self.keep(point, *cost);
    }

    fn attempt(&mut self, shares: &[f64]) {
        let cost = self.cost.of(shares);
        self.runs += 1;
        self.keep(shares, cost);
    }

    fn keep(&mut self, shares: &[f64], cost: f64) {
        if self.path().last().is_none_or(|best| -cost > best.score || best.score.is_nan()) && cost < FORBIDDEN {
            self.best = shares.to_vec();
            self.path().push(Try { values: self.cost.values(shares), score: -cost });
        }
    }

    fn path(&self) -> MutexGuard<'_, Vec<Try>> {
        self.path.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn by_cost(a: &(f64, Vec<f64>), b: &(f64, Vec<f64>)) -> std::cmp::Ordering {
    a.0.partial_cmp(&b.0).unwrap_or(std::cmp::Ordering::Equal)
}

impl Task for Tuner {
    type Outcome = Tuned;

    fn progress(&self) -> f64 {
        self.work.progress()
    }

    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        self.work.advance(while_time)
    }

    fn finish(self) -> Tuned {
        self.work.finish()
    }
}

// No infinity: the spread of a simplex with one is no number, and the search would not end.
const FORBIDDEN: f64 = 1e100;

struct Cost {
    scenario: Scenario,
    place: usize,
    record: Arc<Record>,
    axes: Vec<Axis>,
    settings: Vec<Address>,
    goal: Goal,
}

impl Cost {
    fn shares(&self, values: &[f64]) -> Vec<f64> {
        let share = |(axis, &value): (&Axis, &f64)| {
            let share = axis.share_of(value);
            if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) }
        };
        self.axes.iter().zip(values).map(share).collect()
    }

    fn values(&self, shares: &[f64]) -> Vec<f64> {
        self.axes.iter().zip(shares).map(|(axis, &share)| axis.at_share(share)).collect()
    }

    fn with_values(&self, values: &[f64]) -> Scenario {
        let mut scenario = self.scenario.clone();
        for (setting, &value) in self.settings.iter().zip(values) {
            setting.set(&mut scenario, value);
        }
        scenario
    }

    fn of(&self, shares: &[f64]) -> f64 {
        if !shares.iter().all(|share| (0.0..=1.0).contains(share)) {
            return FORBIDDEN;
        }
        self.of_scenario(&self.with_values(&self.values(shares)))
    }

    fn of_scenario(&self, scenario: &Scenario) -> f64 {
        let measures = [Measure::STOPPED, self.goal.measure()];
        let Some(row) = self.numbers(scenario, &measures) else { return FORBIDDEN };
        let cost = -self.goal.score(row[1]);
        if row[0] == 0.0 && cost.is_finite() { cost.min(FORBIDDEN) } else { FORBIDDEN }
    }

    fn numbers(&self, scenario: &Scenario, measures: &[Measure]) -> Option<Vec<f64>> {
        let Self { place, record, .. } = self;
        let needs_history = measures.iter().any(|measure| measure.info().needs_history());
        let mut pass = ScoredPass::new(scenario, *place, record, &[], needs_history).ok()?;
        pass.advance(record, usize::MAX);
        let (outcome, history) = pass.finish();
        Some(numbers(scenario, *place, record, measures, (&outcome, history.as_ref())))
    }
}

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

    const fn subject(self) -> &'static str {
        match self {
            Self::Likelihood => "The likelihood",
            Self::FreeRun(_) => "The free run",
            Self::Consistency => "The mean NIS",
        }
    }

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
