//! One filter of a scenario over samples that come in one by one.

mod clock;
mod error;

use crate::samples::sink::{LastSample, Sample, Sink};
use crate::{Channel, Hold, Pass, Quantity, Record, RunError, Scenario, Stop};

use clock::Clock;

pub use error::OnlineError;

/// A filter of a scenario that takes in samples as they are measured: a sample comes in, an estimate comes out, with the same
/// bits as a [`Pass`] over a record of these samples.
///
/// The first sample sets the time: its estimate is the initial belief, and its readings do not count, as in every run. Later
/// samples follow `dt` after each other. A gap of some more steps of dt is filled with predictions: no sensor reads anything
/// there, and the input goes on as the scenario holds it between samples: at the value before the gap with
/// [`Hold::Zero`], on the line to the value after it with [`Hold::First`].
///
/// A first-order hold asks for nothing more: the step to a sample needs the inputs at both its ends, which are there. A
/// negative input delay of d samples ([`FilterSettings::input_delay`](crate::FilterSettings::input_delay)) does, and so does a sensor
/// that is late by d ([`FilterSettings::sensor_delay`](crate::FilterSettings::sensor_delay)): the plant feels an input d samples before it
/// is recorded, so that the estimate of a sample is computed when the d-th sample after it comes in ([`Self::latency`]).
/// [`Self::finish`] computes the last d.
///
/// A sample that is refused leaves the filter as it was.
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
    clock: Clock,
    channels: Vec<Channel>,
    /// The samples that the filter has yet to read.
    record: Record,
    /// No reading of any sensor.
    nothing: Vec<f64>,
    latency: usize,
    /// The samples before the next one that the filter reads.
    reach: usize,
    last: LastSample,
}

/// Forget samples only when there are this many, since forgetting moves all others.
const FORGET: usize = 64;

impl OnlineFilter {
    /// The filter at `place` of a scenario, before its first sample.
    ///
    /// # Errors
    /// [`RunError::Scenario`] where the scenario is impossible, [`RunError::NoFilter`] where there is no such filter.
    pub fn new(scenario: &Scenario, place: usize) -> Result<Self, RunError> {
        let quantities: Vec<Quantity> = scenario.sensors.iter().map(|sensor| sensor.measures).collect();
        let nothing = vec![f64::NAN; quantities.len()];
        let record = Record::empty(scenario.dt, scenario.input, scenario.hold, quantities, Vec::new());
        let pass = Pass::new(scenario, place, &record)?;
        let channels = Pass::history(scenario, place)?.channels().to_vec();
        let delays = scenario.filters[place].delays(scenario.dt);
        let (latency, reach) = (delays.lookahead(), delays.reach());
        let clock = Clock::new(scenario.dt);
        Ok(Self { pass, clock, channels, record, nothing, latency, reach, last: LastSample::default() })
    }

    /// The components of the state, in the order of every mean and covariance.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// The quantity of each reading.
    pub fn sensors(&self) -> &[Quantity] {
        self.record.sensors()
    }

    /// The number of samples by which an estimate is behind the sample that comes in: 0 unless the input delay is negative or a sensor late.
    pub fn latency(&self) -> usize {
        self.latency
    }

    /// The number of samples with an estimate.
    pub fn done(&self) -> usize {
        self.pass.done()
    }

    /// Where and why the filter stopped, if it did.
    pub fn stop(&self) -> Option<Stop> {
        self.pass.stop()
    }

    /// Takes in a sample: its time \[s\], the input \[m/s²\] in the scenario's meaning, and a reading for each of the
    /// scenario's sensors in the unit of its quantity, NaN where it has none. Returns the estimate of this sample, or
    /// of the one [`Self::latency`] samples before; `None` while there is no such sample. It has the belief before the
    /// update too.
    ///
    /// # Errors
    /// [`OnlineError`]: for a time that is not a whole number of steps of dt after the last one, within
    /// [`OnlineError::TOLERANCE`] of dt, for a gap of more than [`OnlineError::MOST_STEPS`], for readings of another number
    /// and for numbers that are not finite, the sample is refused; [`OnlineError::Stopped`] where the filter has failed, then
    /// and from then on.
    pub fn step(&mut self, time: f64, input: f64, readings: &[f64]) -> Result<Option<Sample<'_>>, OnlineError> {
        let done = self.done();
        let mut last = std::mem::take(&mut self.last);
        let step = self.step_into(time, input, readings, &mut last);
        self.last = last;
        step?;
        Ok((self.done() > done).then(|| self.last.sample()))
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
        if let Some(stop) = self.stop() {
            return Err(OnlineError::Stopped(stop));
        }
        self.check(input, readings)?;
        let steps = self.clock.advance(time)?;
        let before = self.record.input().last().copied().unwrap_or(input);
        for step in 1..steps {
            let share = step as f64 / steps as f64;
            let held = match self.record.hold() {
                Hold::Zero => before,
                Hold::First => before + (input - before) * share,
            };
            self.record.push(held, self.nothing.iter().copied(), []);
            self.follow(self.latency, sink)?;
        }
        self.record.push(input, readings.iter().copied(), []);
        self.follow(self.latency, sink)
    }

    /// Computes the last [`Self::latency`] samples as a record does at its end: the last input holds from then on.
    ///
    /// # Errors
    /// [`OnlineError::Stopped`] where the filter has failed.
    pub fn finish(mut self, sink: &mut dyn Sink) -> Result<(), OnlineError> {
        self.follow(0, sink)
    }

    fn check(&self, input: f64, readings: &[f64]) -> Result<(), OnlineError> {
        let sensors = self.sensors();
        if readings.len() != sensors.len() {
            return Err(OnlineError::Readings { found: readings.len(), expected: sensors.len() });
        }
        if !input.is_finite() {
            return Err(OnlineError::Input(input));
        }
        match sensors.iter().zip(readings).find(|(_, reading)| reading.is_infinite()) {
            Some((&sensor, _)) => Err(OnlineError::InfiniteReading(sensor)),
            None => Ok(()),
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
