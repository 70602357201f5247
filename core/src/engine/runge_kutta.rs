//! Classical Runge-Kutta steps.

use super::level::Level;
use super::model::Model;
use super::number::Number;
use super::plants::{Rates, fits, with_equation};
use super::step::Step;

/// The memory of a Runge-Kutta step: where it begins, four rates, and a state without logarithms.
#[derive(Clone, Debug)]
pub struct RungeKutta<T> {
    start: Vec<T>,
    rates: [Vec<T>; 4],
    plain: Vec<T>,
}

impl<T: Number> RungeKutta<T> {
    /// Memory for a model.
    pub fn new(model: &Model) -> Self {
        let zeros = || vec![T::of(0.0); model.moving()];
        let plain = vec![T::of(0.0); model.size];
        Self { start: zeros(), rates: [zeros(), zeros(), zeros(), zeros()], plain }
    }

    /// Moves a state by one step; what does not move stays as it is.
    ///
    /// Source: Hairer, Nørsett and Wanner (1993), *Solving Ordinary Differential Equations I*, section II.1.
    #[inline(always)]
    pub fn advance<L: Level>(&mut self, level: L, model: &Model, state: &mut [T], step: &Step<T>) {
        with_equation!(model.plant, equation => {
            if fits::<T, L>(level, equation) {
                self.advance_by(equation, model, state, step);
            }
        });
    }

    #[inline(always)]
    fn advance_by(&mut self, equation: impl Rates<T>, model: &Model, state: &mut [T], step: &Step<T>) {
        let Self { start, rates, plain } = self;
        let whole = Whole { equation, model, step };
        if equation.is_small() && model.eta == 0.0 {
            // The compiler knows how many components of a small plant move, and sees through numbers of their own.
            let (moving, zeros) = (equation.moving(), [T::of(0.0); FEW]);
            let [mut start, mut k1, mut k2, mut k3, mut k4] = [zeros; 5];
            let rates = [&mut k1[..moving], &mut k2[..moving], &mut k3[..moving], &mut k4[..moving]];
            whole.advance(state, plain, &mut start[..moving], rates);
        } else {
            let moving = model.moving();
            let rates = rates.each_mut().map(
                #[inline(always)]
                |rate| &mut rate[..moving],
            );
            whole.advance(state, plain, &mut start[..moving], rates);
        }
    }
}

/// The components that move, of a plant of which the compiler knows them, are at most so many.
const FEW: usize = 3;

/// A step of an equation in its model.
struct Whole<'a, E, T> {
    equation: E,
    model: &'a Model,
    step: &'a Step<T>,
}

impl<T: Number, E: Rates<T>> Whole<'_, E, T> {
    /// Moves a state; the others are memory, four rates among them.
    #[inline(always)]
    fn advance(self, state: &mut [T], plain: &mut [T], start: &mut [T], [k1, k2, k3, k4]: [&mut [T]; 4]) {
        let Self { equation, model, step } = self;
        let (moving, dt, [begin, end]) = (start.len(), step.dt, step.forces);
        let middle = begin + (end - begin) * 0.5;
        start.copy_from_slice(&state[..moving]);
        model.rate_by(equation, state, begin, plain, k1);
        put(state, start, k1, 0.5 * dt);
        model.rate_by(equation, state, middle, plain, k2);
        put(state, start, k2, 0.5 * dt);
        model.rate_by(equation, state, middle, plain, k3);
        put(state, start, k3, dt);
        model.rate_by(equation, state, end, plain, k4);
        for i in 0..moving {
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
