//! Many states of one model, several at a time: the members of an ensemble, and particles.

use super::level::{Baseline, Level};
use super::model::{Model, Step, read};
use super::number::{Number, Real};
use super::runge_kutta::RungeKutta;
use crate::mathematics::model::Reading;

type Pack = <f64 as Number>::Pack;

/// Moves and measures states, n numbers each, one behind the other.
#[derive(Clone, Debug)]
pub(crate) struct States {
    model: Model,
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
        let model = Model::of(book);
        let zeros = |count: usize| vec![Pack::of(0.0); count];
        Self {
            method: RungeKutta::new(&model),
            states: zeros(model.size),
            plain: zeros(model.size),
            rate: zeros(model.moving()),
            model,
        }
    }

    /// Moves each state by one Runge-Kutta step. Components that do not move keep every bit.
    pub(crate) fn advance(&mut self, states: &mut [f64], step: &Step<f64>) {
        let (n, moving, points) = (self.model.size, self.model.moving(), f64::POINTS);
        let [begin, end] = step.forces;
        let forces = [f64::pack(|_| begin), f64::pack(|_| end)];
        let step = Step { forces, has_slope: step.has_slope, dt: step.dt };
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

    /// Under this recorded force over mass \[m/s²\]; `values` gets as many numbers for each state as there are sensors.
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

    /// Takes some states, at least one; the last one stands for those that are missing in the pack.
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
    use crate::mathematics::engine::runge_kutta::classical;
    use crate::{Channel, PlantKind, Quantity};

    #[test]
    fn each_state_moves_and_is_measured_as_if_it_were_alone() {
        for plant in [PlantKind::SDOF, PlantKind::DUFFING, PlantKind::BOUC_WEN, PlantKind::SHEAR_3] {
            for eta in [0.0, 0.02] {
                for count in 1..=9 {
                    let model = crate::Model::new(plant).augmented([Channel::INPUT_GAIN]).decaying(eta);
                    let n = model.size();
                    let begin: Vec<f64> = (0..n * count).map(|i| 0.2 + 0.7 * libm::sin(i as f64).abs()).collect();
                    let step = Step { forces: [0.7, -0.4], has_slope: true, dt: 0.01 };
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
