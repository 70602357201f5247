//! The linear oscillator with a single degree of freedom.

use crate::Channel;
use crate::mathematics::kernel::gaussian::{Matrix, Vector};
use crate::mathematics::kernel::model::{Model, one_by_one};
use crate::mathematics::kernel::propagation::{ImpulseResponse, oscillator_step, runge_kutta};

/// `ẍ + 2ζωₙẋ + ωₙ²x = f` with state `y = [x, v, ωₙ, ζ]`.
///
/// ```text
/// g(y, f) = [v, f - 2ζωₙv - ωₙ²x, -η ωₙ, -η ζ]
/// ```
///
/// Source: Huang and Yuen (2023), *Bayesian Real-Time System Identification*.
#[derive(Clone, Copy, Debug)]
pub struct Sdof {
    /// η, the rate at which the parameters decay \[1/s\].
    pub eta: f64,
}

impl Model<4> for Sdof {
    const CHANNELS: [Channel; 4] =
        [Channel::DISPLACEMENT, Channel::VELOCITY, Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO];
    const MOTION: usize = 2;

    fn eta(&self) -> f64 {
        self.eta
    }

    #[inline]
    fn rate(&self, state: &Vector<4>, force: f64) -> Vector<4> {
        let [[x, v, wn, zeta]] = state.data.0;
        Vector::<4>::new(v, force - 2.0 * zeta * wn * v - wn * wn * x, -self.eta * wn, -self.eta * zeta)
    }

    #[inline]
    fn jacobian(&self, state: &Vector<4>) -> Matrix<4, 4> {
        let [[x, v, wn, zeta]] = state.data.0;
        #[rustfmt::skip]
        let jacobian = Matrix::<4, 4>::new(
            0.0,      1.0,              0.0,                          0.0,
            -wn * wn, -2.0 * zeta * wn, -2.0 * (wn * x + zeta * v),   -2.0 * wn * v,
            0.0,      0.0,              -self.eta,                    0.0,
            0.0,      0.0,              0.0,                          -self.eta,
        );
        jacobian
    }

    /// With η = 0 all of `exp(A dt)` and `dt φ₁(A dt) g` follows from the oscillator's impulse response.
    #[inline]
    fn linearised_step(&self, state: &Vector<4>, force: f64, dt: f64) -> (Vector<4>, Matrix<4, 4>) {
        if self.eta != 0.0 {
            return oscillator_step(state, &self.rate(state, force), &self.jacobian(state), self.eta, dt);
        }
        let [[x, v, wn, zeta]] = state.data.0;
        let (stiffness, damping) = (-wn * wn, -2.0 * zeta * wn);
        let acceleration = force + damping * v + stiffness * x;
        let by_frequency = -2.0 * (wn * x + zeta * v);
        let by_damping = -2.0 * wn * v;

        let response = ImpulseResponse::new(stiffness, damping, dt);
        let [moved, sped] = response.advance(stiffness, damping, [x, v], acceleration);
        let mean = Vector::<4>::new(moved, sped, wn, zeta);
        let ImpulseResponse { value: h, integral: q } = response;
        #[rustfmt::skip]
        let transition = Matrix::<4, 4>::new(
            1.0 + stiffness * q, h,                                  q * by_frequency, q * by_damping,
            stiffness * h,       1.0 + stiffness * q + damping * h,  h * by_frequency, h * by_damping,
            0.0,                 0.0,                                1.0,              0.0,
            0.0,                 0.0,                                0.0,              1.0,
        );
        (mean, transition)
    }

    fn exact_integral(&self, state: &Vector<4>, dt: f64) -> Option<Matrix<4, 4>> {
        let [[_, _, wn, zeta]] = state.data.0;
        let (stiffness, damping) = (-wn * wn, -2.0 * zeta * wn);
        let ImpulseResponse { value: h, integral: q } = ImpulseResponse::new(stiffness, damping, dt);
        let mut integral = Matrix::<4, 4>::identity() * dt;
        integral[(0, 0)] = h - damping * q;
        integral[(0, 1)] = q;
        integral[(1, 0)] = stiffness * q;
        integral[(1, 1)] = h;
        Some(integral)
    }

