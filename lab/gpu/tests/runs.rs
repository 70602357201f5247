//! Random runs of the oscillator, for the tests that hold filters side by side to the single one.

use kalmanscope_core::{Channel, FilterSettings, Force, Plant, Quantity, Scenario, Sensor, Signal, Values};
use proptest::prelude::*;

pub(crate) const CHANNELS: [Channel; 4] =
    [Channel::DISPLACEMENT, Channel::VELOCITY, Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO];

pub(crate) fn values(of: [f64; 4]) -> Values {
    Values::ZERO.with(CHANNELS.into_iter().zip(of))
}

pub(crate) fn size(exponents: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
    exponents.prop_map(|e| 10_f64.powf(e))
}

#[derive(Clone, Debug)]
pub(crate) struct Shaken {
    pub(crate) seed: u64,
    /// Time between samples \[s\], and the number of steps.
    pub(crate) steps: (f64, u32),
    /// True ωₙ \[rad/s\] and ζ.
    pub(crate) parameters: [f64; 2],
    /// Standard deviation of the force over mass \[m/s²\].
    pub(crate) force: f64,
}

impl Shaken {
    pub(crate) fn watched(&self, measured: &[Quantity], filters: Vec<FilterSettings>) -> Scenario {
        let Self { seed, steps: (dt, steps), parameters: [frequency, damping], force } = *self;
        let plant = Plant::default();
        let plant = plant.with(CHANNELS[2], Signal::Constant(frequency)).with(CHANNELS[3], Signal::Constant(damping));
        Scenario {
            seed,
            dt,
            duration: f64::from(steps) * dt,
            plant,
            force: Force::WhiteNoise { std: force },
            sensors: measured.iter().map(|&measures| Sensor::new(measures, 0.02)).collect(),
            filters,
            ..Scenario::default()
        }
    }
}
