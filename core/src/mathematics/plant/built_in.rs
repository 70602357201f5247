//! The plants of the registry: their data, beside their equations, which the engine has. The oscillators without memory are here.

use std::any::Any;

use super::{Plant, PlantInfo, PlantKind, Spring};
use crate::Channel;
use crate::mathematics::channel::{ChannelInfo, Role, Sign, Usual};
use crate::mathematics::engine::plants::{self, Own};

#[derive(Debug)]
pub(super) struct BuiltIn {
    pub(super) info: &'static PlantInfo,
    pub(super) plant: plants::Plant,
}

impl Plant for BuiltIn {
    fn info(&self) -> &PlantInfo {
        self.info
    }

    fn motion_rate(&self, state: &[f64], force: f64, rate: &mut [f64]) {
        self.plant.rate(state, force, rate);
    }

    /// At kinks, as that of |v|, the derivatives are those for positive numbers.
    fn motion_jacobian(&self, state: &[f64], out: &mut [f64]) {
        self.plant.jacobian(state, out);
    }
}

impl plants::Plant {
    /// The engine's form of a plant.
    pub fn of(kind: PlantKind) -> Self {
        let plant: &dyn Any = kind.plant();
        match plant.downcast_ref::<BuiltIn>() {
            Some(built_in) => built_in.plant,
            None => kind.own_equation().map_or(Self::Own(Own(kind)), |equation| Self::Typed(&equation.typed)),
        }
    }
}

pub(super) const SDOF: BuiltIn = BuiltIn { info: &SDOF_INFO, plant: plants::Plant::Sdof(plants::Sdof) };

pub(super) const DUFFING: BuiltIn = BuiltIn { info: &DUFFING_INFO, plant: plants::Plant::Duffing(plants::Duffing) };

static NATURAL_FREQUENCY: ChannelInfo = ChannelInfo {
    keys: &["natural_frequency"],
    names: &["natural frequency"],
    symbols: &["ωₙ"],
    unit: "rad/s",
    role: Role::Parameter(Sign::Positive),
    rate: None,
    mirrored: true,
    usual: Usual { mean: 8.0, std: 2.0, process: 1e-4, truth: &[6.0], slider: (0.5, 20.0), decimals: 3 },
};

static DAMPING_RATIO: ChannelInfo = ChannelInfo {
    keys: &["damping_ratio"],
    names: &["damping ratio"],
    symbols: &["ζ"],
    unit: "",
    role: Role::Parameter(Sign::NotNegative),
    rate: None,
    mirrored: true,
    usual: Usual { mean: 0.1, std: 0.1, process: 3e-5, truth: &[0.05], slider: (0.0, 0.5), decimals: 4 },
};

impl Channel {
    /// ωₙ \[rad/s\]
    pub const NATURAL_FREQUENCY: Self = Self::new(&NATURAL_FREQUENCY);
    /// ζ \[-\]
    pub const DAMPING_RATIO: Self = Self::new(&DAMPING_RATIO);
}

static SDOF_INFO: PlantInfo = PlantInfo {
    key: "sdof",
    name: "linear oscillator",
    equation: "ẍ + 2ζωₙẋ + ωₙ²x = f",
    reference: "Huang and Yuen (2023), Bayesian Real-Time System Identification",
    channels: &[Channel::DISPLACEMENT, Channel::VELOCITY, Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO],
    is_linear: true,
    spring: Spring::Linear,
};

static CUBIC_STIFFNESS: ChannelInfo = ChannelInfo {
    keys: &["cubic_stiffness"],
    names: &["cubic stiffness"],
    symbols: &["μ"],
    unit: "1/(m² s²)",
    role: Role::Parameter(Sign::Any),
    rate: None,
    mirrored: false,
    usual: Usual { mean: 100.0, std: 200.0, process: 0.01, truth: &[300.0], slider: (-50.0, 1000.0), decimals: 1 },
};

impl Channel {
    /// μ, cubic stiffness over mass \[1/(m² s²)\]
    pub const CUBIC_STIFFNESS: Self = Self::new(&CUBIC_STIFFNESS);
}

static DUFFING_INFO: PlantInfo = PlantInfo {
    key: "duffing",
    name: "Duffing oscillator",
    equation: "ẍ + 2ζωₙẋ + ωₙ²x + μx³ = f",
    reference: "Kovacic and Brennan, eds. (2011), The Duffing Equation",
    channels: &[
        Channel::DISPLACEMENT,
        Channel::VELOCITY,
        Channel::NATURAL_FREQUENCY,
        Channel::DAMPING_RATIO,
        Channel::CUBIC_STIFFNESS,
    ],
    is_linear: false,
    spring: Spring::Cubic(Channel::CUBIC_STIFFNESS),
};
