//! The one engine: a truth or a measured record, and the filters that follow it sample by sample.

use std::sync::Arc;

use thiserror::Error;

use crate::estimator::{Estimator, Surroundings, estimator};
use crate::simulate::{Simulator, TruthStop};
use crate::smoother::smooth;
use crate::{Channel, Estimates, FilterSettings, PlantKind, Quantity, Record, Scenario, ScenarioError};

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
    measured: Vec<f64>,
    estimators: Vec<Box<dyn Estimator>>,
    estimates: Vec<Estimates>,
    settings: Settings,
}

/// What of the scenario is needed once more when the record is complete.
struct Settings {
    plant: PlantKind,
    seed: u64,
    quantities: Vec<Quantity>,
    filters: Vec<FilterSettings>,
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
        let record = simulator.empty_record();
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
        let Scenario { plant, seed, filters, .. } = scenario;
        let settings = Settings { plant: plant.kind, seed: *seed, filters: filters.clone(), quantities };
        let mut old = old.into_iter();
        let estimates = |filter: &FilterSettings| {
            let mut estimates = settings.estimates(filter);
            estimates.recycle(old.next(), samples);
            estimates
        };
        let build = |(place, filter)| estimator(filter, settings.surroundings(dt, place));
        Ok(Self {
            measured: vec![f64::NAN; sensors.len()],
            estimates: filters.iter().map(estimates).collect(),
            estimators: filters.iter().enumerate().map(build).collect(),
            settings,
            source,
            samples,
            done: 0,
            sensors,
        })
    }

    /// Advances by one sample: the truth moves on, then every filter predicts and updates. The first step reports the
    /// initial beliefs. A filter that fails keeps its estimates so far and says why in [`Estimates::stop`]; the others go
    /// on. Returns whether there was a sample left; a truth that runs away ends the record early and says why in
    /// [`Self::truth_stop`].
    pub fn step(&mut self) -> bool {
        let Self { source, samples, done, sensors, measured, estimators, estimates, settings: _ } = self;
        if *done >= *samples {
            return false;
        }
        if let Source::Simulated { simulator, record } = source
            && !simulator.step(record)
        {
            *samples = *done;
            return false;
        }
        let record = source.record();
        let k = *done - record.forgotten();
        for (value, &sensor) in measured.iter_mut().zip(sensors.iter()) {
            *value = record.measured(sensor)[k];
        }
        for (estimator, estimates) in estimators.iter_mut().zip(estimates) {
            if *done == 0 {
                estimator.begin(estimates);
            } else if estimates.stop().is_none()
                && let Err(reason) = estimator.step(record.force()[k - 1], record.force()[k], measured, estimates)
            {
                estimates.stop_at(reason);
            }
        }
        *done += 1;
        true
    }

    /// Steps until `samples` samples, from the run's beginning, are done or there are none left.
    pub fn advance_to(&mut self, samples: usize) {
        while self.done < samples && self.step() {}
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
        let of = |(place, filter): (usize, &FilterSettings)| {
            let mut smoothed = settings.smoothed(filter);
            smooth(filter, settings.surroundings(record.dt(), place), record, *done, &mut smoothed);
            smoothed
        };
        settings.filters.iter().enumerate().filter(|(_, f)| f.smoother).map(of).collect()
    }

    /// Every channel that the truth or a filter has.
    pub fn channels(&self) -> Vec<Channel> {
        let known =
            |c: &Channel| self.record().truth(*c).is_some() || self.estimates.iter().any(|e| e.place(*c).is_some());
        Channel::ALL.into_iter().filter(known).collect()
    }

    /// Checksum of all estimates that are kept, to compare platforms with.
    pub fn checksum(&self) -> u64 {
        self.estimates.iter().fold(0, |sum: u64, e| sum.rotate_left(1) ^ e.checksum())
    }
}

impl Settings {
    fn surroundings(&self, dt: f64, place: usize) -> Surroundings<'_> {
        Surroundings { plant: self.plant, sensors: &self.quantities, dt, seed: self.seed, place }
    }

    /// Empty estimates for a filter.
    fn estimates(&self, filter: &FilterSettings) -> Estimates {
        Estimates::new(filter, filter.plant.unwrap_or(self.plant), self.quantities.clone())
    }

    /// Empty estimates for what a filter's smoother knows. Sensors have told it nothing that they had not told the filter.
    fn smoothed(&self, filter: &FilterSettings) -> Estimates {
        let named = FilterSettings { name: format!("{}, smoothed", filter.name), ..filter.clone() };
        Estimates::new(&named, filter.plant.unwrap_or(self.plant), Vec::new())
    }
}
