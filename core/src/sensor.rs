//! What a sensor measures.

use serde::{Deserialize, Serialize};

/// The most sensors that one scenario can have: one of each quantity.
pub const MAX_SENSORS: usize = Quantity::ALL.len();

/// A measurable quantity of the oscillator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// x \[m\]
    Displacement,
    /// ẋ \[m/s\]
    Velocity,
    /// ẍ \[m/s²\]
    Acceleration,
}

impl Quantity {
    /// Every quantity.
    pub const ALL: [Self; 3] = [Self::Displacement, Self::Velocity, Self::Acceleration];

    /// The key in scenario files and the column in CSV files, which is also its name.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
        }
    }

    /// The symbol in formulas.
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Displacement => "x",
            Self::Velocity => "v",
            Self::Acceleration => "ẍ",
        }
    }

    /// The unit.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Displacement => "m",
            Self::Velocity => "m/s",
            Self::Acceleration => "m/s²",
        }
    }
}
