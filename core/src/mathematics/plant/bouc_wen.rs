//! An oscillator with a hysteretic spring.

use super::built_in::BuiltIn;
use super::{PlantInfo, Spring};
use crate::Channel;
use crate::mathematics::channel::{ChannelInfo, Role, Sign, Usual};
use crate::mathematics::engine::plants;

/// Exponent 2.
pub(super) const TWO: BuiltIn = BuiltIn { info: &TWO_INFO, plant: plants::Plant::BoucWen(plants::BoucWen) };

/// Exponent 1, with β₁ and γ₁.
pub(super) const ONE: BuiltIn = BuiltIn { info: &ONE_INFO, plant: plants::Plant::BoucWenOne(plants::BoucWen) };

static TWO_INFO: PlantInfo = info(
    "bouc_wen",
    "Bouc-Wen oscillator",
    "ẍ + 2ζωₙẋ + ωₙ²(αx + (1 - α)z) = f, ż = ẋ - β|ẋ||z|z - γẋz²",
    &channels(Channel::HYSTERESIS_BETA, Channel::HYSTERESIS_GAMMA),
);

static ONE_INFO: PlantInfo = info(
    "bouc_wen_1",
    "Bouc-Wen oscillator, exponent 1",
    "ẍ + 2ζωₙẋ + ωₙ²(αx + (1 - α)z) = f, ż = ẋ - β₁|ẋ|z - γ₁ẋ|z|",
    &channels(Channel::YIELD_BETA, Channel::YIELD_GAMMA),
);

const fn info(
    key: &'static str,
    name: &'static str,
    equation: &'static str,
    channels: &'static [Channel],
) -> PlantInfo {
    let reference = "Wen (1976), Method for random vibration of hysteretic systems";
    let spring = Spring::Slipping(Channel::HYSTERETIC_DISPLACEMENT);
    PlantInfo { key, name, equation, reference, channels, is_linear: false, spring }
}

const fn channels(beta: Channel, gamma: Channel) -> [Channel; 8] {
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

impl Channel {
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
}

static HYSTERETIC_DISPLACEMENT: ChannelInfo = ChannelInfo {
    keys: &["hysteretic_displacement"],
    names: &["hysteretic displacement"],
    symbols: &["z"],
    unit: "m",
    role: Role::Motion,
    rate: None,
    mirrored: false,
    usual: Usual { mean: 0.0, std: 0.05, process: 1e-4, truth: &[], slider: (-1.0, 1.0), decimals: 4 },
};

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

const fn shape([keys, names, symbols]: [&'static [&'static str]; 3], unit: &'static str, usual: Usual) -> ChannelInfo {
    ChannelInfo { keys, names, symbols, unit, role: Role::Parameter(Sign::Any), rate: None, mirrored: false, usual }
}
