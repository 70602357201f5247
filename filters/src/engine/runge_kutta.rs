//! Classical Runge-Kutta steps, of one state and of many.

use super::level::{Baseline, Level};
use super::model::{Interval, StateModel, read};
use super::number::{Number, Real};
use super::plants::{FEW, RateFunction, fits, with_equation};
use crate::model::Reading;

#[derive(Clone, Debug)]
pub(crate) struct RungeKutta<T> {
    start: Vec<T>,
    rates: [Vec<T>; 4],
    plain: Vec<T>,
}

impl<T: Number> RungeKutta<T> {
    pub(crate) fn new(model: &StateModel) -> Self {
        let zeros = || vec![T::of(0.0); model.moving()];
        let plain = vec![T::of(0.0); model.size];
        Self { start: zeros(), rates: [zeros(), zeros(), zeros(), zeros()], plain }
    }

    #[inline(always)]
    pub(crate) fn advance<L: Level>(&mut self, level: L, model: &StateModel, state: &mut [T], step: &Interval<T>) {
        with_equation!(&model.plant, equation => {
            if fits::<T, L>(level, equation) {
                self.advance_by(equation, model, state, step);
            }
        });
    }

    #[inline(always)]
    pub(super) fn rate<L: Level>(&mut self, level: L, model: &StateModel, state: &[T], force: T) -> &[T] {
        let Self { rates: [rate, ..], plain, .. } = self;
        model.rate(level, state, force, plain, rate);
        rate
    }

