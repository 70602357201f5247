//! What a sensor measures.

use serde::{Deserialize, Serialize};

use crate::Channel;

/// The most sensors that one scenario can have.
pub const MAX_SENSORS: usize = 4;

/// A measurable quantity of a mass: of the only one, or of one in a chain.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// x \[m\]
    Displacement,
    /// ẋ \[m/s\]
    Velocity,
    /// ẍ \[m/s²\]
    Acceleration,
    /// x₂ \[m\]
    #[serde(rename = "displacement_2")]
    Displacement2,
    /// ẋ₂ \[m/s\]
    #[serde(rename = "velocity_2")]
    Velocity2,
    /// ẍ₂ \[m/s²\]
    #[serde(rename = "acceleration_2")]
    Acceleration2,
    /// x₃ \[m\]
    #[serde(rename = "displacement_3")]
    Displacement3,
    /// ẋ₃ \[m/s\]
    #[serde(rename = "velocity_3")]
    Velocity3,
    /// ẍ₃ \[m/s²\]
    #[serde(rename = "acceleration_3")]
    Acceleration3,
    /// x₄ \[m\]
    #[serde(rename = "displacement_4")]
    Displacement4,
    /// ẋ₄ \[m/s\]
    #[serde(rename = "velocity_4")]
    Velocity4,
    /// ẍ₄ \[m/s²\]
    #[serde(rename = "acceleration_4")]
    Acceleration4,
}

/// What of a mass is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Aspect {
    /// Its displacement.
    Displacement,
    /// Its velocity.
    Velocity,
    /// Its acceleration.
    Acceleration,
}

impl Quantity {
    /// Every quantity, mass by mass.
    pub const ALL: [Self; 12] = [
        Self::Displacement,
        Self::Velocity,
        Self::Acceleration,
        Self::Displacement2,
        Self::Velocity2,
        Self::Acceleration2,
        Self::Displacement3,
        Self::Velocity3,
        Self::Acceleration3,
        Self::Displacement4,
        Self::Velocity4,
        Self::Acceleration4,
    ];

    const KEYS: [&'static str; 12] = [
        "displacement",
        "velocity",
        "acceleration",
        "displacement_2",
        "velocity_2",
        "acceleration_2",
        "displacement_3",
        "velocity_3",
        "acceleration_3",
        "displacement_4",
        "velocity_4",
        "acceleration_4",
    ];

    const SYMBOLS: [&'static str; 12] = ["x", "v", "ẍ", "x₂", "v₂", "ẍ₂", "x₃", "v₃", "ẍ₃", "x₄", "v₄", "ẍ₄"];

    /// The key in scenario files and the column in CSV files, which is also its name.
    pub const fn key(self) -> &'static str {
        Self::KEYS[self as usize]
    }

    /// The symbol in formulas.
    pub const fn symbol(self) -> &'static str {
        Self::SYMBOLS[self as usize]
    }

    /// The unit.
    pub const fn unit(self) -> &'static str {
        match self.aspect() {
            Aspect::Displacement => "m",
            Aspect::Velocity => "m/s",
            Aspect::Acceleration => "m/s²",
        }
    }

    /// The mass, counted from 0.
    pub const fn mass(self) -> usize {
        self as usize / 3
    }

    /// The channel that it shows directly, which an acceleration has not.
    pub const fn channel(self) -> Option<Channel> {
        const CHANNELS: [[Channel; 2]; 4] = [
            [Channel::Displacement, Channel::Velocity],
            [Channel::Displacement2, Channel::Velocity2],
            [Channel::Displacement3, Channel::Velocity3],
            [Channel::Displacement4, Channel::Velocity4],
        ];
        let [displacement, velocity] = CHANNELS[self.mass()];
        match self.aspect() {
            Aspect::Displacement => Some(displacement),
            Aspect::Velocity => Some(velocity),
            Aspect::Acceleration => None,
        }
    }

    /// The quantity whose rate of change it is: the velocity, of an acceleration.
    pub const fn integral(self) -> Option<Self> {
        match self.aspect() {
            Aspect::Acceleration => Some(Self::ALL[self as usize - 1]),
            Aspect::Displacement | Aspect::Velocity => None,
        }
    }

    /// What of the mass is measured.
    pub const fn aspect(self) -> Aspect {
        match self as usize % 3 {
            0 => Aspect::Displacement,
            1 => Aspect::Velocity,
            _ => Aspect::Acceleration,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_the_ones_in_files() {
        for (i, quantity) in Quantity::ALL.into_iter().enumerate() {
            assert_eq!(quantity as usize, i);
            let written = toml::Value::try_from(quantity).unwrap();
            assert_eq!(written.as_str(), Some(quantity.key()));
        }
    }
}
