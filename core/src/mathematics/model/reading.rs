//! Readings of sensors from a model's state.

use super::{InputKind, Model};
use crate::Quantity;
use crate::mathematics::linalg::{Matrix, Vector};
use crate::mathematics::quantity::Term;

/// The reading of a sensor, in places of a model's state.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    pub(crate) components: Vec<(usize, f64)>,
    pub(crate) rates: Vec<(usize, f64)>,
    pub(crate) ground: f64,
    /// The component, if the reading is one component with the factor 1 and nothing else.
    pub(crate) component: Option<usize>,
    /// The gain of the sensor, which multiplies components, rates and ground.
    pub(crate) gain: Option<Scale>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    pub(crate) gain: usize,
    /// The bias, which is not multiplied. Without a gain it is one of the components.
    pub(crate) bias: Option<usize>,
}

/// A state that moves: n numbers, and where a sensor reads rates also ẏ, n numbers, and A, n × n.
#[derive(Clone, Copy)]
pub(crate) struct Moving<'a> {
    pub(crate) state: &'a [f64],
    pub(crate) rate: &'a [f64],
    pub(crate) jacobian: &'a Matrix,
}

impl Model {
    /// The reading of a sensor for `quantity`, if the plant has it.
    pub fn reading(&self, quantity: Quantity) -> Option<Reading> {
        let mut reading =
            Reading { components: Vec::new(), rates: Vec::new(), ground: 0.0, component: None, gain: None };
        for (term, factor) in quantity.reads() {
            match term {
                Term::State(channel) => reading.components.push((self.place(channel)?, factor)),
                Term::Rate(channel) => reading.rates.push((self.place(channel)?, factor)),
                Term::Ground if self.input == InputKind::GroundAcceleration => reading.ground += factor,
                Term::Ground => {}
            }
        }
        let bias = self.place(quantity.bias());
        reading.gain = self.place(quantity.gain()).map(|gain| Scale { gain, bias });
        if let Some(bias) = bias.filter(|_| reading.gain.is_none()) {
            reading.components.push((bias, 1.0));
        }
        reading.component = match (&reading.components[..], &reading.rates[..], reading.ground, reading.gain) {
            (&[(place, 1.0)], [], 0.0, None) => Some(place),
            _ => None,
        };
        Some(reading)
    }

    /// `h(y, f)`: the reading of a perfect sensor, in its quantity's unit.
    pub fn read(&self, reading: &Reading, state: &[f64], force: f64) -> f64 {
        self.read_disturbed(reading, state, force, 0.0)
    }

    /// [`Self::read`] under an additional, unrecorded force over mass `disturbance` \[m/s²\].
    pub fn read_disturbed(&self, reading: &Reading, state: &[f64], force: f64, disturbance: f64) -> f64 {
        if reading.is_of_components() {
            return self.read_moving(reading, state, &[], force);
        }
        let rate = self.rate_under(state, self.acting_force(state, force) + disturbance);
        self.read_moving(reading, state, rate.as_slice(), force)
    }

    /// [`Self::read`] in a state that moves at this rate; only readings of rates use it.
    pub fn read_moving(&self, reading: &Reading, state: &[f64], rate: &[f64], force: f64) -> f64 {
        let exact = self.read_exact(reading, state, rate, force);
        reading.gain.map_or(exact, |Scale { gain, bias }| state[gain] * exact + bias.map_or(0.0, |bias| state[bias]))
    }

    fn read_exact(&self, reading: &Reading, state: &[f64], rate: &[f64], force: f64) -> f64 {
        let Reading { components, rates, ground, .. } = reading;
        let mut sum: f64 = components.iter().map(|&(place, factor)| factor * state[place]).sum();
        sum += rates.iter().map(|&(place, factor)| factor * rate[place]).sum::<f64>();
        if *ground != 0.0 {
            // The force over mass is the negative of the ground's acceleration.
            sum -= ground * self.recorded_force(state, force);
        }
        sum
    }

    /// `∂h/∂y`, n numbers.
    pub fn read_gradient(&self, reading: &Reading, state: &[f64], force: f64) -> Vector {
        let of_rates = !reading.rates.is_empty();
        let jacobian = if of_rates { self.jacobian(state, force) } else { Matrix::zeros(0, 0) };
        let rate = if of_rates { self.rate(state, force) } else { Vector::zeros(0) };
        let mut gradient = Vector::zeros(self.size());
        let at = Moving { state, rate: rate.as_slice(), jacobian: &jacobian };
        self.read_gradient_into(reading, at, force, |place, part| gradient[place] += part);
        gradient
    }

    /// Adds the non-zero parts of `∂h/∂y` to their places.
    pub(crate) fn read_gradient_into(
        &self,
        reading: &Reading,
        at: Moving<'_>,
        force: f64,
        mut add: impl FnMut(usize, f64),
    ) {
        let Some(Scale { gain, bias }) = reading.gain else {
            return self.gradient_of_exact(reading, at.jacobian, force, add);
        };
        let factor = at.state[gain];
        self.gradient_of_exact(reading, at.jacobian, force, |place, part| add(place, factor * part));
        add(gain, self.read_exact(reading, at.state, at.rate, force));
        if let Some(bias) = bias {
            add(bias, 1.0);
        }
    }

    fn gradient_of_exact(&self, reading: &Reading, jacobian: &Matrix, force: f64, mut add: impl FnMut(usize, f64)) {
        let Reading { components, rates, ground, .. } = reading;
        for &(place, factor) in components {
            add(place, factor);
        }
        for &(row, factor) in rates {
            for (place, entry) in jacobian.row(row).iter().enumerate() {
                add(place, entry * factor);
            }
        }
        if *ground != 0.0 {
            let unrecorded = [self.unknown, self.white];
            for (place, factor) in self.force_parts(force).filter(|(place, _)| !unrecorded.contains(&Some(*place))) {
                add(place, -ground * factor);
            }
        }
    }
}

impl Reading {
    /// Whether it reads a rate.
    pub fn is_of_rates(&self) -> bool {
        !self.rates.is_empty()
    }

    /// Whether it is linear in the state for every plant.
    #[inline]
    pub fn is_of_components(&self) -> bool {
        self.rates.is_empty() && self.ground == 0.0 && self.gain.is_none()
    }
}
