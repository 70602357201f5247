//! A chain of masses connected by springs and dampers, such as the storeys of a building.

use super::built_in::BuiltIn;
use super::{PlantInfo, Spring};
use crate::Channel;
use crate::mathematics::channel::{ChannelInfo, MAX_MASSES, Role, Sign, Usual, by_mass};
use crate::mathematics::engine::plants;

pub(super) struct ShearChain<const MASSES: usize>;

static STIFFNESS: ChannelInfo = ChannelInfo {
    keys: &[
        "stiffness_1",
        "stiffness_2",
        "stiffness_3",
        "stiffness_4",
        "stiffness_5",
        "stiffness_6",
        "stiffness_7",
        "stiffness_8",
        "stiffness_9",
        "stiffness_10",
    ],
    names: &[
        "stiffness 1",
        "stiffness 2",
        "stiffness 3",
        "stiffness 4",
        "stiffness 5",
        "stiffness 6",
        "stiffness 7",
        "stiffness 8",
        "stiffness 9",
        "stiffness 10",
    ],
    symbols: &["κ₁", "κ₂", "κ₃", "κ₄", "κ₅", "κ₆", "κ₇", "κ₈", "κ₉", "κ₁₀"],
    unit: "1/s²",
    role: Role::Parameter(Sign::NotNegative),
    rate: None,
    mirrored: false,
    usual: Usual {
        mean: 150.0,
        std: 30.0,
        process: 0.01,
        truth: &[200.0, 180.0, 160.0, 140.0],
        slider: (10.0, 500.0),
        decimals: 1,
    },
};

static STOREY_DAMPING: ChannelInfo = ChannelInfo {
    keys: &["storey_damping"],
    names: &["storey damping"],
    symbols: &["c"],
    unit: "1/s",
    role: Role::Parameter(Sign::NotNegative),
    rate: None,
    mirrored: false,
    usual: Usual { mean: 0.5, std: 0.3, process: 1e-4, truth: &[0.4], slider: (0.0, 5.0), decimals: 3 },
};

impl Channel {
    /// c, storey damping over mass \[1/s\]
    pub const STOREY_DAMPING: Self = Self::new(&STOREY_DAMPING);

    /// κ, stiffness over mass of the storey below a mass, counted from 0 \[1/s²\]
    pub const fn stiffness(mass: usize) -> Self {
        Self::of_mass(&STIFFNESS, mass)
    }
}

const MOST: usize = 3 * MAX_MASSES + 1;

/// The channels of the longest chain; a chain of m masses uses the first `3 m + 1`.
const fn channels(masses: usize) -> [Channel; MOST] {
    let mut channels = [Channel::STOREY_DAMPING; MOST];
    let mut i = 0;
    while i < masses {
        channels[i] = Channel::displacement(i);
        channels[masses + i] = Channel::velocity(i);
        channels[2 * masses + i] = Channel::stiffness(i);
        i += 1;
    }
    channels
}

const NAMES: [&str; MAX_MASSES] = [
    "shear chain, 1 mass",
    "shear chain, 2 masses",
    "shear chain, 3 masses",
    "shear chain, 4 masses",
    "shear chain, 5 masses",
    "shear chain, 6 masses",
    "shear chain, 7 masses",
    "shear chain, 8 masses",
    "shear chain, 9 masses",
    "shear chain, 10 masses",
];

impl<const MASSES: usize> ShearChain<MASSES> {
    pub(super) const PLANT: BuiltIn =
        BuiltIn { info: &Self::INFO, plant: plants::Plant::ShearChain(plants::ShearChain { masses: MASSES }) };
    const CHANNELS: [Channel; MOST] = channels(MASSES);
    const INFO: PlantInfo = PlantInfo {
        key: by_mass!("shear", "_")[MASSES - 1],
        name: NAMES[MASSES - 1],
        equation: "ẍ₁ = f - s₁ + s₂, ẍ₂ = f - s₂ + …; s₁ = κ₁x₁ + cẋ₁, s₂ = κ₂(x₂ - x₁) + c(ẋ₂ - ẋ₁), …",
        reference: "Chopra (2017), Dynamics of Structures, section 9.1",
        channels: Self::CHANNELS.split_at(3 * MASSES + 1).0,
        is_linear: true,
        spring: Spring::Linear,
    };
}
