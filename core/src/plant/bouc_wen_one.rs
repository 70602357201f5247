//! An oscillator with a hysteretic spring of exponent 1.

use super::{Plant, PlantInfo, Spring};
use crate::Channel;
use crate::channel::{ChannelInfo, Role, Sign, Usual};
use crate::engine::plants::{Equation, bouc_wen};

/// Bouc-Wen hysteresis with exponent 1 and state `y = [x, v, z, ωₙ, ζ, α, β₁, γ₁]`; [`super::bouc_wen::BoucWen`] has the
/// exponent 2.
///
/// ```text
/// ẍ + 2ζωₙẋ + ωₙ²(α x + (1 - α) z) = f,  ż = ẋ - β₁ |ẋ| z - γ₁ ẋ |z|
/// ```
///
/// z is a displacement that follows x and yields little by little, near `|z| = 1/(β₁ + γ₁)`.
///
/// Source: Wen (1976), Method for random vibration of hysteretic systems; Noël and Schoukens (2016), Hysteretic benchmark with
/// a dynamic nonlinearity.
#[derive(Clone, Copy, Debug)]
pub struct BoucWenOne;

static YIELD_BETA: ChannelInfo = ChannelInfo {
    keys: &["yield_beta"],
    names: &["yielding β"],
    symbols: &["β₁"],
    unit: "1/m",
    role: Role::Parameter(Sign::Any),
    rate: None,
    mirrored: false,
    usual: Usual { mean: 5.0, std: 1.5, process: 0.001, truth: &[6.0], slider: (-10.0, 20.0), decimals: 2 },
};

static YIELD_GAMMA: ChannelInfo = ChannelInfo {
    keys: &["yield_gamma"],
    names: &["yielding γ"],
    symbols: &["γ₁"],
    unit: "1/m",
    role: Role::Parameter(Sign::Any),
    rate: None,
    mirrored: false,
    usual: Usual { mean: 3.0, std: 1.5, process: 0.001, truth: &[4.0], slider: (-10.0, 20.0), decimals: 2 },
};

impl Channel {
    /// β₁ \[1/m\], shape of the hysteresis loop
    pub const YIELD_BETA: Self = Self::new(&YIELD_BETA);
    /// γ₁ \[1/m\], shape of the hysteresis loop
    pub const YIELD_GAMMA: Self = Self::new(&YIELD_GAMMA);
}

static INFO: PlantInfo = PlantInfo {
    key: "bouc_wen_1",
    name: "Bouc-Wen oscillator, exponent 1",
    equation: "ẍ + 2ζωₙẋ + ωₙ²(αx + (1 - α)z) = f, ż = ẋ - β₁|ẋ|z - γ₁ẋ|z|",
    reference: "Wen (1976), Method for random vibration of hysteretic systems",
    channels: &[
        Channel::DISPLACEMENT,
        Channel::VELOCITY,
        Channel::HYSTERETIC_DISPLACEMENT,
        Channel::NATURAL_FREQUENCY,
        Channel::DAMPING_RATIO,
        Channel::POST_YIELD_RATIO,
        Channel::YIELD_BETA,
        Channel::YIELD_GAMMA,
    ],
    is_linear: false,
    spring: Spring::Slipping(Channel::HYSTERETIC_DISPLACEMENT),
};

impl Plant for BoucWenOne {
    fn info(&self) -> &PlantInfo {
        &INFO
    }

    fn motion_rate(&self, state: &[f64], force: f64, rate: &mut [f64]) {
        bouc_wen::BoucWenOne.rate(state, force, rate);
    }

    /// At the kinks `v = 0` and `z = 0`, the derivative is the one for positive v and z.
    fn motion_jacobian(&self, state: &[f64], jacobian: &mut [f64]) {
        let &[x, v, z, wn, zeta, alpha, beta, gamma, ..] = state else { return };
        let [sign, side] = [v, z].map(|x| if x < 0.0 { -1.0 } else { 1.0 });
        let (position, rest) = jacobian.split_at_mut(8);
        let (velocity, memory) = rest.split_at_mut(8);
        position[1] = 1.0;
        velocity[0] = -wn * wn * alpha;
        velocity[1] = -2.0 * zeta * wn;
        velocity[2] = -wn * wn * (1.0 - alpha);
        velocity[3] = -2.0 * (zeta * v + wn * (z + alpha * (x - z)));
        velocity[4] = -2.0 * wn * v;
        velocity[5] = -wn * wn * (x - z);
        memory[1] = 1.0 - beta * sign * z - gamma * z.abs();
        memory[2] = -beta * v.abs() - gamma * v * side;
        memory[6] = -v.abs() * z;
        memory[7] = -v * z.abs();
    }
}
