//! The measurable quantities, as data.

mod aspect;

use std::cmp::Ordering;
use std::fmt;
use std::hash::{Hash, Hasher};
use std::sync::LazyLock;

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use crate::Channel;
use crate::mathematics::channel::{MAX_MASSES, expected};

pub use aspect::{Aspect, AspectInfo, Term};

/// The most sensors that one scenario can have.
pub const MAX_SENSORS: usize = 12;

/// A measurable quantity: an aspect of a mass.
#[derive(Clone, Copy)]
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

    /// The number of the random stream of its noise.
    pub(crate) const fn stream(self) -> u64 {
        let (first, distance) = self.aspect.info().streams;
        first + distance * self.mass as u64
    }

    /// Its place in [`Self::all`].
    fn place(self) -> usize {
        Self::all().iter().position(|&q| q == self).unwrap_or(usize::MAX)
    }
}

impl PartialEq for Quantity {
    fn eq(&self, other: &Self) -> bool {
        self.mass == other.mass && self.aspect == other.aspect
    }
}

impl Eq for Quantity {}

impl Hash for Quantity {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.key().hash(state);
    }
}

impl PartialOrd for Quantity {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Quantity {
    /// Orders by mass, then by aspect.
    fn cmp(&self, other: &Self) -> Ordering {
        self.place().cmp(&other.place())
    }
}

impl fmt::Debug for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.key())
    }
}

impl Serialize for Quantity {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.key())
    }
}

impl<'de> Deserialize<'de> for Quantity {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let key = String::deserialize(deserializer)?;
        let expected = || expected(Aspect::ALL.iter().map(|aspect| aspect.info().keys[0]));
        Self::from_key(&key)
            .ok_or_else(|| de::Error::custom(format!("unknown variant `{key}`, expected {}", expected())))
    }
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
