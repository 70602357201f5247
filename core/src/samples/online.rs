//! One filter of a scenario over samples that come in one by one: a pass over a record that grows.

use thiserror::Error;

use crate::samples::sink::{LastSample, Sample, Sink};
use crate::{Channel, Hold, Pass, Quantity, Record, RunError, Scenario, Stop};

/// A filter of a scenario that takes in samples as they are measured: a sample comes in, an estimate comes out, with the same
/// bits as a [`Pass`] over a record of these samples.
///
/// The first sample sets the time: its estimate is the initial belief, and its readings do not count, as in every run. Later
/// samples follow `dt` after each other. A gap of some more steps is filled with predictions: no sensor reads anything
/// there, and the input goes on as the scenario holds it between samples. Where the input or a sensor is late by d samples
/// ([`FilterSettings::input_delay`](crate::FilterSettings::input_delay) below zero,
/// [`FilterSettings::sensor_delay`](crate::FilterSettings::sensor_delay)), the estimate of a sample comes with the d-th after it
/// ([`Self::latency`]); [`Self::finish`] computes the last d. A sample that is refused leaves the filter as it was.
///
/// ```
/// use kalmanscope_core::{OnlineFilter, Scenario};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let scenario = Scenario::from_toml("dt = 0.01\n[[filters]]\nkind = \"ukf\"")?;
/// let mut filter = OnlineFilter::new(&scenario, 0)?;
/// for k in 0..100 {
///     let (time, force) = (0.01 * f64::from(k), 1.0);
///     let (displacement, velocity) = (0.005 * time, f64::NAN);
///     if let Some(sample) = filter.step(time, force, &[displacement, velocity])? {
///         assert_eq!(sample.mean.len(), 4);
///     }
/// }
/// let refused = filter.step(0.995, 1.0, &[0.0, 0.0]).map(|_| ());
/// assert!(refused.is_err_and(|error| error.to_string().contains("0.5 steps of 0.01 s")));
/// # Ok(())
/// # }
/// ```
pub struct OnlineFilter {
    pass: Pass,
    channels: Vec<Channel>,
    /// The samples that the filter has yet to read, and some before them.
    record: Record,
    latency: usize,
    /// The samples before the next one that the filter reads.
    reach: usize,
    time: Option<f64>,
    last: LastSample,
}

/// The reason why a sample has no estimate.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum OnlineError {
    /// The filter has failed, at this sample or before.
    #[error("the filter has stopped at sample {}: {}", .0.sample, .0.reason)]
    Stopped(Stop),
    /// The sample cannot be taken in: what is wrong with it, in words.
    #[error("{0}")]
    Refused(String),
}

/// Limits the distance of a time from a whole number of steps, in steps, and the steps of a gap that is filled.
const TOLERANCE: f64 = 0.01;
const MOST_STEPS: f64 = 1e5;

/// Forget samples only when there are this many, since forgetting moves all others.
const FORGET: usize = 64;

impl OnlineFilter {
    /// The filter at `place` of a scenario, before its first sample.
    ///
    /// # Errors
    /// [`RunError::Scenario`] where the scenario is impossible, [`RunError::NoFilter`] where there is no such filter.
    pub fn new(scenario: &Scenario, place: usize) -> Result<Self, RunError> {
        let quantities: Vec<Quantity> = scenario.sensors.iter().map(|sensor| sensor.measures).collect();
        let record = Record::empty(scenario.dt, scenario.input, scenario.hold, quantities, Vec::new());
        let pass = Pass::new(scenario, place, &record)?;
        let channels = Pass::history(scenario, place)?.channels().to_vec();
        let delays = scenario.filters[place].delays(scenario.dt);
        let (latency, reach) = (delays.lookahead(), delays.reach());
        Ok(Self { pass, channels, record, latency, reach, time: None, last: LastSample::default() })
    }

    /// The components of the state, in the order of every mean and covariance.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// The number of samples by which an estimate is behind the sample that comes in.
    pub fn latency(&self) -> usize {
        self.latency
    }

