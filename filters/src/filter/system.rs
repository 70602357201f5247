//! A model of any plant, as a belief sees it: states that move, and sensors that read them.

use super::Propagation;
use crate::engine::dynamics::Dynamics;
use crate::engine::level::{Baseline, Level};
use crate::engine::linearised::Linearised;
use crate::engine::model::{Input, Reading, StateModel, Step, read};
use crate::engine::number::{Number, Real};
use crate::engine::runge_kutta::RungeKutta;
use crate::linalg::{Matrix, Vector};

/// A model of n components with some plant.
pub trait System: Send {
    /// n, the number of components.
    fn size(&self) -> usize;

    /// The places of the components that do not last, and their correlation times \[s\].
    fn forgotten(&self) -> &[(usize, f64)];

    /// Moves states of n numbers, one behind the other, by one Runge-Kutta step.
    fn advance(&mut self, states: &mut [f64], step: Step<'_>);

    /// Writes `h(y, f)`, m numbers for each of the states, under this input.
    fn read(&mut self, states: &[f64], input: Input<'_>, readings: &[&Reading], values: &mut [f64]);

    /// `H = ∂h/∂y` in a state, m × n.
    fn jacobian(&self, state: &[f64], input: Input<'_>, readings: &[&Reading]) -> Matrix;

    /// The step of a linearised mean: see [`Propagation::step`].
    fn step(&self, propagation: Propagation, state: &Vector, step: Step<'_>) -> (Vector, Matrix);
}

type Pack = <f64 as Number>::Pack;

/// A model, and memory in which several of its states move at once.
#[derive(Clone, Debug)]
pub struct States<P> {
    model: StateModel<P>,
    method: RungeKutta<Pack>,
    states: Vec<Pack>,
    plain: Vec<Pack>,
    rate: Vec<Pack>,
}

impl<P: Dynamics> States<P> {
    /// The system of a model.
    pub fn new(model: StateModel<P>) -> Self {
        let zeros = |count: usize| vec![Pack::of(0.0); count];
        Self {
            method: RungeKutta::new(&model),
            states: zeros(model.size),
            plain: zeros(model.size),
            rate: zeros(model.moving()),
            model,
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

impl<P: Dynamics> System for States<P> {
    fn size(&self) -> usize {
        self.model.size
    }

    fn forgotten(&self) -> &[(usize, f64)] {
        &self.model.forgotten
    }

    fn advance(&mut self, states: &mut [f64], step: Step<'_>) {
        let (n, moving, points) = (self.model.size, self.model.moving(), f64::POINTS);
        let step = step.with(|force| f64::pack(|_| force));
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

    fn read(&mut self, states: &[f64], input: Input<'_>, readings: &[&Reading], values: &mut [f64]) {
        let (n, m, points) = (self.model.size, readings.len(), f64::POINTS);
        let input = input.with(f64::pack(|_| input.force));
        let has_rates = readings.iter().any(|reading| reading.is_of_rates());
        for (own, values) in states.chunks(n * points).zip(values.chunks_mut(m * points)) {
            self.take(own);
            let Self { model, states, plain, rate, .. } = self;
            if has_rates {
                Baseline.apart(|| model.rate(Baseline, states, input, plain, rate));
            }
            for (row, reading) in readings.iter().enumerate() {
                let reading = read(model, reading, states, rate, input.force);
                for (k, values) in values.chunks_exact_mut(m).enumerate() {
                    values[row] = f64::of_pack(reading, k);
                }
            }
        }
    }

    fn jacobian(&self, state: &[f64], input: Input<'_>, readings: &[&Reading]) -> Matrix {
        self.model.gradients(readings, state, input)
    }

    fn step(&self, propagation: Propagation, state: &Vector, step: Step<'_>) -> (Vector, Matrix) {
        propagation.step(&self.model, state, step)
    }
}

impl Propagation {
    /// The state after a step and its transition matrix Φ, n × n. The rows of Φ below those that move are an identity's.
    pub fn step(self, model: &StateModel<impl Dynamics>, state: &Vector, step: Step<'_>) -> (Vector, Matrix) {
        let mut linearised = Linearised::new(model);
        let (mut mean, mut transition) = (state.clone(), Matrix::identity(state.len(), state.len()));
        linearised.step(Baseline, self, model, mean.as_mut_slice(), &step);
        transition.rows_mut(0, model.moving()).copy_from_slice(&linearised.rows);
        (mean, transition)
    }
}
