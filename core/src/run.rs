//! The one engine: a truth or a measured record, and the filters that follow it sample by sample.

mod settings;

use std::ops::Range;
use std::sync::Arc;

use thiserror::Error;

use settings::Settings;

use crate::estimator::{Estimator, estimator};
use crate::quantity::MAX_SENSORS;
use crate::simulate::{Simulator, TruthStop};
use crate::smoother::smooth;
use crate::{Channel, Estimates, FilterSettings, Quantity, Record, Scenario, ScenarioError};

/// Why a run cannot begin.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum RunError {
    /// The scenario is impossible.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The record lacks a sensor of the scenario.
    #[error("the record does not measure {}, but the scenario has a sensor for it", .0.key())]
    MissingSensor(Quantity),
}

/// A scenario in progress.
///
/// A simulated run may forget its first samples ([`Self::forget`]), and can then go on for ever in the same memory. Counts
/// of all samples, [`Self::done`] and [`Self::samples`], are from the run's beginning; [`Self::len`] and every index into
/// [`Self::record`] and [`Self::estimates`] are of those that are kept.
pub struct Run {
    source: Source,
    samples: usize,
    done: usize,
    /// The place of each of the scenario's sensors in the record.
    sensors: Vec<usize>,
    estimators: Vec<Box<dyn Estimator>>,
    estimates: Vec<Estimates>,
    settings: Settings,
}

/// What [`Run::update`] has computed again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Update {
    /// The truth and every filter.
    Everything,
    /// The filters with these ids; the truth and all other filters are as they were, but for those that are gone.
    Filters(Vec<u32>),
}

enum Source {
    Simulated { simulator: Box<Simulator>, record: Record },
    Measured(Arc<Record>),
}

impl Source {
    fn record(&self) -> &Record {
        match self {
            Self::Simulated { record, .. } => record,
            Self::Measured(record) => record,
        }
    }
}

impl Run {
    /// A run over the scenario's own simulated record, before its first sample.
    ///
    /// # Errors
    /// [`RunError::Scenario`] where the scenario is impossible.
    pub fn new(scenario: &Scenario) -> Result<Self, RunError> {
        scenario.validate()?;
        let simulator = Box::new(Simulator::new(scenario));
        let record = simulator.empty_record();
        Self::over(scenario, Source::Simulated { simulator, record }, scenario.samples(), Vec::new())
    }

    /// Begins anew with another scenario, as [`Self::new`] does, in the memory of this run.
    ///
    /// # Errors
    /// [`RunError::Scenario`] where the scenario is impossible; this run stays as it is then.
    pub fn restart(&mut self, scenario: &Scenario) -> Result<(), RunError> {
        scenario.validate()?;
        let simulator = Box::new(Simulator::new(scenario));
        let mut record = simulator.empty_record();
        if let Source::Simulated { record: old, .. } = &mut self.source {
            record.recycle(std::mem::replace(old, simulator.empty_record()));
        }
        let old = std::mem::take(&mut self.estimates);
        *self = Self::over(scenario, Source::Simulated { simulator, record }, scenario.samples(), old)?;
        Ok(())
    }

    /// A run of the scenario's filters over a given record, whose `dt` counts instead of the scenario's.
    ///
    /// # Errors
    /// [`RunError::Scenario`] where the scenario is impossible, [`RunError::MissingSensor`] where the record lacks one
    /// of its sensors.
    pub fn on_record(scenario: &Scenario, record: Arc<Record>) -> Result<Self, RunError> {
        scenario.validate()?;
        let samples = record.len();
        Self::over(scenario, Source::Measured(record), samples, Vec::new())
    }

