//! The plants of the registry: their data, beside their equations.

use super::dynamics::{BoucWen, Duffing, EnginePlant, Sdof, ShearChain};
use super::{PlantInfo, Spring};
use crate::Channel;
use crate::channel::MAX_MASSES;

pub(super) struct BuiltInPlant {
    pub(super) info: PlantInfo<'static>,
    pub(super) dynamics: EnginePlant,
}

const OSCILLATOR: [Channel; 5] = [
    Channel::DISPLACEMENT,
    Channel::VELOCITY,
    Channel::NATURAL_FREQUENCY,
    Channel::DAMPING_RATIO,
    Channel::CUBIC_STIFFNESS,
];

pub(super) const SDOF: BuiltInPlant = BuiltInPlant {
    info: PlantInfo {
        key: "sdof",
        name: "linear oscillator",
        equation: "ẍ + 2ζωₙẋ + ωₙ²x = f",
        reference: "Huang and Yuen (2023), Bayesian Real-Time System Identification",
        channels: OSCILLATOR.split_at(4).0,
        is_linear: true,
        spring: Spring::Linear,
    },
    dynamics: EnginePlant::Sdof(Sdof),
};

pub(super) const DUFFING: BuiltInPlant = BuiltInPlant {
    info: PlantInfo {
        key: "duffing",
        name: "Duffing oscillator",
        equation: "ẍ + 2ζωₙẋ + ωₙ²x + μx³ = f",
        reference: "Kovacic and Brennan, eds. (2011), The Duffing Equation",
        channels: &OSCILLATOR,
        is_linear: false,
        spring: Spring::Cubic(Channel::CUBIC_STIFFNESS),
    },
    dynamics: EnginePlant::Duffing(Duffing),
};

pub(super) const BOUC_WEN: BuiltInPlant = bouc_wen(
    ["bouc_wen", "Bouc-Wen oscillator", "ẍ + 2ζωₙẋ + ωₙ²(αx + (1 - α)z) = f, ż = ẋ - β|ẋ||z|z - γẋz²"],
    &bouc_wen_channels(Channel::HYSTERESIS_BETA, Channel::HYSTERESIS_GAMMA),
    EnginePlant::BoucWen(BoucWen),
);

pub(super) const BOUC_WEN_1: BuiltInPlant = bouc_wen(
    ["bouc_wen_1", "Bouc-Wen oscillator, exponent 1", "ẍ + 2ζωₙẋ + ωₙ²(αx + (1 - α)z) = f, ż = ẋ - β₁|ẋ|z - γ₁ẋ|z|"],
    &bouc_wen_channels(Channel::YIELD_BETA, Channel::YIELD_GAMMA),
    EnginePlant::BoucWenOne(BoucWen),
);

const fn bouc_wen(words: [&'static str; 3], channels: &'static [Channel], dynamics: EnginePlant) -> BuiltInPlant {
    let ([key, name, equation], spring) = (words, Spring::Slipping(Channel::HYSTERETIC_DISPLACEMENT));
    let reference = "Wen (1976), Method for random vibration of hysteretic systems";
    BuiltInPlant { info: PlantInfo { key, name, equation, reference, channels, is_linear: false, spring }, dynamics }
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

pub(super) struct ShearPlant<const MASSES: usize>;

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

macro_rules! words {
    ($($masses:literal)*) => { [$((concat!("shear_", $masses), concat!("shear chain, ", $masses, " masses"))),*] };
}

const SHEAR: [(&str, &str); MAX_MASSES - 1] = words!(2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20);

impl<const MASSES: usize> ShearPlant<MASSES> {
    const CHANNELS: [Channel; CHAIN] = chain(MASSES);
    pub(super) const PLANT: BuiltInPlant =
        BuiltInPlant { info: Self::INFO, dynamics: EnginePlant::ShearChain(ShearChain { masses: MASSES }) };
    const INFO: PlantInfo<'static> = PlantInfo {
        key: SHEAR[MASSES - 2].0,
        name: SHEAR[MASSES - 2].1,
        equation: "ẍ₁ = f - s₁ + s₂, ẍ₂ = f - s₂ + …; s₁ = κ₁x₁ + cẋ₁, s₂ = κ₂(x₂ - x₁) + c(ẋ₂ - ẋ₁), …",
        reference: "Chopra (2017), Dynamics of Structures, section 9.1",
        channels: Self::CHANNELS.split_at(3 * MASSES + 1).0,
        is_linear: true,
        spring: Spring::Linear,
    };
}
