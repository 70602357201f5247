//! The plants of the registry: their data, beside their equations, which the engine has.

use std::any::Any;
use std::sync::Arc;

use super::{Plant, PlantInfo, PlantKind, Spring};
use crate::Channel;
use crate::channel::{ChannelInfo, MAX_MASSES, Role, Sign, Usual, by_mass, symbols_by_mass};
use crate::engine::plants::{self, Own};

#[derive(Debug)]
pub(super) struct BuiltInPlant {
    pub(super) info: &'static PlantInfo<'static>,
    pub(super) plant: plants::EnginePlant,
}

impl Plant for BuiltInPlant {
    fn info(&self) -> PlantInfo<'_> {
        *self.info
    }

    fn motion_rate(&self, state: &[f64], force: f64, rate: &mut [f64]) {
        self.plant.rate(state, force, rate);
    }

    /// At kinks, as that of |v|, the derivatives are those for positive numbers.
    fn motion_jacobian(&self, state: &[f64], out: &mut [f64]) {
        self.plant.jacobian(state, out);
    }
}

impl plants::EnginePlant {
    /// The engine's form of a plant.
    pub fn of(kind: &PlantKind) -> Self {
        let plant: &dyn Any = kind.plant();
        match plant.downcast_ref::<BuiltInPlant>() {
            Some(built_in) => built_in.plant.clone(),
            None => match kind.own_equation() {
                Some(equation) => Self::Typed(Arc::clone(&equation.typed)),
                None => Self::Own(Own(kind.clone())),
            },
        }
    }
}

pub(super) const SDOF: BuiltInPlant = BuiltInPlant { info: &SDOF_INFO, plant: plants::EnginePlant::Sdof(plants::Sdof) };

pub(super) const DUFFING: BuiltInPlant =
    BuiltInPlant { info: &DUFFING_INFO, plant: plants::EnginePlant::Duffing(plants::Duffing) };

impl Channel {
    /// ωₙ \[rad/s\]
    pub const NATURAL_FREQUENCY: Self = Self::new(&NATURAL_FREQUENCY);
    /// ζ \[-\]
    pub const DAMPING_RATIO: Self = Self::new(&DAMPING_RATIO);
    /// μ, cubic stiffness over mass \[1/(m² s²)\]
    pub const CUBIC_STIFFNESS: Self = Self::new(&CUBIC_STIFFNESS);
    /// z \[m\], the hysteretic displacement
    pub const HYSTERETIC_DISPLACEMENT: Self = Self::new(&HYSTERETIC_DISPLACEMENT);
    /// α \[-\], ratio of the stiffness after yielding to the initial one
    pub const POST_YIELD_RATIO: Self = Self::new(&POST_YIELD_RATIO);
    /// β \[1/m²\], shape of the hysteresis loop with exponent 2
    pub const HYSTERESIS_BETA: Self = Self::new(&HYSTERESIS_BETA);
    /// γ \[1/m²\], shape of the hysteresis loop with exponent 2
    pub const HYSTERESIS_GAMMA: Self = Self::new(&HYSTERESIS_GAMMA);
    /// β₁ \[1/m\], shape of the hysteresis loop with exponent 1
    pub const YIELD_BETA: Self = Self::new(&YIELD_BETA);
    /// γ₁ \[1/m\], shape of the hysteresis loop with exponent 1
    pub const YIELD_GAMMA: Self = Self::new(&YIELD_GAMMA);
    /// c, storey damping over mass \[1/s\]
    pub const STOREY_DAMPING: Self = Self::new(&STOREY_DAMPING);

    /// κ, stiffness over mass of the storey below a mass, counted from 0 \[1/s²\]
    pub const fn stiffness(mass: usize) -> Self {
        Self::of_mass(&STIFFNESS, mass)
    }
}

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

static SDOF_INFO: PlantInfo<'_> = PlantInfo {
    key: "sdof",
    name: "linear oscillator",
    equation: "ẍ + 2ζωₙẋ + ωₙ²x = f",
    reference: "Huang and Yuen (2023), Bayesian Real-Time System Identification",
    channels: &[Channel::DISPLACEMENT, Channel::VELOCITY, Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO],
    is_linear: true,
    spring: Spring::Linear,
};

static CUBIC_STIFFNESS: ChannelInfo = ChannelInfo::parameter(
    [&["cubic_stiffness"], &["cubic stiffness"], &["μ"]],
    "1/(m² s²)",
    Sign::Any,
    Usual { mean: 100.0, std: 200.0, process: 0.01, truth: &[300.0], slider: (-50.0, 1000.0), decimals: 1 },
);

static DUFFING_INFO: PlantInfo<'_> = PlantInfo {
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

pub(super) const BOUC_WEN: BuiltInPlant =
    BuiltInPlant { info: &BOUC_WEN_INFO, plant: plants::EnginePlant::BoucWen(plants::BoucWen) };

pub(super) const BOUC_WEN_1: BuiltInPlant =
    BuiltInPlant { info: &BOUC_WEN_1_INFO, plant: plants::EnginePlant::BoucWenOne(plants::BoucWen) };

static BOUC_WEN_INFO: PlantInfo<'_> = bouc_wen(
    ["bouc_wen", "Bouc-Wen oscillator", "ẍ + 2ζωₙẋ + ωₙ²(αx + (1 - α)z) = f, ż = ẋ - β|ẋ||z|z - γẋz²"],
    &bouc_wen_channels(Channel::HYSTERESIS_BETA, Channel::HYSTERESIS_GAMMA),
);

