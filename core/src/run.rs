//! The engine: a truth or a measured record, and the filters that use it, sample by sample.

pub(crate) mod estimates;
pub(crate) mod estimator;
pub(crate) mod events;
pub(crate) mod forces;
pub(crate) mod mixture;
pub(crate) mod pass;
pub(crate) mod passage;
pub(crate) mod remarks;
pub(crate) mod revision;
pub(crate) mod run_error;
pub(crate) mod simulate;
pub(crate) mod sink;
pub(crate) mod smoother;
pub(crate) mod spread;
pub(crate) mod tape;
pub(crate) mod waste;

use std::sync::Arc;

use kalmanscope_filters::Channel;
use kalmanscope_filters::catalogue::all_and;
use kalmanscope_records::Record;

use crate::run::estimator::{FilterContext, counts_in_samples};
use crate::run::pass::apart;
use crate::run::run_error::sensor_places;
use crate::run::simulate::{Recording, TruthStop, lookahead};
use crate::run::smoother::{FixedInterval, FixedLag, Forward, Smoother};
use crate::run::waste::Spare;
use crate::scenario::clash;
use crate::{Estimates, FilterSettings, Pass, RunError, Scenario, Source};
use revision::Revision;

/// A scenario in progress.
///
/// It can forget its first samples ([`Self::forget`]). [`Self::done`] and [`Self::samples`] count from the run's beginning, all
/// other places and lengths from the first sample that is kept.
pub struct Run {
    recording: Recording,
    samples: usize,
    done: usize,
    /// Its filters.
    pub bank: Bank,
}

/// The parts that [`Run::update`] has computed again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Update {
    /// Everything: the truth, or the way in which a given record is read, and every filter.
    Everything,
    /// The filters with these ids; the rest is unchanged, but for filters that the scenario lacks now.
    Filters(Vec<u32>),
}

impl Run {
    /// A run over the scenario's own simulated record, before its first sample.
    ///
    /// # Errors
    /// [`RunError::Scenario`] where the scenario is impossible.
    pub fn new(scenario: &Scenario) -> Result<Self, RunError> {
        Self::from_source(scenario, Source::Simulated)
    }

    /// A run of the scenario's filters over a given record. The record's `dt` replaces the scenario's.
    ///
    /// # Errors
    /// As [`Self::new`]; [`RunError::MissingSensor`] and [`RunError::InputKind`] where the record does not fit the scenario.
    pub fn on_record(scenario: &Scenario, record: Arc<Record>) -> Result<Self, RunError> {
        Self::from_source(scenario, Source::Measured(record))
    }

    /// A run over either source, before its first sample; with the errors of [`Self::on_record`].
    pub fn from_source(scenario: impl Into<Arc<Scenario>>, source: Source) -> Result<Self, RunError> {
        let scenario = scenario.into();
        scenario.validate()?;
        let recording = Recording::new(&scenario, source, None);
        let (samples, count) = (recording.samples(&scenario), scenario.filters.len());
        let mut bank = Bank::new(scenario, &recording.record)?;
        for _ in 0..count {
            bank.add(&recording.record, samples, None);
        }
        Ok(Self { recording, samples, done: 0, bank })
    }

    /// Changes the scenario and computes again what differs, up to the present sample, with the same bits as a new run.
    ///
    /// # Errors
    /// As [`Self::on_record`]; this run is then unchanged.
    pub fn update(&mut self, scenario: &Scenario) -> Result<Update, RunError> {
        let mut spare = Spare::default();
        let mut revision = Revision::new(self, &scenario.into(), None, &mut spare)?;
        let done = if revision.is_of_everything { 0 } else { self.done };
        while !revision.advance_to(done, self.record(), &mut || true) {}
        Ok(revision.apply(self, done, &mut spare))
    }

    /// Advances truth and filters by one sample; the first one has the initial beliefs. Returns whether there was one left.
    pub fn step(&mut self) -> bool {
        self.advance_to(self.done + 1) > 0
    }

    /// Steps until `samples` samples, from the run's beginning, are done, or to the end. Returns the number of steps.
    pub fn advance_to(&mut self, samples: usize) -> usize {
        let Self { recording, samples: all, done, bank } = self;
        let begin = *done;
        let goal = samples.min(*all);
        recording.advance(goal + bank.lookahead(), all, &mut || true);
        *done = goal.min(*all).max(begin);
        bank.follow(&recording.record, *done);
        *done - begin
    }

    /// The part of the record that [`Self::advance_to`] needs. Returns false early if `while_time` does.
    pub fn simulate(&mut self, samples: usize, while_time: &mut dyn FnMut() -> bool) -> bool {
        let Self { recording, samples: all, done: _, bank } = self;
        recording.advance(samples.min(*all) + bank.lookahead(), all, while_time)
    }

