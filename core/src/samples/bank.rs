//! The filters of a scenario, side by side.

use crate::samples::estimator::{FilterContext, counts_in_samples};
use crate::samples::pass::apart;
use crate::samples::run_error::sensor_places;
use crate::samples::smoother::Smoother;
use crate::samples::smoother::forward::Forward;
use crate::samples::smoother::interval::FixedInterval;
use crate::samples::smoother::lag::FixedLag;
use crate::samples::tape::Tape;
use crate::{Estimates, FilterSettings, Pass, Quantity, Record, RunError, Scenario};

pub(crate) struct Bank {
    /// The scenario; each filter has a unique id.
    pub(crate) scenario: Scenario,
    quantities: Vec<Quantity>,
    /// Time between samples \[s\].
    dt: f64,
    sensors: Vec<usize>,
    /// The samples between two readings of each sensor, where they have times of their own.
    apart: Option<Vec<usize>>,
    pub(crate) passes: Vec<Pass>,
    pub(crate) estimates: Vec<Estimates>,
}

impl Bank {
    pub(crate) fn new(scenario: &Scenario, record: &Record) -> Result<Self, RunError> {
        let quantities = scenario.measured();
        let (sensors, apart) = (sensor_places(scenario, record)?, apart(record, &quantities));
        let mut scenario = scenario.clone();
        scenario.number_filters();
        let dt = record.dt();
        Ok(Self { scenario, quantities, dt, sensors, apart, passes: Vec::new(), estimates: Vec::new() })
    }

    fn context(&self, record: &Record, place: usize) -> FilterContext {
        let filter = &self.scenario.filters[place];
        FilterContext::new(&self.scenario, record.dt(), filter).over(record, filter)
    }

    /// Reserves memory for `samples`, or reuses that of old estimates.
    pub(crate) fn add(&mut self, record: &Record, samples: usize, spare: Option<Estimates>) {
        let place = self.passes.len();
        let filter = &self.scenario.filters[place];
        let pass = Pass::later(filter, self.context(record, place), self.sensors.clone());
        let mut estimates = self.empty(filter);
        estimates.recycle(spare, samples);
        self.passes.push(pass);
        self.estimates.push(estimates);
    }

    /// Takes in the next of all `samples` samples of the filter at a place. Returns false if they are not its own.
    pub(crate) fn take(&mut self, place: usize, tape: &Tape, samples: usize) -> bool {
        self.passes[place].take(tape, samples, &mut self.estimates[place])
    }

    pub(crate) fn begin_again(&mut self, place: usize, samples: usize) {
        let mut estimates = self.empty(&self.scenario.filters[place]);
        std::mem::swap(&mut estimates, &mut self.estimates[place]);
        self.estimates[place].recycle(Some(estimates), samples);
        self.passes[place].begin_again();
    }

    pub(crate) fn leave_place(&mut self) {
        let filter = &self.scenario.filters[self.passes.len()];
        self.estimates.push(self.empty(filter));
        self.passes.push(Pass::idle());
    }

    fn empty(&self, filter: &FilterSettings) -> Estimates {
        let model = filter.model(self.scenario.plant.kind, self.scenario.input);
        let estimates = Estimates::new(filter, &model, self.quantities.clone());
        estimates.over(self.apart.as_deref(), self.dt, counts_in_samples(filter))
    }

    pub(crate) fn lookahead(&self) -> usize {
        lookahead(&self.scenario, self.dt)
    }

    pub(crate) fn reach(&self) -> usize {
        self.scenario.filters.iter().map(|filter| filter.delays(self.dt).reach()).max().unwrap_or(0)
    }

    /// One filter after the other, because each one's data then stays in the cache.
    pub(crate) fn follow(&mut self, record: &Record, samples: usize) {
        for place in 0..self.passes.len() {
            self.follow_one(place, record, samples);
        }
    }

