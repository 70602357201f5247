//! The quantities that a filter estimates, as data.

use std::cmp::Ordering;
use std::fmt;
use std::hash::{Hash, Hasher};

use serde::{Serialize, Serializer};

/// The most masses that a plant can have.
pub const MAX_MASSES: usize = 10;

/// The part that a channel has in a plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// It moves, as the plant's equation says.
    Motion,
    /// It is a property of the plant: constant, or decaying at the rate η.
    Parameter(Sign),
    /// It is a property of the input or of a sensor: constant, whatever the plant.
    Augmentation,
}

/// The values that a parameter of a plant can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// Any number.
    Any,
    /// No number below zero.
    NotNegative,
    /// Numbers above zero only.
    Positive,
}

/// The numbers that are usual for a channel, in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Usual {
    /// Mean of a filter's initial belief.
    pub mean: f64,
    /// Standard deviation of a filter's initial belief.
    pub std: f64,
    /// Standard deviation of the process noise per step.
    pub process: f64,
    /// The true value, mass by mass; the last one serves all masses after it. None for what moves.
    pub truth: &'static [f64],
    /// Ends of a slider.
    pub slider: (f64, f64),
    /// Decimals that show a usual value well.
    pub decimals: usize,
}

/// All that is known of a kind of channel. Where masses have one each, keys, names and symbols are in the order of the
/// masses.
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
    /// Its part in a plant.
    pub role: Role,
    /// The channel that is its rate of change: the velocity, of a displacement.
    pub rate: Option<&'static ChannelInfo>,
    /// Whether it changes its sign together with the natural frequency, which leaves the oscillator the same.
    pub mirrored: bool,
    /// Usual numbers.
    pub usual: Usual,
}

/// One component of a plant's augmented state: a motion, a parameter, or a property of the input or of a sensor.
///
/// A plant declares the channels that it has to itself in its own file; those that several share are here.
#[derive(Clone, Copy)]
pub struct Channel {
    info: &'static ChannelInfo,
    mass: u8,
}

/// A word for each mass: that of the first as it is, those of the others with a number.
macro_rules! by_mass {
    ($word:literal, $space:literal) => {
        &[
            $word,
            concat!($word, $space, "2"),
            concat!($word, $space, "3"),
            concat!($word, $space, "4"),
            concat!($word, $space, "5"),
            concat!($word, $space, "6"),
            concat!($word, $space, "7"),
            concat!($word, $space, "8"),
            concat!($word, $space, "9"),
            concat!($word, $space, "10"),
        ]
    };
}
/// A symbol for each mass: that of the first given, those of the others with a subscript.
macro_rules! symbols_by_mass {
    ($first:literal, $symbol:literal) => {
        &[
            $first,
            concat!($symbol, "₂"),
            concat!($symbol, "₃"),
            concat!($symbol, "₄"),
            concat!($symbol, "₅"),
            concat!($symbol, "₆"),
            concat!($symbol, "₇"),
            concat!($symbol, "₈"),
            concat!($symbol, "₉"),
            concat!($symbol, "₁₀"),
        ]
    };
}
pub(crate) use {by_mass, symbols_by_mass};

static DISPLACEMENT: ChannelInfo = ChannelInfo {
    keys: by_mass!("displacement", "_"),
    names: by_mass!("displacement", " "),
    symbols: symbols_by_mass!("x", "x"),
    unit: "m",
    role: Role::Motion,
    rate: Some(&VELOCITY),
    mirrored: false,
    usual: Usual { mean: 0.0, std: 0.1, process: 1e-4, truth: &[], slider: (-1.0, 1.0), decimals: 4 },
};

static VELOCITY: ChannelInfo = ChannelInfo {
    keys: by_mass!("velocity", "_"),
    names: by_mass!("velocity", " "),
    symbols: symbols_by_mass!("v", "v"),
    unit: "m/s",
    role: Role::Motion,
    rate: None,
    mirrored: false,
    usual: Usual { mean: 0.0, std: 0.3, process: 1e-3, truth: &[], slider: (-5.0, 5.0), decimals: 3 },
};

impl Channel {
    /// x \[m\], of the first mass where there are several.
    pub const DISPLACEMENT: Self = Self::displacement(0);
    /// v = ẋ \[m/s\], of the first mass where there are several.
    pub const VELOCITY: Self = Self::velocity(0);

    /// The channel of a kind of which there is one.
    pub const fn new(info: &'static ChannelInfo) -> Self {
        Self { info, mass: 0 }
    }

    /// The channel of a kind for a mass, counted from 0. There must be a key for it.
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

    /// All that is known of its kind.
    pub const fn info(self) -> &'static ChannelInfo {
        self.info
    }

    /// The mass that it is of, counted from 0; 0 too where it is of none.
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

    /// Its part in a plant.
    pub const fn role(self) -> Role {
        self.info.role
    }

    /// Usual numbers.
    pub const fn usual(self) -> &'static Usual {
        &self.info.usual
    }

    /// The usual true value; zero for what moves.
    pub fn usual_truth(self) -> f64 {
        let truth = self.info.usual.truth;
        truth.get(self.mass()).or(truth.last()).copied().unwrap_or(0.0)
    }

    /// Whether the channel is a property of plant, input or sensor (true) or moves (false).
    pub const fn is_parameter(self) -> bool {
        !matches!(self.info.role, Role::Motion)
    }

    /// Whether the channel is a property of the input or of a sensor.
    pub const fn is_augmentation(self) -> bool {
        matches!(self.info.role, Role::Augmentation)
    }

    /// The channel that is its rate of change: the velocity, of a displacement.
    pub const fn rate(self) -> Option<Self> {
        match self.info.rate {
            Some(info) => Some(Self { info, mass: self.mass }),
            None => None,
        }
    }

    /// Whether the channel is a parameter that cannot be negative, so that its logarithm may be estimated instead.
    pub const fn is_positive(self) -> bool {
        matches!(self.info.role, Role::Parameter(Sign::NotNegative | Sign::Positive))
    }

    /// Whether the channel changes its sign together with the natural frequency, which leaves the oscillator the same.
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

impl Hash for Channel {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.key().hash(state);
    }
}

impl PartialOrd for Channel {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Channel {
    /// By key.
    fn cmp(&self, other: &Self) -> Ordering {
        self.key().cmp(other.key())
    }
}

impl fmt::Debug for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.key())
    }
}

impl Serialize for Channel {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.key())
    }
}

/// The keys to choose from in a message: those of first masses, and how others are called.
pub(crate) fn expected<'a>(keys: impl Iterator<Item = &'a str>) -> String {
    let keys: Vec<String> = keys.map(|key| format!("`{key}`")).collect();
    format!("one of {}, and of other masses as in `displacement_2`", keys.join(", "))
}
