//! The measurable quantities, the aspects of a mass that a sensor can measure, and the input, as data.

use std::cmp::Ordering;
use std::sync::LazyLock;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use crate::Channel;
use crate::channel::{ChannelInfo, MAX_MASSES, Usual, by_mass, expected, symbols_by_mass};
use crate::registry::{hashed, keyed};

/// The most sensors that one scenario can have.
pub const MAX_SENSORS: usize = 24;

/// A measurable quantity: an aspect of a mass.
#[derive(Clone, Copy, PartialEq, Eq)]
pub struct Quantity {
    aspect: Aspect,
    mass: u8,
}

impl Quantity {
    /// x \[m\]
    pub const DISPLACEMENT: Self = Self::new(Aspect::DISPLACEMENT, 0);
    /// ẋ \[m/s\]
    pub const VELOCITY: Self = Self::new(Aspect::VELOCITY, 0);
    /// ẍ \[m/s²\]
    pub const ACCELERATION: Self = Self::new(Aspect::ACCELERATION, 0);
    /// ẍ and the ground's acceleration \[m/s²\]
    pub const TOTAL_ACCELERATION: Self = Self::new(Aspect::TOTAL_ACCELERATION, 0);

    /// An aspect of a mass, counted from 0 and below [`MAX_MASSES`].
    pub const fn new(aspect: Aspect, mass: usize) -> Self {
        assert!(mass < MAX_MASSES, "there is no such mass");
        Self { aspect, mass: mass as u8 }
    }

    /// Every quantity, mass by mass.
    pub fn all() -> &'static [Self] {
        static ALL: LazyLock<Vec<Quantity>> = LazyLock::new(|| {
            let of = |mass| Aspect::ALL.map(|aspect| Quantity::new(aspect, mass));
            (0..MAX_MASSES).flat_map(of).collect()
        });
        &ALL
    }

    /// The quantity with this key, if there is one.
    pub fn from_key(key: &str) -> Option<Self> {
        Self::all().iter().copied().find(|quantity| quantity.key() == key)
    }

    /// The measured aspect of the mass.
    pub const fn aspect(self) -> Aspect {
        self.aspect
    }

    /// The mass, counted from 0.
    pub const fn mass(self) -> usize {
        self.mass as usize
    }

    /// The key in scenario files and the column in CSV files.
    pub const fn key(self) -> &'static str {
        self.aspect.info().keys[self.mass as usize]
    }

    /// The name in running text.
    pub fn name(self) -> String {
        self.key().replace('_', " ")
    }

    /// The symbol in formulas.
    pub const fn symbol(self) -> &'static str {
        self.aspect.info().symbols[self.mass as usize]
    }

    /// The unit.
    pub const fn unit(self) -> &'static str {
        self.aspect.info().unit
    }

    /// The reading of a perfect sensor, as a sum of weighted terms.
    pub fn reads(self) -> Vec<(Term, f64)> {
        (self.aspect.info().reads)(self.mass())
    }

    /// The channel that equals the reading, if there is one.
    pub fn channel(self) -> Option<Channel> {
        match self.reads()[..] {
            [(Term::State(channel), 1.0)] => Some(channel),
            _ => None,
        }
    }

    /// The bias of a sensor for it.
    pub const fn bias(self) -> Channel {
        Channel::of_mass(&self.aspect.info().bias, self.mass as usize)
    }

    /// The gain of a sensor for it.
    pub const fn gain(self) -> Channel {
        Channel::of_mass(&self.aspect.info().gain, self.mass as usize)
    }

    pub(crate) const fn stream(self) -> u64 {
        let (first, distance) = self.aspect.info().streams;
        let stream = first + distance * self.mass as u64;
        // Below 64 there is room for sixteen masses; there ensembles begin.
        if first < 64 && stream >= 64 { (4 << 32) + stream } else { stream }
    }

    /// Its place among others.
    pub fn place_in(self, all: &[Self]) -> Option<usize> {
        all.iter().position(|&other| other == self)
    }

    fn place(self) -> usize {
        self.place_in(Self::all()).unwrap_or(usize::MAX)
    }
}

impl Ord for Quantity {
    fn cmp(&self, other: &Self) -> Ordering {
        self.place().cmp(&other.place())
    }
}

keyed!(Quantity);
hashed!(Quantity);

impl<'de> Deserialize<'de> for Quantity {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let key = String::deserialize(deserializer)?;
        let expected = || expected(Aspect::ALL.iter().map(|aspect| aspect.info().keys[0]));
        Self::from_key(&key)
            .ok_or_else(|| de::Error::custom(format!("unknown variant `{key}`, expected {}", expected())))
    }
}