    fn over(scenario: &Scenario, source: Source, samples: usize, old: Vec<Estimates>) -> Result<Self, RunError> {
        let record = source.record();
        let place = |q: Quantity| record.sensors().iter().position(|&s| s == q).ok_or(RunError::MissingSensor(q));
        let quantities: Vec<Quantity> = scenario.sensors.iter().map(|s| s.measures).collect();
        let sensors = quantities.iter().map(|&q| place(q)).collect::<Result<Vec<_>, _>>()?;
        let dt = record.dt();
        let settings = Settings::new(scenario, quantities);
        let filters = &settings.filters;
        let mut old = old.into_iter();
        let estimates = |filter: &FilterSettings| {
            let mut estimates = settings.estimates(filter);
            estimates.recycle(old.next(), samples);
            estimates
        };
        let build = |filter: &FilterSettings| estimator(filter, settings.context(dt, filter));
        Ok(Self {
            estimates: filters.iter().map(estimates).collect(),
            estimators: filters.iter().map(build).collect(),
            settings,
            source,
            samples,
            done: 0,
            sensors,
        })
    }

    /// Takes over another scenario as far as this run has come, as a new run of it would come there: with the same bits, but
    /// a truth and filters whose settings have not changed are not computed again. A run that has forgotten samples, or is
    /// over a given record, begins anew.
    ///
    /// # Errors
    /// [`RunError::Scenario`] where the scenario is impossible; this run stays as it is then.
    pub fn update(&mut self, scenario: &Scenario) -> Result<Update, RunError> {
        let simulated = matches!(self.source, Source::Simulated { .. });
        if !(simulated && self.record().forgotten() == 0 && self.settings.have_the_truth_of(scenario)) {
            self.restart(scenario)?;
            return Ok(Update::Everything);
        }
        scenario.validate()?;
        let before = self.settings.replace_filters(scenario);
        let Self { source, samples, done, sensors, estimators, estimates, settings } = self;
        let record = source.record();
        let old = std::mem::take(estimators).into_iter().zip(std::mem::take(estimates)).zip(before);
        let mut old: Vec<_> = old.collect();
        let mut changed = Vec::new();
        for filter in &settings.filters {
            let of_this_id = old.iter().position(|(_, before)| before.id == filter.id);
            let (followed, new) = match of_this_id.map(|at| old.swap_remove(at)) {
                Some((same, before)) if before == *filter => same,
                other => {
                    changed.push(filter.id);
                    let mut followed = estimator(filter, settings.context(record.dt(), filter));
                    let mut new = settings.estimates(filter);
                    new.recycle(other.map(|((_, old), _)| old), *samples);
                    follow(followed.as_mut(), &mut new, record, sensors, 0..*done);
                    (followed, new)
                }
            };
            estimators.push(followed);
            estimates.push(new);
        }
        Ok(Update::Filters(changed))
    }

    /// Advances by one sample: the truth moves on, then every filter predicts and updates. The first step reports the
    /// initial beliefs. A filter that fails keeps its estimates so far and says why in [`Estimates::stop`]; the others go
    /// on. Returns whether there was a sample left; a truth that runs away ends the record early and says why in
    /// [`Self::truth_stop`].
    pub fn step(&mut self) -> bool {
        self.advance_to(self.done + 1) > 0
    }

    /// Steps until `samples` samples, from the run's beginning, are done or there are none left. Returns how many steps that
    /// took.
    pub fn advance_to(&mut self, samples: usize) -> usize {
        let Self { source, samples: all, done, sensors, estimators, estimates, settings: _ } = self;
        let begin = *done;
        let goal = samples.min(*all);
        if let Source::Simulated { simulator, record } = source {
            for sample in begin..goal {
                if !simulator.step(record) {
                    *all = sample;
                    break;
                }
            }
        }
        *done = goal.min(*all).max(begin);
        // One filter after the other: each finds its own numbers in the cache.
        for (estimator, estimates) in estimators.iter_mut().zip(estimates) {
            follow(estimator.as_mut(), estimates, source.record(), sensors, begin..*done);
        }
        *done - begin
    }

