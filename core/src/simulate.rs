//! The truth: the plant's response and what the sensors make of it.

use thiserror::Error;

use crate::gaussian::{Matrix, Vector};
use crate::model::{Model, Output};
use crate::plant::Visitor;
use crate::propagation::runge_kutta;
use crate::random::{Normal, Purpose};
use crate::sensor::MAX_SENSORS;
use crate::{Channel, Quantity, Record, Scenario};

/// Why a truth cannot go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum TruthError {
    /// The plant has run away, as one with a softening spring can, or a parameter's signal overflows.
    #[error("the true {} is no longer a finite number: the plant has run away", .0.name())]
    Channel(Channel),
    /// The force and the disturbance are too large for a number.
    #[error("the force is no longer a finite number")]
    Force,
    /// A sensor's reading is too large for a number.
    #[error("the sensor for {} no longer reads a finite number", .0.key())]
    Reading(Quantity),
}

/// Where a truth stopped, and why.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TruthStop {
    /// The number, from the run's beginning, of the first sample that the record lacks.
    pub sample: usize,
    /// What went wrong there.
    pub reason: TruthError,
}

/// Produces a record sample by sample, for as long as it is asked.
///
/// Force, disturbance and parameters are held over each step. The response to that is exact where the plant is linear
/// ([`Model::exact_integral`]); elsewhere it is of Runge-Kutta steps so short that their error is below 1e-9 of the signal.
pub struct Simulator {
    scenario: Scenario,
    force_noise: Normal,
    disturbance_noise: Normal,
    sensor_noise: Vec<Normal>,
    truth: Box<dyn Truth>,
    stop: Option<TruthStop>,
}

impl Simulator {
    /// A simulator at t = 0 of a valid scenario.
    pub fn new(scenario: &Scenario) -> Self {
        let stream = |purpose| Normal::new(scenario.seed, purpose);
        Self {
            force_noise: stream(Purpose::Force),
            disturbance_noise: stream(Purpose::Disturbance),
            sensor_noise: scenario.sensors.iter().map(|s| stream(Purpose::Sensor(s.measures))).collect(),
            truth: scenario.plant.kind.visit(0.0, Start(scenario)),
            scenario: scenario.clone(),
            stop: None,
        }
    }

    /// An empty record of the right shape.
    pub fn empty_record(&self) -> Record {
        let sensors = self.scenario.sensors.iter().map(|s| s.measures).collect();
        Record::empty(self.scenario.dt, sensors, self.scenario.plant.kind.channels().to_vec())
    }

    /// Where the truth stopped, if it could not go on.
    pub fn stop(&self) -> Option<TruthStop> {
        self.stop
    }

    /// Appends the next sample to `record`. Returns whether there was one: a plant that is not stable, such as one with a
    /// softening spring, can run away to where there are no numbers. [`Self::stop`] then says why.
    pub fn step(&mut self, record: &mut Record) -> bool {
        if self.stop.is_some() {
            return false;
        }
        let sample = record.forgotten() + record.len();
        self.stop = self.try_step(record).err().map(|reason| TruthStop { sample, reason });
        self.stop.is_none()
    }

    fn try_step(&mut self, record: &mut Record) -> Result<(), TruthError> {
        let Self { scenario, force_noise, disturbance_noise, sensor_noise, truth, stop: _ } = self;
        let dt = scenario.dt;
        let k = record.forgotten() + record.len();
        let t = k as f64 * dt;
        truth.set_parameters(&|channel| scenario.plant.parameter(channel).map_or(0.0, |signal| signal.at(t)));
        let force = scenario.force.sample(k, dt, force_noise);
        // A stream of its own: without a disturbance nobody misses it.
        let disturbance = match scenario.plant.disturbance_std {
            0.0 => 0.0,
            std => std * disturbance_noise.sample(),
        };
        if let Some(place) = truth.state().iter().position(|x| !x.is_finite()) {
            return Err(TruthError::Channel(scenario.plant.kind.channels()[place]));
        }
        if !(force + disturbance).is_finite() {
            return Err(TruthError::Force);
        }
        let mut measured = truth.readings(force + disturbance);
        for ((sensor, noise), reading) in scenario.sensors.iter().zip(sensor_noise).zip(&mut measured) {
            *reading += sensor.noise_std * noise.sample();
            if !reading.is_finite() {
                return Err(TruthError::Reading(sensor.measures));
            }
        }
        record.push(force, measured, truth.state().iter().copied());
        truth.advance(force + disturbance, dt);
        Ok(())
    }
}

/// A plant in motion, with its type and size erased.
trait Truth: Send {
    /// The state, channel by channel.
    fn state(&self) -> &[f64];