    /// Takes in a sample: its time \[s\], the input \[m/s²\] in the scenario's meaning, and a reading for each of the
    /// scenario's sensors in the unit of its quantity, NaN where it has none. Returns the estimate of this sample, or
    /// of the one [`Self::latency`] samples before; `None` while there is no such sample.
    ///
    /// # Errors
    /// [`OnlineError`]; after [`OnlineError::Stopped`] there are no more estimates.
    pub fn step(&mut self, time: f64, input: f64, readings: &[f64]) -> Result<Option<Sample<'_>>, OnlineError> {
        let done = self.pass.done();
        let mut last = std::mem::take(&mut self.last);
        let step = self.step_into(time, input, readings, &mut last);
        self.last = last;
        step?;
        Ok((self.pass.done() > done).then(|| self.last.sample()))
    }

    /// [`Self::step`] that reports every sample of the step, those that fill a gap too, to a sink.
    ///
    /// # Errors
    /// Those of [`Self::step`].
    pub fn step_into(
        &mut self,
        time: f64,
        input: f64,
        readings: &[f64],
        sink: &mut dyn Sink,
    ) -> Result<(), OnlineError> {
        if let Some(stop) = self.pass.stop() {
            return Err(OnlineError::Stopped(stop));
        }
        let steps = self.steps_to(time, input, readings).map_err(OnlineError::Refused)?;
        self.time = Some(time);
        let before = self.record.input().last().copied().unwrap_or(input);
        for step in 1..=steps {
            let is_last = step == steps;
            let between = before + (input - before) * (step as f64 / steps as f64);
            let held = if self.record.hold() == Hold::Zero { before } else { between };
            let reading = readings.iter().map(|reading| if is_last { *reading } else { f64::NAN });
            self.record.push(if is_last { input } else { held }, reading, []);
            self.follow(self.latency, sink)?;
        }
        Ok(())
    }

    /// Computes the last [`Self::latency`] samples as a record does at its end: the last input holds from then on.
    ///
    /// # Errors
    /// [`OnlineError::Stopped`] where the filter has failed.
    pub fn finish(mut self, sink: &mut dyn Sink) -> Result<(), OnlineError> {
        self.follow(0, sink)
    }

    /// The steps from the last sample to one that can be taken in, or what is wrong with it.
    fn steps_to(&self, time: f64, input: f64, readings: &[f64]) -> Result<usize, String> {
        let (sensors, dt) = (self.record.sensors(), self.record.dt());
        if readings.len() != sensors.len() {
            let (found, expected) = (readings.len(), sensors.len());
            return Err(format!("there are {found} readings of {expected} sensors: a missing reading is NaN"));
        }
        if let Some((sensor, _)) = sensors.iter().zip(readings).find(|(_, reading)| reading.is_infinite()) {
            return Err(format!("the reading of {} is infinite, but must be a number or NaN", sensor.key()));
        }
        if !time.is_finite() || !input.is_finite() {
            return Err(format!("the time is {time} s and the input {input}, but both must be finite numbers"));
        }
        let Some(last) = self.time else { return Ok(1) };
        let steps = (time - last) / dt;
        let whole = libm::round(steps);
        let what = || {
            format!("the time is {time} s, {} steps of {dt} s after the last sample", libm::round(steps * 1e3) / 1e3)
        };
        match whole {
            _ if (steps - whole).abs() > TOLERANCE || whole < 1.0 => {
                Err(format!("{}, but must be a whole number", what()))
            }
            _ if whole > MOST_STEPS => {
                Err(format!("{}, but at most {MOST_STEPS} are filled: begin a new filter", what()))
            }
            _ => Ok(whole as usize),
        }
    }

    /// Computes all samples but the last few, and forgets those that have been read.
    fn follow(&mut self, but: usize, sink: &mut dyn Sink) -> Result<(), OnlineError> {
        let Self { pass, record, reach, .. } = self;
        pass.follow(record, (record.forgotten() + record.len()).saturating_sub(but), sink);
        let read = pass.done().saturating_sub(record.forgotten() + *reach + 1);
        if read >= FORGET {
            record.forget(read);
        }
        pass.stop().map_or(Ok(()), |stop| Err(OnlineError::Stopped(stop)))
    }
}