    /// One filter after the other. Returns early if `while_time`, called after each, is false.
    pub fn prepare(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        let Self { recording, samples: all, done, bank } = self;
        let goal = (*done + 1).min(*all);
        recording.advance(goal + bank.lookahead(), all, &mut || true);
        goal > *all || bank.prepare(&recording.record, while_time)
    }

    /// Forgets the first `samples` of those that are kept, but never the last one. Returns false for a given record.
    pub fn forget(&mut self, samples: usize) -> bool {
        let samples = samples.min(self.len().saturating_sub(1 + self.bank.reach()));
        let forgets = self.recording.forget(samples);
        if forgets {
            self.bank.forget(samples);
        }
        forgets
    }

    /// Takes in a live record that has more samples now. Returns false, and changes nothing, if it does not continue the present one.
    pub fn lengthen(&mut self, record: Arc<Record>) -> bool {
        let goes_on = self.recording.lengthen(record);
        if goes_on {
            self.samples = self.recording.samples(&self.bank.scenario);
        }
        goes_on
    }

    /// Whether samples are still added to the record.
    pub fn is_live(&self) -> bool {
        self.recording.is_live
    }

    /// Steps to the end of the record.
    pub fn finish(&mut self) {
        self.advance_to(self.samples);
    }

    /// The scenario.
    pub fn scenario(&self) -> &Scenario {
        &self.bank.scenario
    }

    /// The scenario, shared.
    pub fn shared_scenario(&self) -> Arc<Scenario> {
        Arc::clone(&self.bank.scenario)
    }

    /// The source of the samples.
    pub fn source(&self) -> Source {
        self.recording.source()
    }

    /// The number of samples done, counted from the run's beginning.
    pub fn done(&self) -> usize {
        self.done
    }

    /// The number of samples done and kept: all, unless some have been forgotten.
    pub fn len(&self) -> usize {
        self.done - self.record().forgotten()
    }

    /// Whether no sample is done yet.
    pub fn is_empty(&self) -> bool {
        self.done == 0
    }

    /// The number of samples of the whole record, counted from the run's beginning, kept or not.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// Where and why the simulated truth stopped, if it diverged before the record was complete.
    pub fn truth_stop(&self) -> Option<TruthStop> {
        self.recording.simulator.as_ref()?.stop
    }

    /// The record: the part that is simulated and kept, or all of a measured one.
    pub fn record(&self) -> &Record {
        &self.recording.record
    }

    /// The kept estimates so far, one per filter.
    pub fn estimates(&self) -> &[Estimates] {
        &self.bank.estimates
    }

    /// The smoothed estimates of every filter with a smoother: means and covariances, with a fixed look-ahead up to that much
    /// before the last sample. None of a run that has forgotten samples.
    ///
    /// Source: Rauch, Tung and Striebel (1965), Maximum likelihood estimates of linear dynamic systems.
    pub fn smoothed(&self) -> Vec<Estimates> {
        let record = self.record();
        if record.forgotten() > 0 {
            return Vec::new();
        }
        let is_whole = self.done == self.samples && !self.is_live();
        let of = |place: usize| {
            let wants = self.scenario().filters[place].smoother;
            let mut smoothed = wants.then(|| self.bank.smoothed(place))?;
            if let Some(mut smoother) = self.bank.smoother(place, record) {
                while !smoother.advance(record, self.done, is_whole, usize::MAX, &mut smoothed) {}
            }
            Some(smoothed)
        };
        (0..self.scenario().filters.len()).filter_map(of).collect()
    }

    /// Every channel of the truth and of the filters.
    pub fn channels(&self) -> Vec<Channel> {
        let known = self.record().true_channels().into_iter();
        let known: Vec<Channel> =
            known.chain(self.estimates().iter().flat_map(|e| e.channels().iter().copied())).collect();
        all_and(known.clone()).into_iter().filter(|channel| known.contains(channel)).collect()
    }

    /// A hash of all estimates that are kept, to compare platforms.
    pub fn checksum(&self) -> u64 {
        self.estimates().iter().fold(0, |sum: u64, e| sum.rotate_left(1) ^ e.checksum())
    }
}

/// The filters of a run side by side, and their estimates.
pub struct Bank {
    /// Each filter has a unique id.
    pub scenario: Arc<Scenario>,
    /// Time between samples \[s\].
    dt: f64,
    sensors: Vec<usize>,
    apart: Option<Vec<usize>>,
    pub(crate) passes: Vec<Pass>,
    /// The estimates of each filter.
    pub estimates: Vec<Estimates>,
}

