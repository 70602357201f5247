//! Spells of samples in which something is wrong.

use super::{FaultNumber, Scale};
use crate::data::setting::Allowed;
use crate::mathematics::random::Normal;

/// The share of samples in spells, and their mean length.
pub(super) const NUMBERS: [FaultNumber; 2] = [
    FaultNumber {
        key: "share",
        name: "share of the samples",
        scale: Scale::Pure,
        usual: 0.1,
        slider: (0.0, 0.9),
        allowed: Allowed::Within(0.0, 1.0),
    },
    FaultNumber {
        key: "length",
        name: "mean length",
        scale: Scale::Seconds,
        usual: 0.2,
        slider: (0.0, 5.0),
        allowed: Allowed::AtLeast(0.0),
    },
];

/// Spells whose lengths are distributed geometrically. A mean length of a sample or less makes them independent.
pub(super) struct Spells {
    share: f64,
    length: f64,
    /// `None` before the first sample.
    is_in: Option<bool>,
    random: Normal,
}

impl Spells {
    pub(super) fn new(share: f64, length: f64, random: Normal) -> Self {
        Self { share, length, is_in: None, random }
    }

    /// Whether the next sample is in a spell.
    pub(super) fn next(&mut self, dt: f64) -> bool {
        let ends = (dt / self.length).min(1.0);
        // Spells begin so often that a sample is in one with the probability of the share.
        let begins = match self.share {
            share if share < 1.0 => share * ends / (1.0 - share + share * ends),
            _ => 1.0,
        };
        let [stay, begin] = [(); 2].map(|()| self.random.uniform());
        let is_in = match self.is_in {
            Some(is_in) => is_in && stay > ends || begin <= begins,
            None => begin <= self.share,
        };
        self.is_in = Some(is_in);
        is_in
    }
}
