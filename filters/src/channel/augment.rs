//! Properties of the input and of the sensors, which can be added to any plant and to the state of any filter.
//!
//! ```text
//! F = g f + o + u + w,  zᵢ = gᵢ hᵢ(y, F) + bᵢ
//! ```
//!
//! with the recorded force over mass f, its gain g, its offset o, an unknown force over mass u, a white force over mass
//! w, the gain gᵢ and the bias bᵢ of a sensor. Each is one more component of the state, constant except for its process noise, so
//! that an unknown force is a random walk. The white force alone does not last: each sample has an independent one,
//! with the process noise as its standard deviation ([`crate::filter::White`]).
//!
//! Source: Lourens, Reynders, De Roeck, Degrande and Lombaert (2012), An augmented Kalman filter for force
//! identification in structural dynamics (the unknown force); Friedland (1969), Treatment of bias in recursive
//! filtering; Simon (2006), *Optimal State Estimation*, section 7.1 (process noise that the measurement feels: the
//! white force).

use crate::channel::{ChannelInfo, Usual};
use crate::{Channel, Quantity};

static INPUT_GAIN: ChannelInfo = ChannelInfo::augmentation(
    [&["input_gain"], &["input gain"], &["g"]],
    "",
    Usual { mean: 1.0, std: 0.2, process: 0.0, truth: &[1.0], slider: (0.0, 3.0), decimals: 4 },
);

static INPUT_OFFSET: ChannelInfo = ChannelInfo::augmentation(
    [&["input_offset"], &["input offset"], &["o"]],
    "m/s²",
    Usual { mean: 0.0, std: 1.0, process: 0.0, truth: &[0.0], slider: (-10.0, 10.0), decimals: 3 },
);

static UNKNOWN_FORCE: ChannelInfo = ChannelInfo::augmentation(
    [&["unknown_force"], &["unknown force"], &["u"]],
    "m/s²",
    Usual { mean: 0.0, std: 1.0, process: 0.3, truth: &[0.0], slider: (-20.0, 20.0), decimals: 3 },
);

static WHITE_FORCE: ChannelInfo = ChannelInfo::augmentation(
    [&["white_force"], &["white force"], &["w"]],
    "m/s²",
    Usual { mean: 0.0, std: 1.0, process: 1.0, truth: &[0.0], slider: (-20.0, 20.0), decimals: 3 },
);

impl Channel {
    /// g \[-\], the true input over the recorded one
    pub const INPUT_GAIN: Self = Self::new(&INPUT_GAIN);
    /// o \[m/s²\], a constant force over mass that the record lacks
    pub const INPUT_OFFSET: Self = Self::new(&INPUT_OFFSET);
    /// u \[m/s²\], a force over mass that is not recorded
    pub const UNKNOWN_FORCE: Self = Self::new(&UNKNOWN_FORCE);
    /// w \[m/s²\], a force over mass that is not recorded and is another one at each sample
    pub const WHITE_FORCE: Self = Self::new(&WHITE_FORCE);
}

/// The augmentations of the input.
pub const OF_INPUT: [Channel; 4] =
    [Channel::INPUT_GAIN, Channel::INPUT_OFFSET, Channel::UNKNOWN_FORCE, Channel::WHITE_FORCE];

/// Every augmentation: those of the input, then the bias and the gain of each sensor.
pub fn all() -> impl Iterator<Item = Channel> {
    of_all(Quantity::all().iter().copied())
}

/// The augmentations of the input, then the biases of sensors for these quantities, then their gains.
pub fn of_all(quantities: impl Iterator<Item = Quantity> + Clone) -> impl Iterator<Item = Channel> {
    OF_INPUT.into_iter().chain(quantities.clone().map(Quantity::bias)).chain(quantities.map(Quantity::gain))
}
