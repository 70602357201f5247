//! An oscillator with a cubic spring.

use crate::Channel;
use crate::mathematics::kernel::gaussian::{Matrix, Vector};
use crate::mathematics::kernel::model::{Model, one_by_one};
use crate::mathematics::kernel::propagation::{held_rows, held_runge_kutta, oscillator_step, runge_kutta};

/// `ẍ + 2ζωₙẋ + ωₙ²x + μx³ = f` with state `y = [x, v, ωₙ, ζ, μ]`.
///
/// ```text
/// g(y, f) = [v, f - 2ζωₙv - ωₙ²x - μx³, -η ωₙ, -η ζ, -η μ]
/// ```
///
/// The spring hardens with μ > 0 and softens with μ < 0.
///
/// Source: Duffing (1918), *Erzwungene Schwingungen bei veränderlicher Eigenfrequenz*; Kovacic and Brennan, eds. (2011),
/// *The Duffing Equation*.
#[derive(Clone, Copy, Debug)]
pub struct Duffing {
    /// η, the rate at which the parameters decay \[1/s\].
    pub eta: f64,
}

impl Model<5> for Duffing {
    const CHANNELS: [Channel; 5] = [
        Channel::DISPLACEMENT,
        Channel::VELOCITY,
        Channel::NATURAL_FREQUENCY,
        Channel::DAMPING_RATIO,
        Channel::CUBIC_STIFFNESS,
    ];
    const MOTION: usize = 2;

    fn eta(&self) -> f64 {
        self.eta
    }

    #[inline]
    fn rate(&self, state: &Vector<5>, force: f64) -> Vector<5> {
        let [[_, _, wn, zeta, mu]] = state.data.0;
        let [v, acceleration] = motion_rate(state.data.0[0], force);
        Vector::<5>::new(v, acceleration, -self.eta * wn, -self.eta * zeta, -self.eta * mu)
    }

    #[inline]
    fn jacobian(&self, state: &Vector<5>) -> Matrix<5, 5> {
        let [[x, v, wn, zeta, mu]] = state.data.0;
        let mut jacobian =
            Matrix::from_diagonal(&Vector::<5>::new(0.0, -2.0 * zeta * wn, -self.eta, -self.eta, -self.eta));
        jacobian[(0, 1)] = 1.0;
        jacobian[(1, 0)] = -wn * wn - 3.0 * mu * x * x;
        jacobian[(1, 2)] = -2.0 * (wn * x + zeta * v);
        jacobian[(1, 3)] = -2.0 * wn * v;
        jacobian[(1, 4)] = -x * x * x;
        jacobian
    }

    #[inline]
    fn linearised_step(&self, state: &Vector<5>, force: f64, dt: f64) -> (Vector<5>, Matrix<5, 5>) {
        let (jacobian, rate) = (self.jacobian(state), self.rate(state, force));
        oscillator_step(state, &rate, &jacobian, self.eta, dt)
    }

    /// With η = 0 the parameters stay, and only the motion goes through the stages.
    #[inline]
    fn runge_kutta_step(&self, state: &Vector<5>, force: f64, dt: f64) -> Vector<5> {
        if self.eta != 0.0 {
            return runge_kutta(state, dt, |y| self.rate(y, force));
        }
        let [[.., wn, zeta, mu]] = state.data.0;
        let [x, v] = held_runge_kutta(state.data.0[0], dt, |y| motion_rate(y, force));
        Vector::<5>::new(x, v, wn, zeta, mu)
    }

    #[inline]
    fn runge_kutta_steps<const B: usize>(&self, states: &Matrix<B, 5>, force: f64, dt: f64) -> Matrix<B, 5> {
        if self.eta != 0.0 {
            return one_by_one(states, |state| self.runge_kutta_step(&state, force, dt));
        }
        held_rows(states, |state| held_runge_kutta(state, dt, |y| motion_rate(y, force)))
    }
}

#[inline]
fn motion_rate([x, v, wn, zeta, mu]: [f64; 5], force: f64) -> [f64; 2] {
    [v, force - 2.0 * zeta * wn * v - wn * wn * x - mu * x * x * x]
}