/// A part of a sensor's reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Term {
    /// A component of the state.
    State(Channel),
    /// The rate of change of a component of the state.
    Rate(Channel),
    /// The acceleration of the ground \[m/s²\], which is zero unless the input is one.
    Ground,
}

/// The data of an aspect.
#[derive(Debug)]
#[non_exhaustive]
pub struct AspectInfo {
    /// Keys in scenario files and columns in CSV files, in the order of the masses; also the names.
    pub keys: &'static [&'static str],
    /// Symbols in formulas, in the order of the masses.
    pub symbols: &'static [&'static str],
    /// The unit.
    pub unit: &'static str,
    /// A usual standard deviation of its noise.
    pub usual_noise: f64,
    /// The reading for a mass, counted from 0, as a sum of weighted terms.
    pub reads: fn(usize) -> Vec<(Term, f64)>,
    /// The random stream of the first mass, and the distance to the next mass's. Other numbers would give other noise.
    pub streams: (u64, u64),
    /// The bias of such a sensor.
    pub bias: ChannelInfo,
    /// The gain of such a sensor: its reading over what it measures.
    pub gain: ChannelInfo,
}

/// The measured aspect of a mass, such as its displacement.
#[derive(Clone, Copy)]
pub struct Aspect(&'static AspectInfo);

macro_rules! of_sensors {
    ($key:literal, $name:literal, $symbol:literal, $unit:literal, $usual:expr) => {
        ChannelInfo::augmentation(
            [by_mass!($key, "_"), by_mass!($name, " "), symbols_by_mass!($symbol, $symbol)],
            $unit,
            $usual,
        )
    };
}

const GAIN: Usual = Usual { mean: 1.0, std: 0.2, process: 0.0, truth: &[1.0], slider: (-2.0, 3.0), decimals: 4 };

const fn bias(noise: f64) -> Usual {
    Usual { std: 5.0 * noise, slider: (-20.0 * noise, 20.0 * noise), mean: 0.0, truth: &[0.0], ..GAIN }
}

static DISPLACEMENT: AspectInfo = AspectInfo {
    keys: by_mass!("displacement", "_"),
    symbols: symbols_by_mass!("x", "x"),
    unit: "m",
    usual_noise: 0.01,
    reads: |mass| vec![(Term::State(Channel::displacement(mass)), 1.0)],
    streams: (16, 3),
    bias: of_sensors!("bias_displacement", "bias of the displacement", "bˣ", "m", bias(0.01)),
    gain: of_sensors!("sensor_gain_displacement", "sensor gain of the displacement", "gˣ", "", GAIN),
};

static VELOCITY: AspectInfo = AspectInfo {
    keys: by_mass!("velocity", "_"),
    symbols: symbols_by_mass!("v", "v"),
    unit: "m/s",
    usual_noise: 0.06,
    reads: |mass| vec![(Term::State(Channel::velocity(mass)), 1.0)],
    streams: (17, 3),
    bias: of_sensors!("bias_velocity", "bias of the velocity", "bᵛ", "m/s", bias(0.06)),
    gain: of_sensors!("sensor_gain_velocity", "sensor gain of the velocity", "gᵛ", "", GAIN),
};

static ACCELERATION: AspectInfo = AspectInfo {
    keys: by_mass!("acceleration", "_"),
    symbols: symbols_by_mass!("ẍ", "ẍ"),
    unit: "m/s²",
    usual_noise: 0.3,
    reads: |mass| vec![(Term::Rate(Channel::velocity(mass)), 1.0)],
    streams: (18, 3),
    bias: of_sensors!("bias_acceleration", "bias of the acceleration", "bᵃ", "m/s²", bias(0.3)),
    gain: of_sensors!("sensor_gain_acceleration", "sensor gain of the acceleration", "gᵃ", "", GAIN),
};

static TOTAL_ACCELERATION: AspectInfo = AspectInfo {
    keys: by_mass!("total_acceleration", "_"),
    symbols: symbols_by_mass!("ẍᵗ", "ẍᵗ"),
    unit: "m/s²",
    usual_noise: 0.3,
    reads: |mass| vec![(Term::Rate(Channel::velocity(mass)), 1.0), (Term::Ground, 1.0)],
    streams: (1 << 32, 1),
    bias: of_sensors!("bias_total_acceleration", "bias of the total acceleration", "bᵗ", "m/s²", bias(0.3)),
    gain: of_sensors!("sensor_gain_total_acceleration", "sensor gain of the total acceleration", "gᵗ", "", GAIN),
};

static DRIFT: AspectInfo = AspectInfo {
    keys: by_mass!("drift", "_"),
    symbols: symbols_by_mass!("Δx", "Δx"),
    unit: "m",
    usual_noise: 0.01,
    reads: |mass| {
        let above = (Term::State(Channel::displacement(mass)), 1.0);
        let below = mass.checked_sub(1).map(|below| (Term::State(Channel::displacement(below)), -1.0));
        std::iter::once(above).chain(below).collect()
    },
    streams: (2 << 32, 1),
    bias: of_sensors!("bias_drift", "bias of the drift", "bᵈ", "m", bias(0.01)),
    gain: of_sensors!("sensor_gain_drift", "sensor gain of the drift", "gᵈ", "", GAIN),
};

impl Aspect {
    /// The displacement against the base \[m\].
    pub const DISPLACEMENT: Self = Self(&DISPLACEMENT);
    /// The velocity against the base \[m/s\].
    pub const VELOCITY: Self = Self(&VELOCITY);
    /// The acceleration against the base \[m/s²\].
    pub const ACCELERATION: Self = Self(&ACCELERATION);
    /// The absolute acceleration: that against the base plus the ground's \[m/s²\].
    pub const TOTAL_ACCELERATION: Self = Self(&TOTAL_ACCELERATION);
    /// The displacement against the mass below, or the base \[m\].
    pub const DRIFT: Self = Self(&DRIFT);

    /// Every aspect.
    pub const ALL: [Self; 5] =
        [Self::DISPLACEMENT, Self::VELOCITY, Self::ACCELERATION, Self::TOTAL_ACCELERATION, Self::DRIFT];

    /// The data of the aspect.
    pub const fn info(self) -> &'static AspectInfo {
        self.0
    }
}