    /// With η = 0 the motion is linear within a step, and Runge-Kutta is its Taylor polynomial.
    #[inline]
    fn runge_kutta_step(&self, state: &Vector<4>, force: f64, dt: f64) -> Vector<4> {
        if self.eta != 0.0 {
            return runge_kutta(state, dt, |y| self.rate(y, force));
        }
        let [[x, v, wn, zeta]] = state.data.0;
        let [x, v] = runge_kutta_motion([x, v, wn, zeta], force, dt);
        Vector::<4>::new(x, v, wn, zeta)
    }

    #[inline]
    fn runge_kutta_steps<const B: usize>(&self, states: &Matrix<B, 4>, force: f64, dt: f64) -> Matrix<B, 4> {
        if self.eta != 0.0 {
            return one_by_one(states, |state| self.runge_kutta_step(&state, force, dt));
        }
        let [x, v, wn, zeta] = states.data.0;
        let (mut moved, mut sped) = (x, v);
        for row in 0..B {
            [moved[row], sped[row]] = runge_kutta_motion([x[row], v[row], wn[row], zeta[row]], force, dt);
        }
        Matrix::from([moved, sped, wn, zeta])
    }
}

/// Displacement and velocity after a Runge-Kutta step with constant parameters.
#[inline]
fn runge_kutta_motion([x, v, wn, zeta]: [f64; 4], force: f64, dt: f64) -> [f64; 2] {
    let (stiffness, damping) = (-wn * wn, -2.0 * zeta * wn);
    let acceleration = force + damping * v + stiffness * x;
    let response = ImpulseResponse::runge_kutta(stiffness, damping, dt);
    response.advance(stiffness, damping, [x, v], acceleration)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mathematics::kernel::propagation::exp_and_integral;

    const STATES: [[f64; 4]; 7] = [
        [0.1, -0.4, 6.0, 0.05],
        [-0.2, 0.3, 6.0, 1.0],
        [0.3, 0.2, 4.0, 3.0],
        [0.1, 0.5, 3.0, -0.2],
        [0.1, 0.5, 0.0, 0.1],
        [0.1, 0.5, -6.0, -0.05],
        [0.05, 0.5, 250.0, 0.02],
    ];

    #[test]
    fn the_closed_form_is_the_matrix_exponential() {
        let model = Sdof { eta: 0.0 };
        for dt in [1e-6, 0.001, 0.01, 0.1, 1.0] {
            for state in STATES.map(Vector::<4>::from) {
                let (mean, transition) = model.linearised_step(&state, 3.0, dt);
                let (exp, integral) = exp_and_integral(&model.jacobian(&state), dt);
                let general = state + integral * model.rate(&state, 3.0);
                let error = (transition - exp).amax() / exp.amax();
                assert!(error < 1e-11, "transition of {state} over {dt}: {error}");
                let error = (mean - general).amax() / general.amax();
                assert!(error < 1e-11, "mean of {state} over {dt}: {error}");
            }
        }
    }

    #[test]
    fn the_polynomial_is_the_runge_kutta_step() {
        let model = Sdof { eta: 0.0 };
        for dt in [1e-6, 0.001, 0.01, 0.1] {
            let states = Matrix::<7, 4>::from_fn(|row, i| STATES[row][i]);
            let images = model.runge_kutta_steps(&states, 3.0, dt);
            assert_eq!(images, one_by_one(&states, |state| model.runge_kutta_step(&state, 3.0, dt)));
            for state in STATES.map(Vector::<4>::from) {
                let stages = runge_kutta(&state, dt, |y| model.rate(y, 3.0));
                let error = (model.runge_kutta_step(&state, 3.0, dt) - stages).amax() / stages.amax();
                assert!(error < 1e-13, "{state} over {dt}: {error}");
            }
        }
    }
}