    /// Forgets the first `samples` of those that are kept, or all but the last, and whatever has been told of them, without
    /// giving memory back. What comes after is the same to the last bit. Only a simulated record can be forgotten; returns
    /// whether it is one.
    pub fn forget(&mut self, samples: usize) -> bool {
        let samples = samples.min(self.len().saturating_sub(1));
        let Source::Simulated { record, .. } = &mut self.source else { return false };
        record.forget(samples);
        for estimates in &mut self.estimates {
            estimates.forget(samples);
        }
        true
    }

    /// Steps to the end of the record.
    pub fn finish(&mut self) {
        self.advance_to(self.samples);
    }

    /// The number of samples done, from the run's beginning.
    pub fn done(&self) -> usize {
        self.done
    }

    /// The number of samples done that are kept: all, unless some have been forgotten.
    pub fn len(&self) -> usize {
        self.done - self.record().forgotten()
    }

    /// Whether no sample is done yet.
    pub fn is_empty(&self) -> bool {
        self.done == 0
    }

    /// The number of samples of the whole record, from the run's beginning, kept or not.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// Where the simulated truth stopped and why, if it had no numbers left before the record was complete.
    pub fn truth_stop(&self) -> Option<TruthStop> {
        match &self.source {
            Source::Simulated { simulator, .. } => simulator.stop(),
            Source::Measured(_) => None,
        }
    }

    /// The record: as far as it is simulated and kept, or all of a measured one.
    pub fn record(&self) -> &Record {
        self.source.record()
    }

    /// The estimates so far, as far as they are kept, one a filter.
    pub fn estimates(&self) -> &[Estimates] {
        &self.estimates
    }

    /// The estimates of every filter with a smoother in the light of all samples so far. They have means and
    /// covariances, but no innovations. A smoother begins where the filter did: a run that has forgotten samples has none.
    ///
    /// Source: Rauch, Tung and Striebel (1965), Maximum likelihood estimates of linear dynamic systems.
    pub fn smoothed(&self) -> Vec<Estimates> {
        let Self { settings, source, done, .. } = self;
        let record = source.record();
        if record.forgotten() > 0 {
            return Vec::new();
        }
        let of = |filter: &FilterSettings| {
            let mut smoothed = settings.smoothed(filter);
            smooth(filter, settings.context(record.dt(), filter), record, *done, &mut smoothed);
            smoothed
        };
        settings.filters.iter().filter(|filter| filter.smoother).map(of).collect()
    }

    /// Every channel that the truth or a filter has.
    pub fn channels(&self) -> Vec<Channel> {
        let known =
            |c: &Channel| self.record().truth(*c).is_some() || self.estimates.iter().any(|e| e.place(*c).is_some());
        Channel::all().iter().copied().filter(known).collect()
    }

    /// Checksum of all estimates that are kept, to compare platforms with.
    pub fn checksum(&self) -> u64 {
        self.estimates.iter().fold(0, |sum: u64, e| sum.rotate_left(1) ^ e.checksum())
    }
}

/// Lets a filter go through the samples of a record that have these numbers, counted from the run's beginning. `sensors` are
/// the places in the record of those that it has.
fn follow(
    estimator: &mut dyn Estimator,
    estimates: &mut Estimates,
    record: &Record,
    sensors: &[usize],
    samples: Range<usize>,
) {
    let mut measured = [f64::NAN; MAX_SENSORS];
    let measured = &mut measured[..sensors.len()];
    for sample in samples {
        if sample == 0 {
            estimator.begin(estimates);
            continue;
        }
        if estimates.stop().is_some() {
            return;
        }
        let k = sample - record.forgotten();
        for (value, &sensor) in measured.iter_mut().zip(sensors) {
            *value = record.measured(sensor)[k];
        }
        if let Err(reason) = estimator.step(record.force(k - 1), record.force(k), measured, estimates) {
            estimates.stop_at(reason);
        }
    }
}
