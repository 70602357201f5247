//! Oscillators that no filter knows.

use kalmanscope_core::plant::{Plant, PlantInfo, Spring};
use kalmanscope_core::{Channel, PlantKind};

/// The channels of each.
const CHANNELS: &[Channel] =
    &[Channel::DISPLACEMENT, Channel::VELOCITY, Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO];

/// `ẍ + 2ζωₙẋ + μ sign ẋ + ωₙ² x = f`, with `μ` \[m/s²\] a share of the strength of the force, in steps, and a sign that takes a little
/// speed to turn.
struct DryFriction {
    info: PlantInfo,
    /// μ \[m/s²\].
    size: f64,
}

/// `ẍ + 2ζωₙẋ + c ẋ |ẋ| + ωₙ² x = f`, with c \[1/m\].
struct Drag {
    info: PlantInfo,
    /// c \[1/m\].
    size: f64,
}

const fn info(key: &'static str, name: &'static str, equation: &'static str) -> PlantInfo {
    PlantInfo {
        key,
        name,
        equation,
        reference: "a bench",
        channels: CHANNELS,
        is_linear: false,
        spring: Spring::Linear,
    }
}

/// The speed at which friction turns, relative to that of a unit size \[m/s\].
const TURN: f64 = 0.02;

impl Plant for DryFriction {
    fn info(&self) -> &PlantInfo {
        &self.info
    }

    fn motion_rate(&self, state: &[f64], force: f64, rate: &mut [f64]) {
        let &[x, v, wn, zeta, ..] = state else { return };
        (rate[0], rate[1]) = (v, force - 2.0 * zeta * wn * v - self.size * libm::tanh(v / TURN) - wn * wn * x);
    }

    fn motion_jacobian(&self, _: &[f64], jacobian: &mut [f64]) {
        // The truth needs none.
        jacobian.fill(0.0);
    }
}

impl Plant for Drag {
    fn info(&self) -> &PlantInfo {
        &self.info
    }

    fn motion_rate(&self, state: &[f64], force: f64, rate: &mut [f64]) {
        let &[x, v, wn, zeta, ..] = state else { return };
        (rate[0], rate[1]) = (v, force - 2.0 * zeta * wn * v - self.size * v * v.abs() - wn * wn * x);
    }

    fn motion_jacobian(&self, _: &[f64], jacobian: &mut [f64]) {
        jacobian.fill(0.0);
    }
}

const FRICTION: &str = "ẍ + 2ζωₙẋ + μ sign ẋ + ωₙ² x = f";
const QUADRATIC: &str = "ẍ + 2ζωₙẋ + c ẋ |ẋ| + ωₙ² x = f";

static WEAK_FRICTION: DryFriction =
    DryFriction { info: info("weak_friction", "weak dry friction", FRICTION), size: 0.3 };
static STRONG_FRICTION: DryFriction =
    DryFriction { info: info("strong_friction", "strong dry friction", FRICTION), size: 0.8 };
static WEAK_DRAG: Drag = Drag { info: info("weak_drag", "weak drag", QUADRATIC), size: 0.15 };
static STRONG_DRAG: Drag = Drag { info: info("strong_drag", "strong drag", QUADRATIC), size: 0.5 };

/// Plants with dry friction, for a root mean square of the velocity near 1 m/s and a natural frequency near 6 rad/s.
pub(crate) const DRY_FRICTION: [PlantKind; 2] = [PlantKind::new(&WEAK_FRICTION), PlantKind::new(&STRONG_FRICTION)];
/// Plants with a drag, likewise.
pub(crate) const DRAG: [PlantKind; 2] = [PlantKind::new(&WEAK_DRAG), PlantKind::new(&STRONG_DRAG)];
