//! An oscillator with a hysteretic spring.

use super::{Plant, PlantInfo, Spring};
use crate::Channel;
use crate::channel::{ChannelInfo, Role, Sign, Usual};
use crate::engine::plants::{Equation, bouc_wen};

/// Bouc-Wen hysteresis with exponent 2 and state `y = [x, v, z, ωₙ, ζ, α, β, γ]`.
///
/// ```text
/// ẍ + 2ζωₙẋ + ωₙ²(α x + (1 - α) z) = f,  ż = ẋ - β |ẋ| |z| z - γ ẋ z²
/// ```
///
/// z is a displacement that follows x until the spring yields, near `|z| = 1/√(β + γ)`. After yielding the stiffness is
/// α times the initial one. [`super::bouc_wen_one::BoucWenOne`] has the exponent 1.
///
/// Source: Wen (1976), Method for random vibration of hysteretic systems; Wu and Smyth (2007), Application of the unscented
/// Kalman filter for real-time nonlinear structural system identification, section 4.
#[derive(Clone, Copy, Debug)]
pub struct BoucWen;

static HYSTERETIC_DISPLACEMENT: ChannelInfo = ChannelInfo {
    keys: &["hysteretic_displacement"],
    names: &["hysteretic displacement"],
    symbols: &["z"],
    unit: "m",
    role: Role::Motion,
    rate: None,
    mirrored: false,
    usual: Usual { mean: 0.0, std: 0.05, process: 1e-4, truth: &[], slider: (-1.0, 1.0), decimals: 4 },
};

static POST_YIELD_RATIO: ChannelInfo = ChannelInfo {
    keys: &["post_yield_ratio"],
    names: &["post-yield ratio"],
    symbols: &["α"],
    unit: "",
    role: Role::Parameter(Sign::Any),
    rate: None,
    mirrored: false,
    usual: Usual { mean: 0.1, std: 0.0, process: 0.0, truth: &[0.1], slider: (0.0, 1.0), decimals: 4 },
};

static HYSTERESIS_BETA: ChannelInfo = ChannelInfo {
    keys: &["hysteresis_beta"],
    names: &["hysteresis β"],
    symbols: &["β"],
    unit: "1/m²",
    role: Role::Parameter(Sign::Any),
    rate: None,
    mirrored: false,
    usual: Usual { mean: 50.0, std: 15.0, process: 0.01, truth: &[60.0], slider: (-100.0, 200.0), decimals: 1 },
};

static HYSTERESIS_GAMMA: ChannelInfo = ChannelInfo {
    keys: &["hysteresis_gamma"],
    names: &["hysteresis γ"],
    symbols: &["γ"],
    unit: "1/m²",
    role: Role::Parameter(Sign::Any),
    rate: None,
    mirrored: false,
    usual: Usual { mean: 30.0, std: 15.0, process: 0.01, truth: &[40.0], slider: (-100.0, 200.0), decimals: 1 },
};

impl Channel {
    /// z \[m\], the hysteretic displacement
    pub const HYSTERETIC_DISPLACEMENT: Self = Self::new(&HYSTERETIC_DISPLACEMENT);
    /// α \[-\], ratio of the stiffness after yielding to the initial one
    pub const POST_YIELD_RATIO: Self = Self::new(&POST_YIELD_RATIO);
    /// β \[1/m²\], shape of the hysteresis loop
    pub const HYSTERESIS_BETA: Self = Self::new(&HYSTERESIS_BETA);
    /// γ \[1/m²\], shape of the hysteresis loop
    pub const HYSTERESIS_GAMMA: Self = Self::new(&HYSTERESIS_GAMMA);
}

static INFO: PlantInfo = PlantInfo {
    key: "bouc_wen",
    name: "Bouc-Wen oscillator",
    equation: "ẍ + 2ζωₙẋ + ωₙ²(αx + (1 - α)z) = f, ż = ẋ - β|ẋ||z|z - γẋz²",
    reference: "Wen (1976), Method for random vibration of hysteretic systems",
    channels: &[
        Channel::DISPLACEMENT,
        Channel::VELOCITY,
        Channel::HYSTERETIC_DISPLACEMENT,
        Channel::NATURAL_FREQUENCY,
        Channel::DAMPING_RATIO,
        Channel::POST_YIELD_RATIO,
        Channel::HYSTERESIS_BETA,
        Channel::HYSTERESIS_GAMMA,
    ],
    is_linear: false,
    spring: Spring::Slipping(Channel::HYSTERETIC_DISPLACEMENT),
};

impl Plant for BoucWen {
    fn info(&self) -> &PlantInfo {
        &INFO
    }

    fn motion_rate(&self, state: &[f64], force: f64, rate: &mut [f64]) {
        bouc_wen::BoucWen.rate(state, force, rate);
    }

    /// At the kinks `v = 0` and `z = 0`, the derivative is the one for positive v.
    fn motion_jacobian(&self, state: &[f64], jacobian: &mut [f64]) {
        let &[x, v, z, wn, zeta, alpha, beta, gamma, ..] = state else { return };
        let sign = if v < 0.0 { -1.0 } else { 1.0 };
        let (position, rest) = jacobian.split_at_mut(8);
        let (velocity, memory) = rest.split_at_mut(8);
        position[1] = 1.0;
        velocity[0] = -wn * wn * alpha;
        velocity[1] = -2.0 * zeta * wn;
        velocity[2] = -wn * wn * (1.0 - alpha);
        velocity[3] = -2.0 * (zeta * v + wn * (z + alpha * (x - z)));
        velocity[4] = -2.0 * wn * v;
        velocity[5] = -wn * wn * (x - z);
        memory[1] = 1.0 - (beta * sign * z.abs() + gamma * z) * z;
        memory[2] = -2.0 * (beta * v.abs() * z.abs() + gamma * v * z);
        memory[6] = -v.abs() * z.abs() * z;
        memory[7] = -v * z * z;
    }
}
