//! Sources of samples, and the simulation of the truth: the plant's response and the sensors' measurements.

pub(crate) mod response;

use std::collections::VecDeque;
use std::sync::Arc;

use kalmanscope_filters::lists::mapped;
use kalmanscope_filters::random::{Normal, Purpose};
use kalmanscope_filters::{Channel, ForcedMass, Hold, Quantity, Reading};
use kalmanscope_records::Record;
use thiserror::Error;

use crate::run::forces::Forces;
use crate::scenario::fault::{Act, FaultStage, Moment};
use crate::{Force, Model, Scenario, Signal};
use response::{HALVED, Response};

/// The reason why a truth cannot continue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum TruthError {
    /// The plant diverges, as one with a softening spring can, or a parameter's signal overflows.
    #[error("the true {} is no longer a finite number: the plant is unstable", .0.name())]
    Channel(Channel),
    /// The force and the disturbance overflow.
    #[error("the force is no longer a finite number")]
    Force,
    /// A sensor's reading overflows.
    #[error("the sensor for {} no longer reads a finite number", .0.key())]
    Reading(Quantity),
    /// The plant oscillates too fast to be integrated between two samples.
    #[error("the plant moves too fast between two samples: dt is too long for it")]
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
/// Disturbance and parameters are held over each step. A linear plant's response is exact, others' to 1e-9 of the signal.
pub struct Simulator {
    scenario: Scenario,
    inputs: InputSignal,
    /// Forces on single masses: the recorded ones, and those that act in the plant.
    forces: Vec<(ForcedMass, InputSignal)>,
    acting: Forces,
    disturbance_noise: Normal,
    sensor_noise: Vec<Normal>,
    faults: Vec<Vec<Act>>,
    model: Model,
    signals: Vec<Signal>,
    readings: Vec<Option<Reading>>,
    measured: Vec<f64>,
    state: Vec<f64>,
    response: Response,
    load: Option<Load>,
    /// Where and why the truth stopped, if it did.
    pub stop: Option<TruthStop>,
}