impl PartialEq for Aspect {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.0, other.0)
    }
}

impl Eq for Aspect {}

/// The physical meaning of a record's input.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InputKind {
    /// A force over mass \[m/s²\].
    #[default]
    Force,
    /// The acceleration of the ground \[m/s²\]: the force over mass is its negative.
    GroundAcceleration,
}

impl InputKind {
    /// The force over mass for a value of the input, both in m/s².
    #[inline]
    pub fn force(self, input: f64) -> f64 {
        match self {
            Self::Force => input,
            Self::GroundAcceleration => -input,
        }
    }
}

/// A mass on which a force is recorded, besides the input that acts on all masses. Its key is `force_on_3` for the third one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ForcedMass(u8);

const FORCES_ON: &[&str] = by_mass!("force_on_1"; "force_on", "_", "");

impl ForcedMass {
    /// A mass, counted from 0.
    pub fn new(mass: usize) -> Option<Self> {
        (mass < MAX_MASSES).then_some(Self(mass as u8))
    }

    /// The mass with a key.
    pub fn from_key(key: &str) -> Option<Self> {
        FORCES_ON.iter().position(|own| *own == key).and_then(Self::new)
    }

    /// The mass, counted from 0.
    pub const fn mass(self) -> usize {
        self.0 as usize
    }

    /// The key in scenario files and the column in CSV files.
    pub const fn key(self) -> &'static str {
        FORCES_ON[self.0 as usize]
    }

    /// The name in running text.
    pub fn name(self) -> String {
        format!("force on mass {}", self.0 + 1)
    }
}

impl Serialize for ForcedMass {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.key())
    }
}

impl<'de> Deserialize<'de> for ForcedMass {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let key = String::deserialize(deserializer)?;
        let problem = || format!("unknown force `{key}`: the keys are `force_on_1` to `force_on_{MAX_MASSES}`");
        Self::from_key(&key).ok_or_else(|| de::Error::custom(problem()))
    }
}

/// The course of the input between samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Hold {
    /// It keeps the value of a sample until the next one: a zero-order hold.
    #[default]
    Zero,
    /// It is linear from each sample to the next: a first-order hold.
    First,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_the_ones_in_files_and_readings_are_sums_of_channels() {
        for (place, &quantity) in Quantity::all().iter().enumerate() {
            assert_eq!(quantity.place(), place);
            assert_eq!(toml::Value::try_from(quantity).unwrap().as_str(), Some(quantity.key()));
            assert_eq!(quantity.bias().key(), format!("bias_{}", quantity.key()));
            assert_eq!(quantity.gain().key(), format!("sensor_gain_{}", quantity.key()));
        }
        let drift = Quantity::new(Aspect::DRIFT, 2);
        let terms = [(Term::State(Channel::displacement(2)), 1.0), (Term::State(Channel::displacement(1)), -1.0)];
        assert_eq!(drift.reads(), terms);
        assert_eq!(Quantity::new(Aspect::DRIFT, 0).channel(), Some(Channel::DISPLACEMENT));
        assert_eq!(Quantity::ACCELERATION.channel(), None);
    }
}
