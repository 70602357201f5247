//! One number for each channel, as a table in scenario files.

use std::ops::{Index, IndexMut};

use serde::{Deserialize, Deserializer, Serialize};

use crate::Channel;

/// One number for each channel, in the channel's unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PerChannel {
    /// \[m\]
    pub displacement: f64,
    /// \[m/s\]
    pub velocity: f64,
    /// \[rad/s\]
    pub natural_frequency: f64,
    /// \[-\]
    pub damping_ratio: f64,
}

impl PerChannel {
    /// The mean that a filter starts from unless told otherwise: at rest, stiffer and more damped than the truth.
    pub const INITIAL_MEAN: Self =
        Self { displacement: 0.0, velocity: 0.0, natural_frequency: 8.0, damping_ratio: 0.1 };
    /// The standard deviations that go with it.
    pub const INITIAL_STD: Self = Self { displacement: 0.1, velocity: 0.3, natural_frequency: 2.0, damping_ratio: 0.1 };
    /// The process noise per step unless told otherwise.
    pub const PROCESS_STD: Self =
        Self { displacement: 1e-4, velocity: 1e-3, natural_frequency: 1e-4, damping_ratio: 3e-5 };
}

impl Index<Channel> for PerChannel {
    type Output = f64;

    fn index(&self, channel: Channel) -> &f64 {
        match channel {
            Channel::Displacement => &self.displacement,
            Channel::Velocity => &self.velocity,
            Channel::NaturalFrequency => &self.natural_frequency,
            Channel::DampingRatio => &self.damping_ratio,
        }
    }
}

impl IndexMut<Channel> for PerChannel {
    fn index_mut(&mut self, channel: Channel) -> &mut f64 {
        match channel {
            Channel::Displacement => &mut self.displacement,
            Channel::Velocity => &mut self.velocity,
            Channel::NaturalFrequency => &mut self.natural_frequency,
            Channel::DampingRatio => &mut self.damping_ratio,
        }
    }
}

/// What a file gives of a [`PerChannel`]; the rest is the default of the key that it stands under.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Given {
    displacement: Option<f64>,
    velocity: Option<f64>,
    natural_frequency: Option<f64>,
    damping_ratio: Option<f64>,
}

fn given_or<'de, D: Deserializer<'de>>(default: PerChannel, deserializer: D) -> Result<PerChannel, D::Error> {
    let Given { displacement, velocity, natural_frequency, damping_ratio } = Given::deserialize(deserializer)?;
    Ok(PerChannel {
        displacement: displacement.unwrap_or(default.displacement),
        velocity: velocity.unwrap_or(default.velocity),
        natural_frequency: natural_frequency.unwrap_or(default.natural_frequency),
        damping_ratio: damping_ratio.unwrap_or(default.damping_ratio),
    })
}

pub(super) fn initial_mean<'de, D: Deserializer<'de>>(deserializer: D) -> Result<PerChannel, D::Error> {
    given_or(PerChannel::INITIAL_MEAN, deserializer)
}

pub(super) fn initial_std<'de, D: Deserializer<'de>>(deserializer: D) -> Result<PerChannel, D::Error> {
    given_or(PerChannel::INITIAL_STD, deserializer)
}

pub(super) fn process_std<'de, D: Deserializer<'de>>(deserializer: D) -> Result<PerChannel, D::Error> {
    given_or(PerChannel::PROCESS_STD, deserializer)
}
