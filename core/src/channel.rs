//! The quantities that a filter estimates, by name.

use serde::{Deserialize, Serialize};

/// The one table of channels, handed to a macro that makes something of it. A row has the channel, its field, key, name, symbol
/// and unit, what it is, and the mean, the standard deviation and the process noise per step that a filter takes unless
/// told otherwise.
macro_rules! channel_table {
    ($make:ident) => {
        $make! {
            "x \\[m\\], of the first mass where there are several"
            Displacement displacement "displacement" "displacement" "x" "m" Motion [0.0, 0.1, 1e-4];
            "v = ẋ \\[m/s\\], of the first mass where there are several"
            Velocity velocity "velocity" "velocity" "v" "m/s" Motion [0.0, 0.3, 1e-3];
            "ωₙ \\[rad/s\\]"
            NaturalFrequency natural_frequency "natural_frequency" "natural frequency" "ωₙ" "rad/s" PositiveParameter [8.0, 2.0, 1e-4];
            "ζ \\[-\\]"
            DampingRatio damping_ratio "damping_ratio" "damping ratio" "ζ" "" PositiveParameter [0.1, 0.1, 3e-5];
            "μ, cubic stiffness over mass \\[1/(m² s²)\\]"
            CubicStiffness cubic_stiffness "cubic_stiffness" "cubic stiffness" "μ" "1/(m² s²)" Parameter [100.0, 200.0, 0.01];
            "z \\[m\\], the displacement that the hysteretic spring remembers"
            HystereticDisplacement hysteretic_displacement "hysteretic_displacement" "hysteretic displacement" "z" "m" Motion [0.0, 0.05, 1e-4];
            "α \\[-\\], stiffness after yielding over that before"
            PostYieldRatio post_yield_ratio "post_yield_ratio" "post-yield ratio" "α" "" Parameter [0.1, 0.0, 0.0];
            "β \\[1/m²\\], shape of the hysteresis loop"
            HysteresisBeta hysteresis_beta "hysteresis_beta" "hysteresis β" "β" "1/m²" Parameter [50.0, 15.0, 0.01];
            "γ \\[1/m²\\], shape of the hysteresis loop"
            HysteresisGamma hysteresis_gamma "hysteresis_gamma" "hysteresis γ" "γ" "1/m²" Parameter [30.0, 15.0, 0.01];
            "x₂ \\[m\\]"
            Displacement2 displacement_2 "displacement_2" "displacement 2" "x₂" "m" Motion [0.0, 0.1, 1e-4];
            "x₃ \\[m\\]"
            Displacement3 displacement_3 "displacement_3" "displacement 3" "x₃" "m" Motion [0.0, 0.1, 1e-4];
            "x₄ \\[m\\]"
            Displacement4 displacement_4 "displacement_4" "displacement 4" "x₄" "m" Motion [0.0, 0.1, 1e-4];
            "v₂ \\[m/s\\]"
            Velocity2 velocity_2 "velocity_2" "velocity 2" "v₂" "m/s" Motion [0.0, 0.3, 1e-3];
            "v₃ \\[m/s\\]"
            Velocity3 velocity_3 "velocity_3" "velocity 3" "v₃" "m/s" Motion [0.0, 0.3, 1e-3];
            "v₄ \\[m/s\\]"
            Velocity4 velocity_4 "velocity_4" "velocity 4" "v₄" "m/s" Motion [0.0, 0.3, 1e-3];
            "κ₁, stiffness of the first storey over mass \\[1/s²\\]"
            Stiffness1 stiffness_1 "stiffness_1" "stiffness 1" "κ₁" "1/s²" PositiveParameter [150.0, 30.0, 0.01];
            "κ₂, stiffness of the second storey over mass \\[1/s²\\]"
            Stiffness2 stiffness_2 "stiffness_2" "stiffness 2" "κ₂" "1/s²" PositiveParameter [150.0, 30.0, 0.01];
            "κ₃, stiffness of the third storey over mass \\[1/s²\\]"
            Stiffness3 stiffness_3 "stiffness_3" "stiffness 3" "κ₃" "1/s²" PositiveParameter [150.0, 30.0, 0.01];
            "κ₄, stiffness of the fourth storey over mass \\[1/s²\\]"
            Stiffness4 stiffness_4 "stiffness_4" "stiffness 4" "κ₄" "1/s²" PositiveParameter [150.0, 30.0, 0.01];
            "c, damping of every storey over mass \\[1/s\\]"
            StoreyDamping storey_damping "storey_damping" "storey damping" "c" "1/s" PositiveParameter [0.5, 0.3, 1e-4];
        }
    };
}
pub(crate) use channel_table;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Role {
    Motion,
    Parameter,
    PositiveParameter,
}

macro_rules! make_channel {
    ($($doc:literal $variant:ident $field:ident $key:literal $name:literal $symbol:literal $unit:literal $role:ident $usual:expr;)*) => {
        /// One component of a plant's augmented state: a motion or a parameter.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
        pub enum Channel {
            $(#[doc = $doc] #[serde(rename = $key)] $variant,)*
        }

        impl Channel {
            /// Every channel of every plant, in the order of [`crate::PerChannel`].
            pub const ALL: [Self; [$(Self::$variant),*].len()] = [$(Self::$variant),*];

            /// The key in scenario files and the column in CSV files.
            pub const fn key(self) -> &'static str {
                match self {
                    $(Self::$variant => $key,)*
                }
            }

            /// The name in running text.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name,)*
                }
            }

            /// The symbol in formulas.
            pub const fn symbol(self) -> &'static str {
                match self {
                    $(Self::$variant => $symbol,)*
                }
            }

            /// The unit, empty for a pure number.
            pub const fn unit(self) -> &'static str {
                match self {
                    $(Self::$variant => $unit,)*
                }
            }

            const fn role(self) -> Role {
                match self {
                    $(Self::$variant => Role::$role,)*
                }
            }
        }
    };
}
channel_table!(make_channel);

impl Channel {
    /// Whether the channel is a property of the plant (true) or of its motion (false).
    pub const fn is_parameter(self) -> bool {
        !matches!(self.role(), Role::Motion)
    }

    /// The channel that is its rate of change: the velocity, of a displacement.
    pub const fn rate(self) -> Option<Self> {
        match self {
            Self::Displacement => Some(Self::Velocity),
            Self::Displacement2 => Some(Self::Velocity2),
            Self::Displacement3 => Some(Self::Velocity3),
            Self::Displacement4 => Some(Self::Velocity4),
            _ => None,
        }
    }

    /// Whether the channel is a parameter that cannot be negative, so that its logarithm may be estimated instead.
    pub const fn is_positive(self) -> bool {
        matches!(self.role(), Role::PositiveParameter)
    }

    /// Whether the channel changes its sign together with the natural frequency, which leaves the oscillator the same.
    pub(crate) const fn is_mirrored(self) -> bool {
        matches!(self, Self::NaturalFrequency | Self::DampingRatio)
    }
}
