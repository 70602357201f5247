//! An oscillator with a spring that yields and remembers.

use crate::Channel;
use crate::mathematics::kernel::gaussian::{Matrix, Vector};
use crate::mathematics::kernel::model::{Model, one_by_one};
use crate::mathematics::kernel::propagation::{held_parameters_step, held_rows, held_runge_kutta, runge_kutta};

/// Bouc-Wen hysteresis with exponent 2 and state `y = [x, v, z, ωₙ, ζ, α, β, γ]`.
///
/// ```text
/// ẍ + 2ζωₙẋ + ωₙ²(α x + (1 - α) z) = f,  ż = ẋ - β |ẋ| |z| z - γ ẋ z²
/// ```
///
/// z is a displacement that follows x until the spring yields, near `|z| = 1/√(β + γ)`; the stiffness after that is α times
/// the one before. The parameters decay at the rate η.
///
/// Source: Wen (1976), Method for random vibration of hysteretic systems; Wu and Smyth (2007), Application of the unscented
/// Kalman filter for real-time nonlinear structural system identification, section 4.
#[derive(Clone, Copy, Debug)]
pub struct BoucWen {
    /// η, the rate at which the parameters decay \[1/s\].
    pub eta: f64,
}

impl Model<8> for BoucWen {
    const CHANNELS: [Channel; 8] = [
        Channel::DISPLACEMENT,
        Channel::VELOCITY,
        Channel::HYSTERETIC_DISPLACEMENT,
        Channel::NATURAL_FREQUENCY,
        Channel::DAMPING_RATIO,
        Channel::POST_YIELD_RATIO,
        Channel::HYSTERESIS_BETA,
        Channel::HYSTERESIS_GAMMA,
    ];
    const MOTION: usize = 3;

    fn eta(&self) -> f64 {
        self.eta
    }

    #[inline]
    fn rate(&self, state: &Vector<8>, force: f64) -> Vector<8> {
        let mut rate = state * -self.eta;
        [rate[0], rate[1], rate[2]] = motion_rate(state.data.0[0], force);
        rate
    }

    /// At the kinks `v = 0` and `z = 0` this is the derivative on the side of positive v.
    #[inline]
    fn jacobian(&self, state: &Vector<8>) -> Matrix<8, 8> {
        let [[x, v, z, wn, zeta, alpha, beta, gamma]] = state.data.0;
        let sign = if v < 0.0 { -1.0 } else { 1.0 };
        let mut jacobian = Matrix::<8, 8>::zeros();
        jacobian[(0, 1)] = 1.0;
        jacobian[(1, 0)] = -wn * wn * alpha;
        jacobian[(1, 1)] = -2.0 * zeta * wn;
        jacobian[(1, 2)] = -wn * wn * (1.0 - alpha);
        jacobian[(1, 3)] = -2.0 * (zeta * v + wn * (z + alpha * (x - z)));
        jacobian[(1, 4)] = -2.0 * wn * v;
        jacobian[(1, 5)] = -wn * wn * (x - z);
        jacobian[(2, 1)] = 1.0 - (beta * sign * z.abs() + gamma * z) * z;
        jacobian[(2, 2)] = -2.0 * (beta * v.abs() * z.abs() + gamma * v * z);
        jacobian[(2, 6)] = -v.abs() * z.abs() * z;
        jacobian[(2, 7)] = -v * z * z;
        for parameter in Self::MOTION..8 {
            jacobian[(parameter, parameter)] = -self.eta;
        }
        jacobian
    }

    #[inline]
    fn linearised_step(&self, state: &Vector<8>, force: f64, dt: f64) -> (Vector<8>, Matrix<8, 8>) {
        let (jacobian, rate) = (self.jacobian(state), self.rate(state, force));
        held_parameters_step::<3, 8>(state, &rate, &jacobian, self.eta, dt)
    }

    /// With η = 0 the parameters stay, and only the motion goes through the stages.
    #[inline]
    fn runge_kutta_step(&self, state: &Vector<8>, force: f64, dt: f64) -> Vector<8> {
        if self.eta != 0.0 {
            return runge_kutta(state, dt, |y| self.rate(y, force));
        }
        let mut next = *state;
        [next[0], next[1], next[2]] = held_runge_kutta(state.data.0[0], dt, |y| motion_rate(y, force));
        next
    }

    #[inline]
    fn runge_kutta_steps<const B: usize>(&self, states: &Matrix<B, 8>, force: f64, dt: f64) -> Matrix<B, 8> {
        if self.eta != 0.0 {
            return one_by_one(states, |state| self.runge_kutta_step(&state, force, dt));
        }
        held_rows(states, |state| held_runge_kutta(state, dt, |y| motion_rate(y, force)))
    }
}

#[inline]
fn motion_rate([x, v, z, wn, zeta, alpha, beta, gamma]: [f64; 8], force: f64) -> [f64; 3] {
    let acceleration = force - 2.0 * zeta * wn * v - wn * wn * (z + alpha * (x - z));
    let product = v * z;
    let yielding = v - (beta * product.abs() + gamma * product) * z;
    [v, acceleration, yielding]
}