struct Load {
    recorded: f64,
    /// The recorded forces over mass at its beginning and at its end \[m/s²\].
    forces: [f64; 2],
    /// The unrecorded one \[m/s²\].
    disturbance: f64,
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
        let signal_of = |force: Force, purpose: Purpose| InputSignal {
            force,
            dt: scenario.dt,
            noise: stream(purpose),
            first: 0,
            kept: VecDeque::new(),
        };
        let forced: Vec<ForcedMass> = scenario.forces.keys().copied().collect();
        Self {
            inputs: signal_of(scenario.force, Purpose::Force),
            forces: scenario.forces.iter().map(|(on, force)| (*on, signal_of(*force, Purpose::ForceOn(*on)))).collect(),
            acting: Forces::of(model.channels(), &forced, scenario.hold),
            disturbance_noise: stream(Purpose::Disturbance),
            sensor_noise: mapped(&scenario.sensors, &|s| stream(Purpose::Sensor(s.measures))),
            faults: mapped(&scenario.sensors, &|s| s.faults.acts(s.measures, scenario.seed)),
            signals: mapped(&model.channels()[model.motion()..], &signal),
            readings: mapped(&scenario.sensors, &|s| model.reading(s.measures)),
            measured: Vec::with_capacity(scenario.sensors.len()),
            state: Vec::with_capacity(model.channels().len()),
            response: Response::new(model.channels().iter().map(initial)),
            model,
            scenario: scenario.clone(),
            load: None,
            stop: None,
        }
    }

    /// An empty record with the columns of the scenario.
    pub fn empty_record(&self) -> Record {
        let Scenario { dt, input, hold, sensors, .. } = &self.scenario;
        let sensors = mapped(sensors, &|s| s.measures);
        let forced = self.forces.iter().map(|(on, _)| *on).collect();
        Record::empty(*dt, *input, *hold, sensors, self.model.channels().to_vec()).with_columns_of(forced)
    }

    /// Appends the next sample to `record`. Returns whether there was one; else [`Self::stop`] has the reason.
    pub fn step(&mut self, record: &mut Record) -> bool {
        let before = place_of_next(record);
        while !self.advance(record, u64::MAX) {}
        place_of_next(record) > before
    }

    /// Appends samples until `record` has `samples`, for about a millisecond. Returns whether the truth lasts until then.
    pub fn advance_some(&mut self, record: &mut Record, samples: usize) -> bool {
        let end = self.response.halved + HALVED;
        while place_of_next(record) < samples && self.response.halved < end {
            self.advance(record, end - self.response.halved);
            if self.stop.is_some() {
                return place_of_next(record) >= samples;
            }
        }
        true
    }

    /// Computes the next sample and halves steps at most `most` times. Returns whether the sample is done, or the truth has stopped.
    fn advance(&mut self, record: &mut Record, most: u64) -> bool {
        if self.stop.is_some() {
            return true;
        }
        let sample = place_of_next(record);
        let load = self.load.take().map_or_else(|| self.sample(sample), Ok);
        let is_done = load.and_then(|load| {
            let Load { recorded, forces, disturbance } = load;
            let inputs = self.acting.over(forces);
            let is_done = self.response.advance(&self.model, inputs, disturbance, self.scenario.dt, most);
            if is_done == Ok(false) {
                self.load = Some(load);
            } else {
                record.push(recorded, self.measured.iter().copied(), self.state.iter().copied());
                record.push_forces(self.forces.iter_mut().map(|(_, force)| force.at(sample)));
            }
            is_done
        });
        is_done.unwrap_or_else(|reason| {
            self.stop = Some(TruthStop { sample: place_of_next(record), reason });
            true
        })
    }

    fn sample(&mut self, k: usize) -> Result<Load, TruthError> {
        let Self { scenario, inputs, forces, acting, disturbance_noise, sensor_noise, faults, .. } = self;
        let Self { model, signals, readings, measured, state, .. } = self;
        let response = &mut self.response;
        let t = k as f64 * scenario.dt;
        for (place, signal) in signals.iter().enumerate() {
            response.state[model.motion() + place] = signal.at(t);
        }
        // The disturbance has its own random stream, so skipping its draws changes no other number.
        let disturbance = match scenario.plant.disturbance_std {
            0.0 => 0.0,
            std => std * disturbance_noise.sample(),
        };
        let recorded = inputs.at(k);
        // Before the record the first input holds.
        let ahead = -scenario.plant.input_delay as isize;
        let felt = |k: usize| k.saturating_add_signed(ahead);
        let [force, next] = [k, k + 1].map(|k| scenario.input.force(inputs.at(felt(k))));
        acting.set(forces.iter_mut().map(|(on, force)| (*on, [k, k + 1].map(|k| force.at(felt(k))))));
        state.clear();
        state.extend_from_slice(response.state.as_slice());
        if let Some(place) = state.iter().position(|x| !x.is_finite()) {
            return Err(TruthError::Channel(model.channels()[place]));
        }
        if !(force + disturbance).is_finite() || !acting.is_finite() {
            return Err(TruthError::Force);
        }
        measured.clear();
        for (((sensor, noise), faults), reading) in scenario.sensors.iter().zip(sensor_noise).zip(faults).zip(readings)
        {
            let moment = Moment { time: t, dt: scenario.dt, noise_std: sensor.noise_std };
            let mut act = |stage: FaultStage, value: f64| {
                faults.iter_mut().fold(value, |value, fault| fault.apply(stage, value, &moment))
            };
            let exact = reading
                .as_ref()
                .map_or(f64::NAN, |r| model.read_disturbed(r, state, acting.over([force; 2])[0], disturbance));
            let exact = act(FaultStage::Exact, exact);
            let value = exact + sensor.noise_std * act(FaultStage::Noise, noise.sample());
            if !value.is_finite() {
                return Err(TruthError::Reading(sensor.measures));
            }
            let reported = act(FaultStage::Reading, value);
            if reported.is_infinite() {
                return Err(TruthError::Reading(sensor.measures));
            }
            measured.push(reported);
        }
        let first = (k + 1).saturating_sub(scenario.plant.input_delay.max(0) as usize);
        inputs.forget_before(first);
        // The record takes the forces of this sample after the step.
        forces.iter_mut().for_each(|(_, force)| force.forget_before(first.min(k)));
        let end = match scenario.hold {
            Hold::Zero => force,
            Hold::First => next,
        };
        Ok(Load { recorded, forces: [force, end], disturbance })
    }
}

/// The record of a valid scenario, as far as its truth goes.
pub fn simulate(scenario: &Scenario) -> Record {
    let mut simulator = Simulator::new(scenario);
    let mut record = simulator.empty_record();
    while record.len() < scenario.samples() && simulator.step(&mut record) {}
    record
}

fn place_of_next(record: &Record) -> usize {
    record.forgotten() + record.len()
}

struct InputSignal {
    force: Force,
    dt: f64,
    noise: Normal,
    first: usize,
    kept: VecDeque<f64>,
}

impl InputSignal {
    fn at(&mut self, k: usize) -> f64 {
        while self.first + self.kept.len() <= k {
            let next = self.force.sample(self.first + self.kept.len(), self.dt, &mut self.noise);
            self.kept.push_back(next);
        }
        self.kept[k - self.first]
    }

    fn forget_before(&mut self, k: usize) {
        while self.first < k && self.kept.pop_front().is_some() {
            self.first += 1;
        }
    }
}

/// The source of a run's samples.
#[derive(Clone, Debug, Default)]
pub enum Source {
    /// A simulation of the scenario's truth.
    #[default]
    Simulated,
    /// A given record. Its time between samples replaces the scenario's.
    Measured(Arc<Record>),
    /// A given record to which samples are still added: [`Run::lengthen`](crate::Run::lengthen). Smoothers and free runs, which need the end, wait.
    Live(Arc<Record>),
}

