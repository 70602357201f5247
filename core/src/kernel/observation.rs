//! The measurements of one sample.

use crate::kernel::gaussian::{Matrix, Vector};
use crate::kernel::model::{Model, Output};

/// A sensor that has delivered a measurement: where it reads, its place among the sensors, its variance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Active {
    pub(super) sensor: usize,
    pub(super) output: Output,
    pub(super) variance: f64,
}

/// The M measurements of one sample that are not missing.
#[derive(Clone, Copy, Debug)]
pub struct Observation<const M: usize> {
    pub(super) active: [Active; M],
    pub(super) values: Vector<M>,
    pub(super) force: f64,
    /// The number of measurements; the rest, if a belief wants [`super::Belief::PADDED`] ones, reads zero with a variance of one.
    pub(super) count: usize,
}

impl<const M: usize> Observation<M> {
    /// The readings of the sensors in a state.
    #[inline]
    pub(super) fn read<P: Model<N>, const N: usize>(&self, model: &P, state: &Vector<N>) -> Vector<M> {
        if let Some(components) = self.components() {
            return Vector::from_fn(|row, _| state[components[row]]);
        }
        let rate = model.rate(state, self.force);
        Vector::from_fn(|row, _| match self.active[row].output {
            _ if row >= self.count => 0.0,
            Output::State(i) => state[i],
            Output::Rate(i) => rate[i],
        })
    }

    /// Those that are measurements.
    pub(super) fn measured(&self) -> &[Active] {
        &self.active[..self.count]
    }

    /// Which component of the state each sensor reads, if they all read one.
    #[inline]
    pub(super) fn components(&self) -> Option<[usize; M]> {
        if self.count < M {
            return None;
        }
        let mut components = [0; M];
        for (component, sensor) in components.iter_mut().zip(&self.active) {
            let Output::State(i) = sensor.output else { return None };
            *component = i;
        }
        Some(components)
    }

    /// Adds R to a covariance of the readings.
    #[inline]
    pub(super) fn add_noise(&self, cov: &mut Matrix<M, M>) {
        for (row, sensor) in self.active.iter().enumerate() {
            cov[(row, row)] += sensor.variance;
        }
    }
}
