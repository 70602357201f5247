//! The truth: the plant's exact response and what the sensors make of it.

use crate::propagation::ImpulseResponse;
use crate::random::{Normal, Purpose};
use crate::{Channel, Quantity, Record, Scenario};

/// Produces a record sample by sample, for as long as it is asked.
///
/// Force, disturbance and parameters are held over each step, and the response to that is exact
/// ([`ImpulseResponse::advance`]).
#[derive(Clone, Debug)]
pub struct Simulator {
    scenario: Scenario,
    force_noise: Normal,
    disturbance_noise: Normal,
    sensor_noise: Vec<Normal>,
    displacement: f64,
    velocity: f64,
    /// The last step's a, b and impulse response: parameters seldom change.
    last_response: Option<(f64, f64, ImpulseResponse)>,
}

impl Simulator {
    /// A simulator at t = 0 of a valid scenario.
    pub fn new(scenario: &Scenario) -> Self {
        let stream = |purpose| Normal::new(scenario.seed, purpose);
        Self {
            force_noise: stream(Purpose::Force),
            disturbance_noise: stream(Purpose::Disturbance),
            sensor_noise: scenario.sensors.iter().map(|s| stream(Purpose::Sensor(s.measures))).collect(),
            displacement: scenario.plant.initial.displacement,
            velocity: scenario.plant.initial.velocity,
            last_response: None,
            scenario: scenario.clone(),
        }
    }

    /// An empty record of the right shape.
    pub fn empty_record(&self) -> Record {
        let sensors = self.scenario.sensors.iter().map(|s| s.measures).collect();
        Record::empty(self.scenario.dt, sensors, Channel::ALL.to_vec())
    }

    /// Appends the next sample to `record`.
    pub fn step(&mut self, record: &mut Record) {
        let Self { scenario, force_noise, disturbance_noise, sensor_noise, displacement, velocity, last_response } =
            self;
        let dt = scenario.dt;
        let k = record.len();
        let t = k as f64 * dt;
        let wn = scenario.plant.natural_frequency.at(t);
        let zeta = scenario.plant.damping_ratio.at(t);
        let (a, b) = (-wn * wn, -2.0 * zeta * wn);
        let force = scenario.force.sample(k, dt, force_noise);
        let disturbance = scenario.plant.disturbance_std * disturbance_noise.sample();
        let (x, v) = (*displacement, *velocity);
        let acceleration = force + disturbance + b * v + a * x;

        let measured = scenario.sensors.iter().zip(sensor_noise).map(|(sensor, noise)| {
            let clean = match sensor.measures {
                Quantity::Displacement => x,
                Quantity::Velocity => v,
                Quantity::Acceleration => acceleration,
            };
            clean + sensor.noise_std * noise.sample()
        });
        record.push(force, measured, [x, v, wn, zeta]);

        let response = match last_response {
            Some((last_a, last_b, response)) if *last_a == a && *last_b == b => *response,
            _ => ImpulseResponse::new(a, b, dt),
        };
        *last_response = Some((a, b, response));
        [*displacement, *velocity] = response.advance(a, b, [x, v], acceleration);
    }
}
