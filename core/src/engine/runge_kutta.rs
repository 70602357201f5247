//! Classical Runge-Kutta steps.

use super::model::Model;
use super::number::Number;
use super::plants::{Equation, with_equation};
use super::step::Step;

/// The memory of a Runge-Kutta step: where it begins, and four rates.
#[derive(Clone, Debug)]
pub struct RungeKutta<T> {
    start: Vec<T>,
    rates: [Vec<T>; 4],
}

impl<T: Number> RungeKutta<T> {
    /// Memory for a model.
    pub fn new(model: &Model) -> Self {
        let zeros = || vec![T::of(0.0); model.motion()];
        Self { start: zeros(), rates: [zeros(), zeros(), zeros(), zeros()] }
    }

    /// Moves a state by one step; what does not move stays as it is.
    ///
    /// Source: Hairer, Nørsett and Wanner (1993), *Solving Ordinary Differential Equations I*, section II.1.
    #[inline(always)]
    pub fn advance(&mut self, model: &Model, state: &mut [T], step: &Step<T>) {
        with_equation!(model.plant, equation => self.advance_by(equation, model, state, step));
    }

    #[inline(always)]
    fn advance_by<E: Equation>(&mut self, equation: E, model: &Model, state: &mut [T], step: &Step<T>) {
        let (motion, dt) = (equation.motion(), step.dt);
        let Self { start, rates: [k1, k2, k3, k4] } = self;
        let start = &mut start[..motion];
        let [k1, k2, k3, k4] = [&mut k1[..motion], &mut k2[..motion], &mut k3[..motion], &mut k4[..motion]];
        let [begin, end] = step.forces;
        let middle = begin + (end - begin) * 0.5;
        start.copy_from_slice(&state[..motion]);
        equation.rate(state, model.acting(state, begin), k1);
        put(state, start, k1, 0.5 * dt);
        equation.rate(state, model.acting(state, middle), k2);
        put(state, start, k2, 0.5 * dt);
        equation.rate(state, model.acting(state, middle), k3);
        put(state, start, k3, dt);
        equation.rate(state, model.acting(state, end), k4);
        for i in 0..motion {
            state[i] = start[i] + (k1[i] + (k2[i] + k3[i]) * 2.0 + k4[i]) * (dt / 6.0);
        }
    }
}

/// Puts a state where a rate leads from the start.
#[inline(always)]
fn put<T: Number>(state: &mut [T], start: &[T], rate: &[T], dt: f64) {
    for i in 0..start.len() {
        state[i] = start[i] + rate[i] * dt;
    }
}