static BOUC_WEN_1_INFO: PlantInfo<'_> = bouc_wen(
    ["bouc_wen_1", "Bouc-Wen oscillator, exponent 1", "ẍ + 2ζωₙẋ + ωₙ²(αx + (1 - α)z) = f, ż = ẋ - β₁|ẋ|z - γ₁ẋ|z|"],
    &bouc_wen_channels(Channel::YIELD_BETA, Channel::YIELD_GAMMA),
);

const fn bouc_wen([key, name, equation]: [&'static str; 3], channels: &'static [Channel]) -> PlantInfo<'static> {
    let reference = "Wen (1976), Method for random vibration of hysteretic systems";
    let spring = Spring::Slipping(Channel::HYSTERETIC_DISPLACEMENT);
    PlantInfo { key, name, equation, reference, channels, is_linear: false, spring }
}

const fn bouc_wen_channels(beta: Channel, gamma: Channel) -> [Channel; 8] {
    [
        Channel::DISPLACEMENT,
        Channel::VELOCITY,
        Channel::HYSTERETIC_DISPLACEMENT,
        Channel::NATURAL_FREQUENCY,
        Channel::DAMPING_RATIO,
        Channel::POST_YIELD_RATIO,
        beta,
        gamma,
    ]
}

static HYSTERETIC_DISPLACEMENT: ChannelInfo = ChannelInfo::motion(
    [&["hysteretic_displacement"], &["hysteretic displacement"], &["z"]],
    "m",
    Usual { mean: 0.0, std: 0.05, process: 1e-4, truth: &[], slider: (-1.0, 1.0), decimals: 4 },
);

static POST_YIELD_RATIO: ChannelInfo = shape(
    [&["post_yield_ratio"], &["post-yield ratio"], &["α"]],
    "",
    Usual { mean: 0.1, std: 0.0, process: 0.0, truth: &[0.1], slider: (0.0, 1.0), decimals: 4 },
);

static HYSTERESIS_BETA: ChannelInfo = shape(
    [&["hysteresis_beta"], &["hysteresis β"], &["β"]],
    "1/m²",
    Usual { mean: 50.0, std: 15.0, process: 0.01, truth: &[60.0], slider: (-100.0, 200.0), decimals: 1 },
);

static HYSTERESIS_GAMMA: ChannelInfo = shape(
    [&["hysteresis_gamma"], &["hysteresis γ"], &["γ"]],
    "1/m²",
    Usual { mean: 30.0, std: 15.0, process: 0.01, truth: &[40.0], slider: (-100.0, 200.0), decimals: 1 },
);

static YIELD_BETA: ChannelInfo = shape(
    [&["yield_beta"], &["yielding β"], &["β₁"]],
    "1/m",
    Usual { mean: 5.0, std: 1.5, process: 0.001, truth: &[6.0], slider: (-10.0, 20.0), decimals: 2 },
);

static YIELD_GAMMA: ChannelInfo = shape(
    [&["yield_gamma"], &["yielding γ"], &["γ₁"]],
    "1/m",
    Usual { mean: 3.0, std: 1.5, process: 0.001, truth: &[4.0], slider: (-10.0, 20.0), decimals: 2 },
);

const fn shape(words: [&'static [&'static str]; 3], unit: &'static str, usual: Usual) -> ChannelInfo {
    ChannelInfo::parameter(words, unit, Sign::Any, usual)
}

pub(super) struct ShearPlant<const MASSES: usize>;

static STIFFNESS: ChannelInfo = ChannelInfo::parameter(
    [
        by_mass!("stiffness_1"; "stiffness", "_", ""),
        by_mass!("stiffness 1"; "stiffness", " ", ""),
        symbols_by_mass!("κ₁", "κ"),
    ],
    "1/s²",
    Sign::NotNegative,
    Usual {
        mean: 150.0,
        std: 30.0,
        process: 0.01,
        truth: &[200.0, 180.0, 160.0, 140.0],
        slider: (10.0, 500.0),
        decimals: 1,
    },
);

static STOREY_DAMPING: ChannelInfo = ChannelInfo::parameter(
    [&["storey_damping"], &["storey damping"], &["c"]],
    "1/s",
    Sign::NotNegative,
    Usual { mean: 0.5, std: 0.3, process: 1e-4, truth: &[0.4], slider: (0.0, 5.0), decimals: 3 },
);

const CHAIN: usize = 3 * MAX_MASSES + 1;

/// The channels of the longest chain; a chain of m masses uses the first `3 m + 1`.
const fn chain(masses: usize) -> [Channel; CHAIN] {
    let mut channels = [Channel::STOREY_DAMPING; CHAIN];
    let mut i = 0;
    while i < masses {
        channels[i] = Channel::displacement(i);
        channels[masses + i] = Channel::velocity(i);
        channels[2 * masses + i] = Channel::stiffness(i);
        i += 1;
    }
    channels
}

impl<const MASSES: usize> ShearPlant<MASSES> {
    pub(super) const PLANT: BuiltInPlant = BuiltInPlant {
        info: &Self::INFO,
        plant: plants::EnginePlant::ShearChain(plants::ShearChain { masses: MASSES }),
    };
    const CHANNELS: [Channel; CHAIN] = chain(MASSES);
    const INFO: PlantInfo<'static> = PlantInfo {
        key: by_mass!("shear", "_")[MASSES - 1],
        name: by_mass!("shear chain, 1 mass"; "shear chain,", " ", " masses")[MASSES - 1],
        equation: "ẍ₁ = f - s₁ + s₂, ẍ₂ = f - s₂ + …; s₁ = κ₁x₁ + cẋ₁, s₂ = κ₂(x₂ - x₁) + c(ẋ₂ - ẋ₁), …",
        reference: "Chopra (2017), Dynamics of Structures, section 9.1",
        channels: Self::CHANNELS.split_at(3 * MASSES + 1).0,
        is_linear: true,
        spring: Spring::Linear,
    };
}
