//! The truth's settings.

use serde::{Deserialize, Serialize};

use crate::signal::Step;
use crate::{Channel, PlantKind, Signal};

/// The plant that the filters are to identify. It has those of the parameters that [`PlantKind::parameters`] says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Plant {
    /// The kind of plant.
    pub kind: PlantKind,
    /// ωₙ \[rad/s\]
    pub natural_frequency: Signal,
    /// ζ \[-\]
    pub damping_ratio: Signal,
    /// μ \[1/(m² s²)\]
    pub cubic_stiffness: Signal,
    /// α \[-\]
    pub post_yield_ratio: Signal,
    /// β \[1/m²\]
    pub hysteresis_beta: Signal,
    /// γ \[1/m²\]
    pub hysteresis_gamma: Signal,
    /// κ₁ \[1/s²\]
    pub stiffness_1: Signal,
    /// κ₂ \[1/s²\]
    pub stiffness_2: Signal,
    /// κ₃ \[1/s²\]
    pub stiffness_3: Signal,
    /// κ₄ \[1/s²\]
    pub stiffness_4: Signal,
    /// c \[1/s\]
    pub storey_damping: Signal,
    /// The motion of the mass, or of the first of several, at t = 0; everything else is at rest.
    pub initial: Motion,
    /// Standard deviation of an unmeasured force over mass that is normal and held over each step, and the same for every
    /// mass \[m/s²\].
    pub disturbance_std: f64,
}

/// Displacement and velocity of the mass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Motion {
    /// x \[m\]
    pub displacement: f64,
    /// ẋ \[m/s\]
    pub velocity: f64,
}

macro_rules! parameter {
    ($plant:expr, $channel:expr, $($borrow:tt)+) => {
        Some(match $channel {
            Channel::NaturalFrequency => $($borrow)+ $plant.natural_frequency,
            Channel::DampingRatio => $($borrow)+ $plant.damping_ratio,
            Channel::CubicStiffness => $($borrow)+ $plant.cubic_stiffness,
            Channel::PostYieldRatio => $($borrow)+ $plant.post_yield_ratio,
            Channel::HysteresisBeta => $($borrow)+ $plant.hysteresis_beta,
            Channel::HysteresisGamma => $($borrow)+ $plant.hysteresis_gamma,
            Channel::Stiffness1 => $($borrow)+ $plant.stiffness_1,
            Channel::Stiffness2 => $($borrow)+ $plant.stiffness_2,
            Channel::Stiffness3 => $($borrow)+ $plant.stiffness_3,
            Channel::Stiffness4 => $($borrow)+ $plant.stiffness_4,
            Channel::StoreyDamping => $($borrow)+ $plant.storey_damping,
            _ => return None,
        })
    };
}

impl Plant {
    /// The parameter of a channel, if the channel is one. Whether this kind of plant has it is
    /// [`PlantKind::parameters`]'s to say.
    pub fn parameter(&self, channel: Channel) -> Option<&Signal> {
        parameter!(self, channel, &)
    }

    /// As [`Self::parameter`], to be changed.
    pub fn parameter_mut(&mut self, channel: Channel) -> Option<&mut Signal> {
        parameter!(self, channel, &mut)
    }
}

impl Default for Plant {
    fn default() -> Self {
        Self {
            kind: PlantKind::Sdof,
            natural_frequency: Signal::Step(Step { from: 6.0, to: 4.8, at: 30.0 }),
            damping_ratio: Signal::Constant(0.05),
            cubic_stiffness: Signal::Constant(300.0),
            post_yield_ratio: Signal::Constant(0.1),
            hysteresis_beta: Signal::Constant(60.0),
            hysteresis_gamma: Signal::Constant(40.0),
            stiffness_1: Signal::Constant(200.0),
            stiffness_2: Signal::Constant(180.0),
            stiffness_3: Signal::Constant(160.0),
            stiffness_4: Signal::Constant(140.0),
            storey_damping: Signal::Constant(0.4),
            initial: Motion::default(),
            disturbance_std: 0.0,
        }
    }
}
