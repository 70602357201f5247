//! The quantities that a filter estimates, as data.

pub mod augment;
mod of_plants;

use std::cmp::Ordering;

use serde::{Deserialize, Serialize};

use crate::registry::{hashed, keyed};

/// The most masses that a plant can have.
pub const MAX_MASSES: usize = 20;

/// The role of a channel in a plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A component of the motion, governed by the plant's equation.
    Motion,
    /// A property of the plant: constant, or decaying at the rate η.
    Parameter(Sign),
    /// A property of the input or of a sensor: constant, for every plant.
    Augmentation,
}

/// The allowed sign of a plant's parameter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sign {
    /// Any number.
    #[default]
    Any,
    /// At least zero.
    NotNegative,
    /// Above zero.
    Positive,
}

/// Usual numbers of a channel, in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Usual {
    /// Mean of a filter's initial belief.
    pub mean: f64,
    /// Standard deviation of a filter's initial belief.
    pub std: f64,
    /// Standard deviation of the process noise per step.
    pub process: f64,
    /// True values, mass by mass; the last one applies to all further masses. Empty for a component of the motion.
    pub truth: &'static [f64],
    /// Limits of a slider.
    pub slider: (f64, f64),
    /// Number of decimals for a usual value.
    pub decimals: usize,
}

/// A kind of channel. Where each mass has such a channel, keys, names and symbols are in the order of the masses.
#[derive(Debug)]
pub struct ChannelInfo {
    /// Keys in scenario files and columns in CSV files.
    pub keys: &'static [&'static str],
    /// Names in running text.
    pub names: &'static [&'static str],
    /// Symbols in formulas.
    pub symbols: &'static [&'static str],
    /// The unit, empty for a pure number.
    pub unit: &'static str,
    /// The role in a plant.
    pub role: Role,
    /// The channel of its rate of change: for a displacement, the velocity.
    pub rate: Option<&'static ChannelInfo>,
    /// Whether the channel changes its sign together with the natural frequency, which gives the same oscillator.
    pub mirrored: bool,
    /// Usual numbers.
    pub usual: Usual,
}

/// One component of a plant's augmented state: a motion, a parameter, or a property of the input or of a sensor.
///
/// Records know channels as columns, so that those of plants stand here, below plants and records.
#[derive(Clone, Copy)]
pub struct Channel {
    info: &'static ChannelInfo,
    mass: u8,
}

macro_rules! by_mass {
    ($word:literal, $space:literal) => {
        by_mass!($word; $word, $space, "")
    };
    ($first:literal; $word:literal, $space:literal, $after:literal) => {
        $crate::channel::numbered!($first; concat!($word, $space); $after;
            "2" "3" "4" "5" "6" "7" "8" "9" "10" "11" "12" "13" "14" "15" "16" "17" "18" "19" "20")
    };
}
macro_rules! symbols_by_mass {
    ($first:literal, $symbol:literal) => {
        $crate::channel::numbered!($first; $symbol; "";
            "₂" "₃" "₄" "₅" "₆" "₇" "₈" "₉" "₁₀" "₁₁" "₁₂" "₁₃" "₁₄" "₁₅" "₁₆" "₁₇" "₁₈" "₁₉" "₂₀")
    };
}
macro_rules! numbered {
    ($first:literal; $before:expr; $after:literal; $($number:literal)*) => {
        &[$first, $(concat!($before, $number, $after)),*]
    };
}
pub(crate) use {by_mass, numbered, symbols_by_mass};

impl ChannelInfo {
    const fn parameter(
        [keys, names, symbols]: [&'static [&'static str]; 3],
        unit: &'static str,
        sign: Sign,
        usual: Usual,
    ) -> Self {
        Self { keys, names, symbols, unit, role: Role::Parameter(sign), rate: None, mirrored: false, usual }
    }

    const fn motion(words: [&'static [&'static str]; 3], unit: &'static str, usual: Usual) -> Self {
        Self { role: Role::Motion, ..Self::parameter(words, unit, Sign::Any, usual) }
    }

    pub(crate) const fn augmentation(words: [&'static [&'static str]; 3], unit: &'static str, usual: Usual) -> Self {
        Self { role: Role::Augmentation, ..Self::parameter(words, unit, Sign::Any, usual) }
    }
}

static DISPLACEMENT: ChannelInfo = ChannelInfo {
    rate: Some(&VELOCITY),
    ..ChannelInfo::motion(
        [by_mass!("displacement", "_"), by_mass!("displacement", " "), symbols_by_mass!("x", "x")],
        "m",
        Usual { mean: 0.0, std: 0.1, process: 1e-4, truth: &[], slider: (-1.0, 1.0), decimals: 4 },
    )
};

static VELOCITY: ChannelInfo = ChannelInfo::motion(
    [by_mass!("velocity", "_"), by_mass!("velocity", " "), symbols_by_mass!("v", "v")],
    "m/s",
    Usual { mean: 0.0, std: 0.3, process: 1e-3, truth: &[], slider: (-5.0, 5.0), decimals: 3 },
);

