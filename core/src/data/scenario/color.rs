//! The colours of filters.

use serde::{Deserialize, Serialize};

/// A colour of the palette of Okabe and Ito, which colour-blind readers can distinguish. Each theme chooses the shade.
///
/// Source: Okabe and Ito (2008), Color Universal Design.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FilterColor {
    /// Blue.
    Blue,
    /// Vermilion, a red that leans to orange.
    Vermilion,
    /// Bluish green.
    Green,
    /// Reddish purple.
    Purple,
    /// Orange.
    Orange,
    /// Sky blue.
    Sky,
}

impl FilterColor {
    /// Every colour, in the order in which filters get them.
    pub const ALL: [Self; 6] = [Self::Blue, Self::Vermilion, Self::Green, Self::Purple, Self::Orange, Self::Sky];

    /// The colour of the filter with this id, unless it has one of its own.
    pub const fn of(id: u32) -> Self {
        Self::ALL[(id as usize).saturating_sub(1) % Self::ALL.len()]
    }

    /// The name in running text.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Blue => "blue",
            Self::Vermilion => "vermilion",
            Self::Green => "green",
            Self::Purple => "purple",
            Self::Orange => "orange",
            Self::Sky => "sky",
        }
    }
}