impl Source {
    /// The record, if it is given.
    pub fn record(&self) -> Option<&Arc<Record>> {
        match self {
            Self::Simulated => None,
            Self::Measured(record) | Self::Live(record) => Some(record),
        }
    }

    /// Whether the samples are measured, not simulated.
    pub fn is_measured(&self) -> bool {
        self.record().is_some()
    }
}

/// Limits the samples of a truth that are simulated between two checks of the time: about 0.3 ms.
const CHUNK: usize = 500;

pub(crate) struct Recording {
    pub(crate) simulator: Option<Box<Simulator>>,
    pub(crate) record: Arc<Record>,
    pub(crate) is_live: bool,
}

impl Recording {
    pub(crate) fn new(scenario: &Scenario, source: Source, spare: Option<Record>) -> Self {
        match source {
            Source::Measured(record) => Self { simulator: None, record, is_live: false },
            Source::Live(record) => Self { simulator: None, record, is_live: true },
            Source::Simulated => {
                let simulator = Box::new(Simulator::new(scenario));
                let mut record = simulator.empty_record();
                if let Some(spare) = spare {
                    record.recycle(spare);
                }
                Self { simulator: Some(simulator), record: Arc::new(record), is_live: false }
            }
        }
    }

    pub(crate) fn source(&self) -> Source {
        match (&self.simulator, self.is_live) {
            (Some(_), _) => Source::Simulated,
            (None, false) => Source::Measured(Arc::clone(&self.record)),
            (None, true) => Source::Live(Arc::clone(&self.record)),
        }
    }

    pub(crate) fn into_simulated(self) -> Option<Record> {
        self.simulator.and_then(|_| Arc::into_inner(self.record))
    }

    /// The samples that a filter can do: of a live record, those whose later inputs are there as far as the filter reads them.
    pub(crate) fn samples(&self, scenario: &Scenario) -> usize {
        match &self.simulator {
            Some(_) => scenario.samples(),
            None if self.is_live => self.record.len().saturating_sub(lookahead(scenario, self.record.dt())),
            None => self.record.len(),
        }
    }

    pub(crate) fn len(&self) -> usize {
        place_of_next(&self.record)
    }

    /// Up to sample `samples` of `all`, which are fewer where the truth diverges. Returns false early if `while_time` does.
    pub(crate) fn advance(&mut self, samples: usize, all: &mut usize, while_time: &mut dyn FnMut() -> bool) -> bool {
        while self.len() < samples.min(*all) {
            let next = (self.len() + CHUNK).min(samples).min(*all);
            let Some(simulator) = &mut self.simulator else {
                *all = self.len();
                break;
            };
            if !simulator.advance_some(Arc::make_mut(&mut self.record), next) {
                *all = self.len();
            } else if self.len() < samples.min(*all) && !while_time() {
                return false;
            }
        }
        true
    }

    pub(crate) fn lengthen(&mut self, longer: Arc<Record>) -> bool {
        let continues = self.is_live && longer.goes_on_from(&self.record);
        if continues {
            self.record = longer;
        }
        continues
    }

    pub(crate) fn forget(&mut self, samples: usize) -> bool {
        let is_simulated = self.simulator.is_some();
        if is_simulated {
            Arc::make_mut(&mut self.record).forget(samples);
        }
        is_simulated
    }
}

/// The number of samples, `dt` \[s\] apart, beyond its last one that a filter of a scenario reads of the record.
pub(crate) fn lookahead(scenario: &Scenario, dt: f64) -> usize {
    scenario.filters.iter().map(|filter| filter.delays(dt).lookahead()).max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HARD: &str = include_str!("../../../tests/hostile/hard-truth.toml");

    #[test]
    fn a_piece_of_a_hard_truth_halves_few_steps_and_the_record_is_that_of_whole_samples() {
        const SAMPLES: usize = 6;
        let scenario = Scenario::from_toml(HARD).unwrap();
        let mut whole = Simulator::new(&scenario);
        let mut expected = whole.empty_record();
        (0..SAMPLES).for_each(|_| assert!(whole.step(&mut expected)));
        assert!(whole.response.halved > 1000 * SAMPLES as u64, "the steps of a sample are halved often");
        let mut simulator = Simulator::new(&scenario);
        let mut record = simulator.empty_record();
        let mut pieces = 0;
        while record.len() < SAMPLES {
            let before = simulator.response.halved;
            assert!(simulator.advance_some(&mut record, SAMPLES));
            assert!(simulator.response.halved - before <= HALVED);
            pieces += 1;
        }
        assert!(pieces as u64 >= whole.response.halved / HALVED, "{pieces}");
        for sensor in 0..record.sensors().len() {
            assert_eq!(record.measured(sensor), expected.measured(sensor));
        }
        assert_eq!(record.truth(Channel::DISPLACEMENT), expected.truth(Channel::DISPLACEMENT));
    }
}
