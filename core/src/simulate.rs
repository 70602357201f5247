//! The simulation of the truth: the plant's response and the sensors' measurements.

mod inputs;
pub(crate) mod response;

use thiserror::Error;

use crate::model::{Hold, Model, Reading};
use crate::random::{Normal, Purpose};
use crate::{Channel, Quantity, Record, Scenario, Signal};

use inputs::Inputs;
use response::Response;

/// The reason why a truth cannot go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum TruthError {
    /// The plant diverges, as one with a softening spring can, or a parameter's signal overflows.
    #[error("the true {} is no longer a finite number: the plant has run away", .0.name())]
    Channel(Channel),
    /// The force and the disturbance overflow.
    #[error("the force is no longer a finite number")]
    Force,
    /// A sensor's reading overflows.
    #[error("the sensor for {} no longer reads a finite number", .0.key())]
    Reading(Quantity),
    /// The plant oscillates too fast to be integrated between two samples.
    #[error("the plant swings too fast to be followed from one sample to the next: dt is too long for it")]
    StepTooLong,
}

/// The sample at which a truth stopped, and the reason.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TruthStop {
    /// The number, counted from the run's beginning, of the first sample that the record lacks.
    pub sample: usize,
    /// The reason.
    pub reason: TruthError,
}

/// Simulates a record sample by sample, without an end.
///
/// Disturbance and parameters are held over each step, the input by the scenario's hold. The response of a linear plant
/// is exact. For other plants, Runge-Kutta steps are refined until their error is below 1e-9 of the signal.
pub struct Simulator {
    scenario: Scenario,
    inputs: Inputs,
    disturbance_noise: Normal,
    sensor_noise: Vec<Normal>,
    model: Model,
    /// The signals of the components that do not move.
    signals: Vec<Signal>,
    readings: Vec<Option<Reading>>,
    /// The measurements of one sample.
    measured: Vec<f64>,
    response: Response,
    stop: Option<TruthStop>,
}

impl Simulator {
    /// A simulator at t = 0 of a valid scenario.
    pub fn new(scenario: &Scenario) -> Self {
        let stream = |purpose| Normal::new(scenario.seed, purpose);
        let model = scenario.plant.model(scenario.input);
        let initial = |channel: &Channel| match *channel {
            c if c == Channel::DISPLACEMENT => scenario.plant.initial.displacement,
            c if c == Channel::VELOCITY => scenario.plant.initial.velocity,
            _ => 0.0,
        };
        let signal = |channel: &Channel| scenario.plant.parameter(*channel).unwrap_or(Signal::Constant(0.0));
        Self {
            inputs: Inputs::new(scenario.force, scenario.dt, stream(Purpose::Force)),
            disturbance_noise: stream(Purpose::Disturbance),
            sensor_noise: scenario.sensors.iter().map(|s| stream(Purpose::Sensor(s.measures))).collect(),
            signals: model.channels()[model.motion()..].iter().map(signal).collect(),
            readings: scenario.sensors.iter().map(|s| model.reading(s.measures)).collect(),
            measured: Vec::with_capacity(scenario.sensors.len()),
            response: Response::new(model.channels().iter().map(initial)),
            model,
            scenario: scenario.clone(),
            stop: None,
        }
    }

    /// An empty record with the columns of the scenario.
    pub fn empty_record(&self) -> Record {
        let Scenario { dt, input, hold, sensors, .. } = &self.scenario;
        let sensors = sensors.iter().map(|s| s.measures).collect();
        Record::empty(*dt, *input, *hold, sensors, self.model.channels().to_vec())
    }

    /// Where and why the truth stopped, if it did.
    pub fn stop(&self) -> Option<TruthStop> {
        self.stop
    }

    /// The number of times that steps have been halved so far, which tells the time that the truth takes.
    pub(crate) fn halved(&self) -> u64 {
        self.response.halved()
    }

    /// Appends the next sample to `record`. Returns whether there was one: an unstable plant, such as one with a
    /// softening spring, can diverge beyond the largest number. [`Self::stop`] then has the reason.
    pub fn step(&mut self, record: &mut Record) -> bool {
        if self.stop.is_some() {
            return false;
        }
        let sample = record.forgotten() + record.len();
        if let Err(reason) = self.try_step(record) {
            let complete = record.forgotten() + record.len();
            self.stop = Some(TruthStop { sample: complete, reason });
        }
        record.forgotten() + record.len() > sample
    }

    fn try_step(&mut self, record: &mut Record) -> Result<(), TruthError> {
        let Self {
            scenario,
            inputs,
            disturbance_noise,
            sensor_noise,
            model,
            signals,
            readings,
            measured,
            response,
            stop: _,
        } = self;
        let dt = scenario.dt;
        let k = record.forgotten() + record.len();
        let t = k as f64 * dt;
        for (place, signal) in signals.iter().enumerate() {
            response.set(model.motion() + place, signal.at(t));
        }
        // The disturbance has its own random stream, so skipping its draws changes no other number.
        let disturbance = match scenario.plant.disturbance_std {
            0.0 => 0.0,
            std => std * disturbance_noise.sample(),
        };
        let recorded = inputs.at(k);
        let mut acting = |k: usize| scenario.input.force(inputs.delayed(k, scenario.plant.input_delay));
        let (force, next) = (acting(k), acting(k + 1));
        let state = response.state();
        if let Some(place) = state.iter().position(|x| !x.is_finite()) {
            return Err(TruthError::Channel(model.channels()[place]));
        }
        if !(force + disturbance).is_finite() {
            return Err(TruthError::Force);
        }
        measured.clear();
        for ((sensor, noise), reading) in scenario.sensors.iter().zip(sensor_noise).zip(readings) {
            let exact = reading.as_ref().map_or(f64::NAN, |r| model.read_disturbed(r, state, force, disturbance));
            let value = exact + sensor.noise_std * noise.sample();
            if !value.is_finite() {
                return Err(TruthError::Reading(sensor.measures));
            }
            measured.push(value);
        }
        record.push(recorded, measured.iter().copied(), state.iter().copied());
        inputs.forget_before((k + 1).saturating_sub(scenario.plant.input_delay.max(0) as usize));
        let end = match scenario.hold {
            Hold::Zero => force,
            Hold::First => next,
        };
        response.advance(model, [force, end], disturbance, dt)
    }
}