    /// One filter after the other. Returns early if `while_time`, called after each, is false.
    pub(crate) fn prepare(&mut self, record: &Record, while_time: &mut dyn FnMut() -> bool) -> bool {
        self.passes.iter_mut().all(|pass| {
            let is_there = pass.is_prepared();
            pass.prepare(record);
            is_there || while_time()
        })
    }

    pub(crate) fn follow_one(&mut self, place: usize, record: &Record, samples: usize) {
        let (pass, estimates) = (&mut self.passes[place], &mut self.estimates[place]);
        if pass.done() < samples {
            pass.settle(samples, estimates);
        }
        pass.follow(record, samples, estimates);
    }

    pub(crate) fn forget(&mut self, samples: usize) {
        for estimates in &mut self.estimates {
            estimates.forget(samples);
        }
    }

    pub(crate) fn smoother(&self, place: usize, record: &Record) -> Option<Box<dyn Smoother>> {
        let filter = self.scenario.filters.get(place).filter(|filter| filter.smoother)?;
        let context = self.context(record, place);
        let forward = Forward::new(filter, &context, self.sensors.clone())?;
        Some(match filter.lag(context.dt) {
            Some(lag) => Box::new(FixedLag::new(forward, lag)),
            None => Box::new(FixedInterval::new(forward)),
        })
    }

    /// Empty estimates for the smoother of the filter at a place. They have no innovations; those are the filter's.
    pub(crate) fn smoothed(&self, place: usize) -> Estimates {
        let filter = &self.scenario.filters[place];
        let model = filter.model(self.scenario.plant.kind, self.scenario.input);
        Estimates::new(filter, &model, Vec::new()).of_smoother()
    }
}

/// The number of samples, `dt` \[s\] apart, beyond its last one that a filter of a scenario reads of the record.
pub(crate) fn lookahead(scenario: &Scenario, dt: f64) -> usize {
    scenario.filters.iter().map(|filter| filter.delays(dt).lookahead()).max().unwrap_or(0)
}

/// The smoothed estimates of the filter at `place` of a scenario, given a whole record: those of
/// [`Run::smoothed`](crate::Run::smoothed), to the bit, whether or not the filter's settings ask for a smoother. They have
/// means and covariances, but no innovations.
///
/// If the filter stops, the smoother gets the samples before; [`Estimates::stop`] gives the sample and the reason.
///
/// ```
/// use kalmanscope_core::{Run, Scenario, smoothed};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let scenario = Scenario { duration: 5.0, ..Scenario::default() };
/// let mut run = Run::new(&scenario)?;
/// run.finish();
/// let (filter, smoother) = (&run.estimates()[0], smoothed(&scenario, 0, run.record())?);
/// assert!(smoother.std(0, 2) < filter.std(0, 2), "the whole record tells of the first sample");
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// [`RunError::NoFilter`] where there is no such filter; [`RunError::Scenario`] where the scenario is impossible or the
/// filter has no smoother: a sampled one, or one with several guesses; [`RunError::MissingSensor`] and
/// [`RunError::InputKind`] where the record does not fit the scenario; [`RunError::Forgotten`] where it lacks its first
/// samples.
///
/// Source: Rauch, Tung and Striebel (1965), Maximum likelihood estimates of linear dynamic systems, in the form that
/// [`Run::smoothed`](crate::Run::smoothed) computes.
pub fn smoothed(scenario: &Scenario, place: usize, record: &Record) -> Result<Estimates, RunError> {
    let mut scenario = scenario.clone();
    scenario.filters.get_mut(place).ok_or(RunError::NoFilter(place))?.smoother = true;
    scenario.validate()?;
    if record.forgotten() > 0 {
        return Err(RunError::Forgotten(record.forgotten()));
    }
    let bank = Bank::new(&scenario, record)?;
    let mut estimates = bank.smoothed(place);
    match bank.smoother(place, record) {
        Some(mut smoother) => while !smoother.advance(record, record.len(), true, usize::MAX, &mut estimates) {},
        // A filter that cannot begin says why at its first sample.
        None => Pass::new(&scenario, place, record)?.follow(record, 1, &mut estimates),
    }
    Ok(estimates)
}
