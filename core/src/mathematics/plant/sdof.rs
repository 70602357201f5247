//! The linear oscillator with a single degree of freedom.

use super::{Plant, PlantInfo, Spring};
use crate::Channel;
use crate::mathematics::channel::{ChannelInfo, Role, Sign, Usual};
use crate::mathematics::engine::plants::{self, Equation, sdof};

/// `ẍ + 2ζωₙẋ + ωₙ²x = f` with state `y = [x, v, ωₙ, ζ]`.
///
/// ```text
/// g(y, f) = [v, f - 2ζωₙv - ωₙ²x, …]
/// ```
///
/// Source: Huang and Yuen (2023), *Bayesian Real-Time System Identification*.
#[derive(Clone, Copy, Debug)]
pub struct Sdof;

static NATURAL_FREQUENCY: ChannelInfo = ChannelInfo {
    keys: &["natural_frequency"],
    names: &["natural frequency"],
    symbols: &["ωₙ"],
    unit: "rad/s",
    role: Role::Parameter(Sign::Positive),
    rate: None,
    mirrored: true,
    usual: Usual { mean: 8.0, std: 2.0, process: 1e-4, truth: &[6.0], slider: (0.5, 20.0), decimals: 3 },
};

static DAMPING_RATIO: ChannelInfo = ChannelInfo {
    keys: &["damping_ratio"],
    names: &["damping ratio"],
    symbols: &["ζ"],
    unit: "",
    role: Role::Parameter(Sign::NotNegative),
    rate: None,
    mirrored: true,
    usual: Usual { mean: 0.1, std: 0.1, process: 3e-5, truth: &[0.05], slider: (0.0, 0.5), decimals: 4 },
};

impl Channel {
    /// ωₙ \[rad/s\]
    pub const NATURAL_FREQUENCY: Self = Self::new(&NATURAL_FREQUENCY);
    /// ζ \[-\]
    pub const DAMPING_RATIO: Self = Self::new(&DAMPING_RATIO);
}

static INFO: PlantInfo = PlantInfo {
    key: "sdof",
    name: "linear oscillator",
    equation: "ẍ + 2ζωₙẋ + ωₙ²x = f",
    reference: "Huang and Yuen (2023), Bayesian Real-Time System Identification",
    channels: &[Channel::DISPLACEMENT, Channel::VELOCITY, Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO],
    is_linear: true,
    spring: Spring::Linear,
};

impl Plant for Sdof {
    fn info(&self) -> &PlantInfo {
        &INFO
    }

    fn motion_rate(&self, state: &[f64], force: f64, rate: &mut [f64]) {
        sdof::Sdof.rate(state, force, rate);
    }

    fn motion_jacobian(&self, state: &[f64], out: &mut [f64]) {
        plants::Plant::Sdof.jacobian(state, out);
    }
}
