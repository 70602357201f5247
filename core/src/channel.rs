//! The quantities that a filter estimates, by name.

use serde::{Deserialize, Serialize};

/// One component of a plant's augmented state: a motion or a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Channel {
    /// x \[m\]
    Displacement,
    /// v = ẋ \[m/s\]
    Velocity,
    /// ωₙ \[rad/s\]
    NaturalFrequency,
    /// ζ \[-\]
    DampingRatio,
}

impl Channel {
    /// Every channel, in the order of [`crate::PerChannel`].
    pub const ALL: [Self; 4] = [Self::Displacement, Self::Velocity, Self::NaturalFrequency, Self::DampingRatio];

    /// The key in scenario files and the column in CSV files.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::NaturalFrequency => "natural_frequency",
            Self::DampingRatio => "damping_ratio",
        }
    }

    /// The name in running text.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::NaturalFrequency => "natural frequency",
            Self::DampingRatio => "damping ratio",
        }
    }

    /// The symbol in formulas.
    pub const fn symbol(self) -> &'static str {
        match self {
            Self::Displacement => "x",
            Self::Velocity => "v",
            Self::NaturalFrequency => "ωₙ",
            Self::DampingRatio => "ζ",
        }
    }

    /// The unit, empty for a pure number.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Displacement => "m",
            Self::Velocity => "m/s",
            Self::NaturalFrequency => "rad/s",
            Self::DampingRatio => "",
        }
    }

    /// Whether the channel is a property of the plant (true) or of its motion (false).
    pub const fn is_parameter(self) -> bool {
        matches!(self, Self::NaturalFrequency | Self::DampingRatio)
    }

    /// Whether the channel changes its sign together with the natural frequency, which leaves the oscillator the same.
    pub(crate) const fn is_mirrored(self) -> bool {
        matches!(self, Self::NaturalFrequency | Self::DampingRatio)
    }
}