    /// Gives every parameter its present value.
    fn set_parameters(&mut self, value: &dyn Fn(Channel) -> f64);

    /// What perfect sensors read.
    fn readings(&self, force: f64) -> [f64; MAX_SENSORS];

    /// Moves on by a step.
    fn advance(&mut self, force: f64, dt: f64);
}

/// Sets a scenario's plant in motion.
struct Start<'a>(&'a Scenario);

impl Visitor for Start<'_> {
    type Output = Box<dyn Truth>;

    fn visit<P: Model<N>, const N: usize>(self, model: P) -> Box<dyn Truth> {
        let Scenario { plant, sensors, .. } = self.0;
        let mut state = Vector::<N>::zeros();
        for (component, channel) in state.iter_mut().zip(P::CHANNELS) {
            *component = match channel {
                Channel::Displacement => plant.initial.displacement,
                Channel::Velocity => plant.initial.velocity,
                _ => 0.0,
            };
        }
        let outputs = sensors.iter().map(|s| model.output(s.measures)).collect();
        Box::new(Moving { model, state, size: Vector::zeros(), outputs, last: None })
    }
}

struct Moving<P, const N: usize> {
    model: P,
    state: Vector<N>,
    /// The largest that each component has been.
    size: Vector<N>,
    outputs: Vec<Option<Output>>,
    /// The parameters of the last step and the exact integral that goes with them: parameters seldom change.
    last: Option<(Vector<N>, Matrix<N, N>)>,
}

impl<P: Model<N>, const N: usize> Truth for Moving<P, N> {
    fn state(&self) -> &[f64] {
        self.state.as_slice()
    }

    fn set_parameters(&mut self, value: &dyn Fn(Channel) -> f64) {
        for i in P::MOTION..N {
            self.state[i] = value(P::CHANNELS[i]);
        }
    }

    fn readings(&self, force: f64) -> [f64; MAX_SENSORS] {
        let rate = self.model.rate(&self.state, force);
        let mut readings = [f64::NAN; MAX_SENSORS];
        for (reading, output) in readings.iter_mut().zip(&self.outputs) {
            *reading = match output {
                Some(Output::State(i)) => self.state[*i],
                Some(Output::Rate(i)) => rate[*i],
                None => f64::NAN,
            };
        }
        readings
    }

    fn advance(&mut self, force: f64, dt: f64) {
        let Self { model, state, size, last, .. } = self;
        let same = |before: &Vector<N>| (P::MOTION..N).all(|i| before[i] == state[i]);
        if !last.as_ref().is_some_and(|(parameters, _)| same(parameters)) {
            *last = model.exact_integral(state, dt).map(|integral| (*state, integral));
        }
        match last {
            Some((_, integral)) => *state += *integral * model.rate(state, force),
            None => {
                *size = size.sup(&state.abs());
                *state = fine_steps(model, state, force, dt, size);
            }
        }
    }
}

/// How far a Runge-Kutta step may be from two of half its length, relative to the largest that each component has been.
/// What is left after extrapolation is a hundredth of that, and below 1e-9 of the signal after a minute.
const ACCURACY: f64 = 3e-12;

/// The most steps that one sample is halved into, whatever the plant does.
const MAX_STEPS: u32 = 4096;

/// Runge-Kutta steps as short as it takes, which is shorter around kinks of the rate.
fn fine_steps<P: Model<N>, const N: usize>(
    model: &P,
    state: &Vector<N>,
    force: f64,
    dt: f64,
    size: &Vector<N>,
) -> Vector<N> {
    let rate = |y: &Vector<N>| model.rate(y, force);
    let mut halvings = MAX_STEPS;
    refined(&rate, state, runge_kutta(state, dt, rate), dt, size, &mut halvings)
}

/// The step that `coarse` takes in one, halved again and again until it makes no difference, and then extrapolated.
///
/// Source: Hairer, Nørsett and Wanner (1993), *Solving Ordinary Differential Equations I*, section II.4.
fn refined<const N: usize>(
    rate: &impl Fn(&Vector<N>) -> Vector<N>,
    state: &Vector<N>,
    coarse: Vector<N>,
    dt: f64,
    size: &Vector<N>,
    halvings: &mut u32,
) -> Vector<N> {
    let half = 0.5 * dt;
    let middle = runge_kutta(state, half, rate);
    let fine = runge_kutta(&middle, half, rate);
    let difference = fine - coarse;
    if *halvings == 0 || (0..N).all(|i| difference[i].abs() <= ACCURACY * size[i].max(fine[i].abs())) {
        return fine + difference / 15.0;
    }
    *halvings -= 1;
    let middle = refined(rate, state, middle, half, size, halvings);
    refined(rate, &middle, runge_kutta(&middle, half, rate), half, size, halvings)
}
