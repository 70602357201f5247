//! An oscillator with a cubic spring.

use super::{Plant, PlantInfo, Spring};
use crate::Channel;
use crate::mathematics::channel::{ChannelInfo, Role, Sign, Usual};
use crate::mathematics::engine::plants::{self, Equation, duffing};

/// `ẍ + 2ζωₙẋ + ωₙ²x + μx³ = f` with state `y = [x, v, ωₙ, ζ, μ]`.
///
/// ```text
/// g(y, f) = [v, f - 2ζωₙv - ωₙ²x - μx³, …]
/// ```
///
/// The spring hardens with μ > 0 and softens with μ < 0.
///
/// Source: Duffing (1918), *Erzwungene Schwingungen bei veränderlicher Eigenfrequenz*; Kovacic and Brennan, eds. (2011),
/// *The Duffing Equation*.
#[derive(Clone, Copy, Debug)]
pub struct Duffing;

static CUBIC_STIFFNESS: ChannelInfo = ChannelInfo {
    keys: &["cubic_stiffness"],
    names: &["cubic stiffness"],
    symbols: &["μ"],
    unit: "1/(m² s²)",
    role: Role::Parameter(Sign::Any),
    rate: None,
    mirrored: false,
    usual: Usual { mean: 100.0, std: 200.0, process: 0.01, truth: &[300.0], slider: (-50.0, 1000.0), decimals: 1 },
};

impl Channel {
    /// μ, cubic stiffness over mass \[1/(m² s²)\]
    pub const CUBIC_STIFFNESS: Self = Self::new(&CUBIC_STIFFNESS);
}

static INFO: PlantInfo = PlantInfo {
    key: "duffing",
    name: "Duffing oscillator",
    equation: "ẍ + 2ζωₙẋ + ωₙ²x + μx³ = f",
    reference: "Kovacic and Brennan, eds. (2011), The Duffing Equation",
    channels: &[
        Channel::DISPLACEMENT,
        Channel::VELOCITY,
        Channel::NATURAL_FREQUENCY,
        Channel::DAMPING_RATIO,
        Channel::CUBIC_STIFFNESS,
    ],
    is_linear: false,
    spring: Spring::Cubic(Channel::CUBIC_STIFFNESS),
};

impl Plant for Duffing {
    fn info(&self) -> &PlantInfo {
        &INFO
    }

    fn motion_rate(&self, state: &[f64], force: f64, rate: &mut [f64]) {
        duffing::Duffing.rate(state, force, rate);
    }

    fn motion_jacobian(&self, state: &[f64], out: &mut [f64]) {
        plants::Plant::Duffing.jacobian(state, out);
    }
}
