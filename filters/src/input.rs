//! The input of a record: its meaning, and its course between samples.

use serde::{Deserialize, Serialize};

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