impl Channel {
    /// x \[m\], of the first mass in a chain.
    pub const DISPLACEMENT: Self = Self::displacement(0);
    /// v = ẋ \[m/s\], of the first mass in a chain.
    pub const VELOCITY: Self = Self::velocity(0);

    /// Its place among others.
    pub fn place_in(self, all: &[Self]) -> Option<usize> {
        all.iter().position(|&other| other == self)
    }

    /// The channel of a kind that does not belong to masses.
    pub const fn new(info: &'static ChannelInfo) -> Self {
        Self { info, mass: 0 }
    }

    /// The channel of a kind for a mass, counted from 0. The kind must have a key for that mass.
    pub const fn of_mass(info: &'static ChannelInfo, mass: usize) -> Self {
        assert!(mass < info.keys.len(), "there is no such mass");
        Self { info, mass: mass as u8 }
    }

    /// x of a mass, counted from 0 \[m\].
    pub const fn displacement(mass: usize) -> Self {
        Self::of_mass(&DISPLACEMENT, mass)
    }

    /// v of a mass, counted from 0 \[m/s\].
    pub const fn velocity(mass: usize) -> Self {
        Self::of_mass(&VELOCITY, mass)
    }

    /// The kind's data.
    pub const fn info(self) -> &'static ChannelInfo {
        self.info
    }

    /// The mass, counted from 0; also 0 for a channel that belongs to no mass.
    pub const fn mass(self) -> usize {
        self.mass as usize
    }

    /// The key in scenario files and the column in CSV files.
    pub const fn key(self) -> &'static str {
        self.info.keys[self.mass as usize]
    }

    /// The name in running text.
    pub const fn name(self) -> &'static str {
        self.info.names[self.mass as usize]
    }

    /// The symbol in formulas.
    pub const fn symbol(self) -> &'static str {
        self.info.symbols[self.mass as usize]
    }

    /// The unit, empty for a pure number.
    pub const fn unit(self) -> &'static str {
        self.info.unit
    }

    /// The role in a plant.
    pub const fn role(self) -> Role {
        self.info.role
    }

    /// Usual numbers.
    pub const fn usual(self) -> &'static Usual {
        &self.info.usual
    }

    /// The usual true value; zero for a component of the motion.
    pub fn usual_truth(self) -> f64 {
        let truth = self.info.usual.truth;
        truth.get(self.mass()).or(truth.last()).copied().unwrap_or(0.0)
    }

    /// Whether the channel is a property of plant, input or sensor, and not a component of the motion.
    pub const fn is_parameter(self) -> bool {
        !matches!(self.info.role, Role::Motion)
    }

    /// Whether the channel is a property of the input or of a sensor.
    pub const fn is_augmentation(self) -> bool {
        matches!(self.info.role, Role::Augmentation)
    }

    /// Whether it can be a Gauss-Markov process about zero: a bias, an offset or an unknown force.
    pub fn can_be_forgotten(self) -> bool {
        self.is_augmentation() && self.info.usual.mean == 0.0 && self != Self::WHITE_FORCE
    }

    /// The channel of its rate of change: for a displacement, the velocity.
    pub const fn rate(self) -> Option<Self> {
        match self.info.rate {
            Some(info) => Some(Self { info, mass: self.mass }),
            None => None,
        }
    }

    /// Whether the channel is a parameter that must be positive, so that its logarithm can be estimated instead.
    pub const fn is_positive(self) -> bool {
        matches!(self.info.role, Role::Parameter(Sign::NotNegative | Sign::Positive))
    }

    /// Whether the channel changes its sign together with the natural frequency, which gives the same oscillator.
    pub const fn is_mirrored(self) -> bool {
        self.info.mirrored
    }
}

impl PartialEq for Channel {
    fn eq(&self, other: &Self) -> bool {
        self.mass == other.mass && (std::ptr::eq(self.info, other.info) || self.key() == other.key())
    }
}

impl Eq for Channel {}

impl Ord for Channel {
    fn cmp(&self, other: &Self) -> Ordering {
        self.key().cmp(other.key())
    }
}

keyed!(Channel);
hashed!(Channel);

/// The keys of first masses, with a hint to those of the others.
pub(crate) fn expected<'a>(keys: impl Iterator<Item = &'a str>) -> String {
    let keys: Vec<String> = keys.map(|key| format!("`{key}`")).collect();
    format!("one of {}, and of other masses as in `displacement_2`", keys.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mass_has_a_key_a_name_and_a_symbol_and_no_key_stands_twice() {
        for &channel in Channel::all() {
            let ChannelInfo { keys, names, symbols, .. } = channel.info();
            assert!(keys.len() == names.len() && keys.len() == symbols.len(), "{channel:?}");
            assert_eq!(Channel::from_key(channel.key()), Some(channel));
            let same = Channel::all().iter().filter(|c| c.symbol() == channel.symbol());
            assert_eq!(same.count(), 1, "the symbol of {channel:?}");
        }
        assert_eq!(Channel::displacement(9).key(), "displacement_10");
        assert_eq!(Channel::displacement(3).rate(), Some(Channel::velocity(3)));
    }
}