impl Bank {
    pub(crate) fn new(mut scenario: Arc<Scenario>, record: &Record) -> Result<Self, RunError> {
        let mut filters = scenario.filters.iter().enumerate();
        let clash = |one: &FilterSettings, other: &FilterSettings| one.id == other.id || clash(&one.name, &other.name);
        if filters.any(|(at, one)| one.id == 0 || scenario.filters[..at].iter().any(|other| clash(one, other))) {
            Arc::make_mut(&mut scenario).number_filters();
        }
        let (sensors, apart) = (sensor_places(&scenario, record)?, apart(record, &scenario.measured()));
        let dt = record.dt();
        Ok(Self { scenario, dt, sensors, apart, passes: Vec::new(), estimates: Vec::new() })
    }

    pub(crate) fn add(&mut self, record: &Record, samples: usize, spare: Option<Estimates>) {
        let filter = &self.scenario.filters[self.passes.len()];
        let context = FilterContext::over(record, &self.scenario, filter);
        let pass = Pass::with(filter, context, self.sensors.clone());
        let mut estimates = self.empty(filter);
        estimates.recycle(spare, samples);
        self.passes.push(pass);
        self.estimates.push(estimates);
    }

    pub(crate) fn begin_again(&mut self, place: usize, samples: usize) {
        let mut estimates = self.empty(&self.scenario.filters[place]);
        std::mem::swap(&mut estimates, &mut self.estimates[place]);
        self.estimates[place].recycle(Some(estimates), samples);
        self.passes[place].begin_again();
    }

    fn empty(&self, filter: &FilterSettings) -> Estimates {
        let estimates = Estimates::new(filter, &self.scenario, self.scenario.measured());
        estimates.over(self.apart.as_deref(), self.dt, counts_in_samples(filter))
    }

    pub(crate) fn lookahead(&self) -> usize {
        lookahead(&self.scenario, self.dt)
    }

    pub(crate) fn reach(&self) -> usize {
        self.scenario.filters.iter().map(|filter| filter.delays(self.dt).reach()).max().unwrap_or(0)
    }

    /// One filter after the other: the data of each one then stay in the cache.
    pub(crate) fn follow(&mut self, record: &Record, samples: usize) {
        for place in 0..self.passes.len() {
            self.follow_one(place, record, samples);
        }
    }

    pub(crate) fn prepare(&mut self, record: &Record, while_time: &mut dyn FnMut() -> bool) -> bool {
        self.passes.iter_mut().all(|pass| pass.prepare(record) || while_time())
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

    /// The smoother of a filter, if its settings ask for one.
    pub fn smoother(&self, place: usize, record: &Record) -> Option<Box<dyn Smoother>> {
        let filter = self.scenario.filters.get(place).filter(|filter| filter.smoother)?;
        let context = FilterContext::over(record, &self.scenario, filter);
        let forward = Forward::new(filter, &context, self.sensors.clone())?;
        Some(match filter.lag(context.dt) {
            Some(lag) => Box::new(FixedLag::new(forward, lag)),
            None => Box::new(FixedInterval::new(forward)),
        })
    }

    /// Empty estimates for the smoother of the filter at a place. They have no innovations; those are the filter's.
    pub fn smoothed(&self, place: usize) -> Estimates {
        Estimates::new(&self.scenario.filters[place], &self.scenario, Vec::new()).of_smoother()
    }
}

/// The smoothed estimates of the filter at `place` over a whole record, up to where it stops: those of [`Run::smoothed`].
///
/// # Errors
/// [`RunError`] where there is no such filter or it has no smoother, or where the record does not fit or lacks its first samples.
///
/// Source: Rauch, Tung and Striebel (1965), Maximum likelihood estimates of linear dynamic systems.
pub fn smoothed(scenario: &Scenario, place: usize, record: &Record) -> Result<Estimates, RunError> {
    let mut scenario = scenario.clone();
    scenario.filters.get_mut(place).ok_or(RunError::NoFilter(place))?.smoother = true;
    scenario.validate()?;
    if record.forgotten() > 0 {
        return Err(RunError::Forgotten(record.forgotten()));
    }
    let bank = Bank::new((&scenario).into(), record)?;
    let mut estimates = bank.smoothed(place);
    match bank.smoother(place, record) {
        Some(mut smoother) => while !smoother.advance(record, record.len(), true, usize::MAX, &mut estimates) {},
        // A filter that cannot begin says why at its first sample.
        None => Pass::new(&bank.scenario, place, record)?.follow(record, 1, &mut estimates),
    }
    Ok(estimates)
}
