//! The channels of the built-in plants.

use super::{Channel, ChannelInfo, MAX_MASSES, Role, Sign, Usual, by_mass, symbols_by_mass};

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

    /// The channels of all built-in plants, each once, in the order of the plants.
    pub(crate) fn of_plants() -> impl Iterator<Item = Self> {
        const FIRST: [Channel; 11] = [
            Channel::DISPLACEMENT,
            Channel::VELOCITY,
            Channel::NATURAL_FREQUENCY,
            Channel::DAMPING_RATIO,
            Channel::CUBIC_STIFFNESS,
            Channel::HYSTERETIC_DISPLACEMENT,
            Channel::POST_YIELD_RATIO,
            Channel::HYSTERESIS_BETA,
            Channel::HYSTERESIS_GAMMA,
            Channel::YIELD_BETA,
            Channel::YIELD_GAMMA,
        ];
        let of_storey = |storey| [Self::displacement(storey), Self::velocity(storey), Self::stiffness(storey)];
        let [x, v, second] = of_storey(1);
        let of_two = [x, v, Self::stiffness(0), second, Self::STOREY_DAMPING];
        FIRST.into_iter().chain(of_two).chain((2..MAX_MASSES).flat_map(of_storey))
    }

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

static CUBIC_STIFFNESS: ChannelInfo = ChannelInfo::parameter(
    [&["cubic_stiffness"], &["cubic stiffness"], &["μ"]],
    "1/(m² s²)",
    Sign::Any,
    Usual { mean: 100.0, std: 200.0, process: 0.01, truth: &[300.0], slider: (-50.0, 1000.0), decimals: 1 },
);

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
    // With σ of 30 for β and γ, members of an ensemble had β + γ < 0 and ran away.
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
        // With 50, some EKFs and many EnKFs of a shear chain took a storey for lost.
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

const fn shape(words: [&'static [&'static str]; 3], unit: &'static str, usual: Usual) -> ChannelInfo {
    ChannelInfo::parameter(words, unit, Sign::Any, usual)
}
