//! Classical Runge-Kutta steps, of one state and of many.

use super::dynamics::{Dynamics, EquationWork, FEW, RateFunction, fits};
use super::level::Level;
use super::model::{Input, StateModel, Step};
use super::number::Number;

#[derive(Clone, Debug)]
pub(crate) struct RungeKutta<T> {
    start: Vec<T>,
    rates: [Vec<T>; 4],
    plain: Vec<T>,
}

impl<T: Number> RungeKutta<T> {
    pub(crate) fn new(model: &StateModel<impl Dynamics>) -> Self {
        let zeros = || vec![T::of(0.0); model.moving()];
        let plain = vec![T::of(0.0); model.size];
        Self { start: zeros(), rates: [zeros(), zeros(), zeros(), zeros()], plain }
    }

    #[inline(always)]
    pub(crate) fn advance<L: Level>(
        &mut self,
        level: L,
        model: &StateModel<impl Dynamics>,
        state: &mut [T],
        step: &Step<'_, T>,
    ) {
        model.plant.with_equation(RungeKuttaStep { level, method: self, model, state, step });
    }

    #[inline(always)]
    pub(super) fn rate<L: Level>(
        &mut self,
        level: L,
        model: &StateModel<impl Dynamics>,
        state: &[T],
        input: Input<'_, T>,
    ) -> &[T] {
        let Self { rates: [rate, ..], plain, .. } = self;
        model.rate(level, state, input, plain, rate);
        rate
    }

    #[inline(always)]
    fn advance_by<E: RateFunction<T>>(
        &mut self,
        equation: E,
        model: &StateModel<impl Dynamics>,
        state: &mut [T],
        step: &Step<'_, T>,
    ) {
        let Self { start, rates: [k1, k2, k3, k4], plain } = self;
        // The compiler does not know the place of a single mass. Where a force is added there, it keeps a small plant's numbers in memory
        // and not in registers, so that only models with such forces take this way.
        if model.eta != 0.0 || !step.inputs[0].on.is_empty() {
            classical(
                #[inline(always)]
                |state, input, rate| model.rate_by(equation, state, input, plain, rate),
                state,
                step.thrice(),
                step.dt,
                [start, k1, k2, k3, k4],
            );
            return;
        }
        let [own, moving] = equation.sizes();
        let [begin, middle, end] = step.thrice().map(|input| input.force);
        let forces = [model.acting(state, begin), model.acting(state, middle), model.acting(state, end)];
        // The compiler sees through numbers of a small plant's own, and does not always inline an array's own `map`.
        let mut small = [[T::of(0.0); FEW]; 6];
        let (here, memory): (&mut [T], [&mut [T]; 5]) = if E::IS_SMALL {
            let [here, start, k1, k2, k3, k4] = &mut small;
            here[..own].copy_from_slice(&model.plain(state, plain)[..own]);
            (here, [start, k1, k2, k3, k4])
        } else {
            model.plain_into(state, plain);
            (plain, [start, k1, k2, k3, k4])
        };
        let [start, k1, k2, k3, k4] = memory;
        let here = &mut here[..own];
        let memory = [&mut start[..moving], &mut k1[..moving], &mut k2[..moving], &mut k3[..moving], &mut k4[..moving]];
        classical(
            #[inline(always)]
            |state, force, rate| equation.rate(state, force, rate),
            here,
            forces,
            step.dt,
            memory,
        );
        state[..moving].copy_from_slice(&here[..moving]);
    }
}

struct RungeKuttaStep<'a, T, L, P> {
    level: L,
    method: &'a mut RungeKutta<T>,
    model: &'a StateModel<P>,
    state: &'a mut [T],
    step: &'a Step<'a, T>,
}

impl<T: Number, L: Level, P: Dynamics> EquationWork<T> for RungeKuttaStep<'_, T, L, P> {
    #[inline(always)]
    fn with(self, equation: impl RateFunction<T>) {
        if fits(self.level, equation) {
            self.method.advance_by(equation, self.model, self.state, self.step);
        }
    }
}

/// One classical step of as many numbers as `start` has, with the inputs at its beginning, middle and end, and memory for the beginning
/// and four rates. Source: Hairer, Nørsett and Wanner (1993), *Solving Ordinary Differential Equations I*, section II.1.
#[inline(always)]
pub fn classical<T: Number, F: Copy>(
    mut rate: impl FnMut(&[T], F, &mut [T]),
    state: &mut [T],
    [begin, middle, end]: [F; 3],
    dt: f64,
    [start, k1, k2, k3, k4]: [&mut [T]; 5],
) {
    let moving = start.len();
    start.copy_from_slice(&state[..moving]);
    rate(state, begin, k1);
    put(state, start, k1, 0.5 * dt);
    rate(state, middle, k2);
    put(state, start, k2, 0.5 * dt);
    rate(state, middle, k3);
    put(state, start, k3, dt);
    rate(state, end, k4);
    for i in 0..moving {
        state[i] = start[i] + (k1[i] + (k2[i] + k3[i]) * 2.0 + k4[i]) * (dt / 6.0);
    }
}

#[inline(always)]
fn put<T: Number>(state: &mut [T], start: &[T], rate: &[T], dt: f64) {
    for i in 0..start.len() {
        state[i] = start[i] + rate[i] * dt;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(rate: impl Fn(f64, &[f64], &mut [f64]), state: &mut [f64], dt: f64) {
        let mut memory = [const { [0.0; 2] }; 5];
        let memory = memory.each_mut().map(|numbers| &mut numbers[..state.len()]);
        classical(|y, share, out| rate(share, y, out), state, [0.0, 0.5, 1.0], dt, memory);
    }

    #[test]
    fn runge_kutta_is_of_fourth_order() {
        let error = |steps: u32| {
            let (dt, mut y) = (1.0 / f64::from(steps), [1.0, 0.0]);
            for _ in 0..steps {
                step(|_, y, rate| rate.copy_from_slice(&[y[1], -4.0 * y[0]]), &mut y, dt);
            }
            (y[0] - libm::cos(2.0)).abs()
        };
        let order = libm::log2(error(20) / error(40));
        assert!((order - 4.0).abs() < 0.2, "order {order}");
    }

    #[test]
    fn a_rate_that_is_linear_in_time_is_integrated_exactly() {
        let mut y = [0.0];
        step(|share, _, rate| rate[0] = 2.0 + 3.0 * share, &mut y, 0.5);
        assert_eq!(y[0], 0.5 * 3.5);
    }
}