    #[inline(always)]
    fn advance_by<E: RateFunction<T>>(&mut self, equation: E, model: &StateModel, state: &mut [T], step: &Interval<T>) {
        let Self { start, rates: [k1, k2, k3, k4], plain } = self;
        if model.eta != 0.0 {
            classical(
                #[inline(always)]
                |state, force, rate| model.rate_by(equation, state, force, plain, rate),
                state,
                step.thrice(),
                step.dt,
                [start, k1, k2, k3, k4],
            );
            return;
        }
        let [own, moving] = equation.sizes();
        let [begin, middle, end] = step.thrice();
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

/// One classical step of fourth order, of as many numbers as `start` has, with the forces at its beginning, middle and end. The
/// memory is for where the step begins, and for four rates. Source: Hairer, Nørsett and Wanner (1993), *Solving Ordinary Differential
/// Equations I*, section II.1.
#[inline(always)]
pub fn classical<T: Number>(
    mut rate: impl FnMut(&[T], T, &mut [T]),
    state: &mut [T],
    [begin, middle, end]: [T; 3],
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

type Pack = <f64 as Number>::Pack;

/// Moves and measures states of n numbers, one behind the other, several at a time: the members of an ensemble, and particles.
#[derive(Clone, Debug)]
pub(crate) struct States {
    model: StateModel,
    method: RungeKutta<Pack>,
    states: Vec<Pack>,
    plain: Vec<Pack>,
    rate: Vec<Pack>,
}

impl States {
    pub(crate) fn of<'a>(memory: &'a mut Option<Box<Self>>, book: &crate::Model) -> &'a mut Self {
        memory.get_or_insert_with(|| Box::new(Self::new(book)))
    }

    fn new(book: &crate::Model) -> Self {
        let model = StateModel::of(book);
        let zeros = |count: usize| vec![Pack::of(0.0); count];
        Self {
            method: RungeKutta::new(&model),
            states: zeros(model.size),
            plain: zeros(model.size),
            rate: zeros(model.moving()),
            model,
        }
    }

    pub(crate) fn advance(&mut self, states: &mut [f64], step: &Interval<f64>) {
        let (n, moving, points) = (self.model.size, self.model.moving(), f64::POINTS);
        let [begin, end] = step.forces;
        let forces = [f64::pack(|_| begin), f64::pack(|_| end)];
        let step = Interval { forces, has_slope: step.has_slope, dt: step.dt };
        for own in states.chunks_mut(n * points) {
            self.take(own);
            let Self { model, method, states, .. } = self;
            Baseline.apart(|| method.advance(Baseline, model, states, &step));
            for (k, state) in own.chunks_exact_mut(n).enumerate() {
                for (number, pack) in state[..moving].iter_mut().zip(&self.states) {
                    *number = f64::of_pack(*pack, k);
                }
            }
        }
    }

    /// Under this recorded force over mass \[m/s²\]; `values` has one number for each sensor of each state.
    pub(crate) fn read<'a>(
        &mut self,
        states: &[f64],
        force: f64,
        readings: &(impl Iterator<Item = &'a Reading> + Clone),
        values: &mut [f64],
    ) {
        let (n, m, points) = (self.model.size, readings.clone().count(), f64::POINTS);
        let force = f64::pack(|_| force);
        let has_rates = readings.clone().any(Reading::is_of_rates);
        for (own, values) in states.chunks(n * points).zip(values.chunks_mut(m * points)) {
            self.take(own);
            let Self { model, states, plain, rate, .. } = self;
            if has_rates {
                Baseline.apart(|| model.rate(Baseline, states, force, plain, rate));
            }
            for (row, reading) in readings.clone().enumerate() {
                let reading = read(model, reading, states, rate, force);
                for (k, values) in values.chunks_exact_mut(m).enumerate() {
                    values[row] = f64::of_pack(reading, k);
                }
            }
        }
    }

    fn take(&mut self, states: &[f64]) {
        let n = self.model.size;
        let last = states.len() / n - 1;
        for (i, pack) in self.states.iter_mut().enumerate() {
            *pack = f64::pack(|k| states[k.min(last) * n + i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Channel, PlantKind, Quantity};

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

    #[test]
    fn each_state_moves_and_is_measured_as_if_it_were_alone() {
        for plant in [PlantKind::SDOF, PlantKind::DUFFING, PlantKind::BOUC_WEN, PlantKind::SHEAR_3] {
            for eta in [0.0, 0.02] {
                for count in 1..=9 {
                    let model = crate::Model::new(plant.clone()).augmented([Channel::INPUT_GAIN]).decaying(eta);
                    let n = model.size();
                    let begin: Vec<f64> = (0..n * count).map(|i| 0.2 + 0.7 * libm::sin(i as f64).abs()).collect();
                    let step = Interval { forces: [0.7, -0.4], has_slope: true, dt: 0.01 };
                    let (mut states, mut engine) = (begin.clone(), States::new(&model));
                    engine.advance(&mut states, &step);
                    let quantities = [Quantity::DISPLACEMENT, Quantity::ACCELERATION];
                    let readings: Vec<_> = quantities.iter().map(|&q| model.reading(q).unwrap()).collect();
                    let mut values = vec![0.0; 2 * count];
                    engine.read(&states, -0.4, &readings.iter(), &mut values);
                    for place in 0..count {
                        let mut moved = begin[place * n..(place + 1) * n].to_vec();
                        let rate = |y: &[f64], force: f64, rate: &mut [f64]| {
                            rate.copy_from_slice(model.rate(y, force).as_slice());
                        };
                        let mut memory: [Vec<f64>; 5] = std::array::from_fn(|_| vec![0.0; n]);
                        let memory = memory.each_mut().map(Vec::as_mut_slice);
                        classical(rate, &mut moved, [0.7, 0.15, -0.4], 0.01, memory);
                        for i in 0..n {
                            let (own, other) = (states[place * n + i], moved[i]);
                            assert!(
                                (own - other).abs() <= 1e-13 * other.abs().max(1.0),
                                "{plant:?} {i}: {own} {other}"
                            );
                        }
                        let state = &states[place * n..(place + 1) * n];
                        let rate = model.rate(state, -0.4);
                        for (value, reading) in values[2 * place..].iter().zip(&readings) {
                            let alone = model.read_moving(reading, state, rate.as_slice(), -0.4);
                            assert!((value - alone).abs() <= 1e-12 * alone.abs().max(1.0), "{plant:?}");
                        }
                    }
                }
            }
        }
    }
}
