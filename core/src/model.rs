//! A plant with everything that surrounds it: augmentations, decay of the parameters, logarithms.

use serde::{Deserialize, Serialize};

use crate::linalg::{Matrix, Vector};
use crate::quantity::Term;
use crate::{Channel, PlantKind, Quantity};

/// What the input of a record is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum InputKind {
    /// A force over mass \[m/s²\].
    #[default]
    Force,
    /// The acceleration of the ground \[m/s²\]: the force over mass is its negative.
    GroundAcceleration,
}

impl InputKind {
    /// The force over mass for a value of the input, both in m/s².
    #[inline]
    pub fn force(self, input: f64) -> f64 {
        match self {
            Self::Force => input,
            Self::GroundAcceleration => -input,
        }
    }
}

/// How the input runs between samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Hold {
    /// It keeps the value of a sample until the next one: a zero-order hold.
    #[default]
    Zero,
    /// It is linear from each sample to the next: a first-order hold.
    First,
}

/// The n-component state `y` of a plant and its surroundings, how it moves and what sensors read of it.
///
/// ```text
/// y = [motion, parameters, augmentations]
/// ẏ = g(y, f):  motion as the plant has it under F = g f + o + u, parameters ṗ = -η p, augmentations constant
/// ```
///
/// With logarithms the state has `ln θ` in place of every parameter θ that cannot be negative
/// ([`Channel::is_positive`]), so that no estimate is: `d(ln θ)/dt = θ̇/θ`, `∂g/∂(ln θ) = θ ∂g/∂θ`.
#[derive(Clone, Debug)]
pub struct Model {
    plant: PlantKind,
    channels: Vec<Channel>,
    motion: usize,
    /// The number of components that are the plant's own.
    own: usize,
    eta: f64,
    log_parameters: bool,
    input: InputKind,
    gain: Option<usize>,
    /// The places of forces that the record lacks: the offset and the unknown force.
    offset: Option<usize>,
    unknown: Option<usize>,
}

/// The reading of a sensor, in places of a model's state.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// Components with their factors.
    state: Vec<(usize, f64)>,
    /// Rates of components with their factors.
    rates: Vec<(usize, f64)>,
    /// The factor of the ground's acceleration.
    ground: f64,
}

impl Model {
    /// A plant as it is.
    pub fn new(plant: PlantKind) -> Self {
        let channels = plant.channels().to_vec();
        let (motion, own) = (plant.motion(), channels.len());
        let (eta, log_parameters, input) = (0.0, false, InputKind::Force);
        Self { plant, channels, motion, own, eta, log_parameters, input, gain: None, offset: None, unknown: None }
    }

    /// With these augmentations too, each once; channels that are none are left out.
    #[must_use]
    pub fn augmented(mut self, augmentations: impl IntoIterator<Item = Channel>) -> Self {
        for channel in augmentations {
            if channel.is_augmentation() && !self.channels.contains(&channel) {
                self.channels.push(channel);
            }
        }
        self.gain = self.place(Channel::INPUT_GAIN);
        self.offset = self.place(Channel::INPUT_OFFSET);
        self.unknown = self.place(Channel::UNKNOWN_FORCE);
        self
    }

    /// With parameters that decay at the rate `eta` \[1/s\].
    #[must_use]
    pub fn decaying(self, eta: f64) -> Self {
        Self { eta, ..self }
    }

    /// With the logarithms of positive parameters in the state, if so wished.
    #[must_use]
    pub fn with_logarithms(self, log_parameters: bool) -> Self {
        Self { log_parameters, ..self }
    }

    /// With an input of this kind.
    #[must_use]
    pub fn driven_by(self, input: InputKind) -> Self {
        Self { input, ..self }
    }

    /// The plant.
    pub fn plant(&self) -> PlantKind {
        self.plant
    }

    /// The components of the state.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// The place of a channel in the state.
    pub fn place(&self, channel: Channel) -> Option<usize> {
        self.channels.iter().position(|&c| c == channel)
    }

    /// n, the number of components of the state.
    pub fn size(&self) -> usize {
        self.channels.len()
    }

    /// The number of components that move, which come first.
    pub fn motion(&self) -> usize {
        self.motion
    }

    /// η, the rate at which the plant's parameters decay \[1/s\].
    pub fn eta(&self) -> f64 {
        self.eta
    }

    /// Whether the motion is linear as long as all other components are constant.
    pub fn is_linear(&self) -> bool {
        self.plant.info().is_linear
    }

    /// Whether a component is a logarithm.
    pub fn is_logarithm(&self, place: usize) -> bool {
        self.log_parameters && (self.motion..self.own).contains(&place) && self.channels[place].is_positive()
    }

    /// The plant's own state, logarithms undone.
    fn plain(&self, state: &[f64]) -> Vec<f64> {
        let value = |i: usize| if self.is_logarithm(i) { libm::exp(state[i]) } else { state[i] };
        (0..self.own).map(value).collect()
    }

    /// F, the force over mass that acts in a state under the recorded force over mass `force`, both in m/s².
    pub fn acting_force(&self, state: &[f64], force: f64) -> f64 {
        let at = |place: Option<usize>, otherwise: f64| place.map_or(otherwise, |place| state[place]);
        self.recorded_force(state, force) + at(self.unknown, 0.0)
    }

    /// The part of F that comes with the recorded input: `g f + o`.
    fn recorded_force(&self, state: &[f64], force: f64) -> f64 {
        let scaled = self.gain.map_or(force, |place| state[place] * force);
        self.offset.map_or(scaled, |place| scaled + state[place])
    }

    /// `g(y, f)` with the recorded force over mass `force` \[m/s²\], n numbers; each in its component's unit per second.
    pub fn rate(&self, state: &[f64], force: f64) -> Vector {
        let mut rate = Vector::zeros(self.size());
        self.rate_into(state, force, rate.as_mut_slice());
        rate
    }

    /// [`Self::rate`] in place of what `rate` holds, without reserving memory unless there are logarithms.
    pub fn rate_into(&self, state: &[f64], force: f64, rate: &mut [f64]) {
        self.rate_under_into(state, self.acting_force(state, force), rate);
    }

    /// `g` under the force over mass that acts, whatever it is made of \[m/s²\].
    pub fn rate_under(&self, state: &[f64], acting: f64) -> Vector {
        let mut rate = Vector::zeros(self.size());
        self.rate_under_into(state, acting, rate.as_mut_slice());
        rate
    }

    fn rate_under_into(&self, state: &[f64], acting: f64, rate: &mut [f64]) {
        let (motion, rest) = rate.split_at_mut(self.motion);
        if self.log_parameters {
            self.plant.plant().motion_rate(&self.plain(state), acting, motion);
        } else {
            self.plant.plant().motion_rate(&state[..self.own], acting, motion);
        }
        for (offset, rate) in rest.iter_mut().enumerate() {
            let place = self.motion + offset;
            *rate = match place {
                _ if place >= self.own || self.eta == 0.0 => 0.0,
                _ if self.is_logarithm(place) => -self.eta,
                _ => -self.eta * state[place],
            };
        }
    }

    /// `A = ∂g/∂y`, n × n, under the recorded force over mass `force` \[m/s²\].
    pub fn jacobian(&self, state: &[f64], force: f64) -> Matrix {
        let n = self.size();
        let plain = self.plain(state);
        let mut rows = vec![0.0; self.motion * self.own];
        self.plant.plant().motion_jacobian(&plain, &mut rows);
        let mut jacobian = Matrix::zeros(n, n);
        for i in 0..self.motion {
            for j in 0..self.own {
                let by_plain = rows[i * self.own + j];
                jacobian[(i, j)] = if self.is_logarithm(j) { by_plain * plain[j] } else { by_plain };
            }
        }
        for j in self.motion..self.own {
            // -η θ / θ does not depend on θ.
            jacobian[(j, j)] = if self.is_logarithm(j) { 0.0 } else { -self.eta };
        }
        if self.gain.or(self.offset).or(self.unknown).is_some() {
            let by_force = self.by_force(state);
            for (place, factor) in self.force_parts(force) {
                for i in 0..self.motion {
                    jacobian[(i, place)] = by_force[i] * factor;
                }
            }
        }
        jacobian
    }

    /// The components that are parts of F, with the derivative of F by each.
    fn force_parts(&self, force: f64) -> impl Iterator<Item = (usize, f64)> {
        let one = |place: usize| (place, 1.0);
        let gain = self.gain.map(|place| (place, force));
        gain.into_iter().chain(self.offset.map(one)).chain(self.unknown.map(one))
    }

    /// The place of the input gain, whose column of the Jacobian is that of the force times the force.
    pub fn gain_place(&self) -> Option<usize> {
        self.gain
    }

    /// `∂g/∂F`, n numbers: the force enters additively.
    pub fn by_force(&self, state: &[f64]) -> Vector {
        let plain = self.plain(state);
        let mut with = Vector::zeros(self.size());
        let mut without = vec![0.0; self.motion];
        self.plant.plant().motion_rate(&plain, 1.0, &mut with.as_mut_slice()[..self.motion]);
        self.plant.plant().motion_rate(&plain, 0.0, &mut without);
        for (with, without) in with.iter_mut().zip(without) {
            *with -= without;
        }
        with
    }

    /// `∂F/∂f`: the input gain in a state, 1 where there is none.
    pub fn gain(&self, state: &[f64]) -> f64 {
        self.gain.map_or(1.0, |place| state[place])
    }

    /// `∂g/∂f`, n numbers: [`Self::by_force`] times the gain.
    pub fn by_recorded_force(&self, state: &[f64]) -> Vector {
        self.by_force(state) * self.gain(state)
    }

    /// Where a sensor for `quantity` reads, if the plant has it.
    pub fn reading(&self, quantity: Quantity) -> Option<Reading> {
        let mut reading = Reading { state: Vec::new(), rates: Vec::new(), ground: 0.0 };
        for (term, factor) in quantity.reads() {
            match term {
                Term::State(channel) => reading.state.push((self.place(channel)?, factor)),
                Term::Rate(channel) => reading.rates.push((self.place(channel)?, factor)),
                Term::Ground if self.input == InputKind::GroundAcceleration => reading.ground += factor,
                Term::Ground => {}
            }
        }
        if let Some(bias) = self.place(quantity.bias()) {
            reading.state.push((bias, 1.0));
        }
        Some(reading)
    }

    /// `h(y, f)`: what a perfect sensor reads, in its quantity's unit.
    pub fn read(&self, reading: &Reading, state: &[f64], force: f64) -> f64 {
        self.read_disturbed(reading, state, force, 0.0)
    }

    /// [`Self::read`] where a force over mass acts besides that nobody records \[m/s²\].
    pub fn read_disturbed(&self, reading: &Reading, state: &[f64], force: f64, disturbance: f64) -> f64 {
        if reading.is_of_components() {
            return self.read_moving(reading, state, &[], force);
        }
        let rate = self.rate_under(state, self.acting_force(state, force) + disturbance);
        self.read_moving(reading, state, rate.as_slice(), force)
    }

    /// [`Self::read`] in a state that moves at this rate, which only readings of rates look at.
    pub fn read_moving(&self, reading: &Reading, state: &[f64], rate: &[f64], force: f64) -> f64 {
        let Reading { state: components, rates, ground } = reading;
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
        let Reading { state: components, rates, ground } = reading;
        let mut gradient = Vector::zeros(self.size());
        for &(place, factor) in components {
            gradient[place] += factor;
        }
        if !rates.is_empty() {
            let jacobian = self.jacobian(state, force);
            for &(place, factor) in rates {
                gradient += jacobian.row(place).transpose() * factor;
            }
        }
        if *ground != 0.0 {
            let unrecorded = self.unknown;
            for (place, factor) in self.force_parts(force).filter(|(place, _)| Some(*place) != unrecorded) {
                gradient[place] -= ground * factor;
            }
        }
        gradient
    }

    /// The state for values in the channels' units, and what a unit of each channel is in the state's.
    pub fn to_state(&self, values: &[f64]) -> (Vector, Vector) {
        let mut state = Vector::from_column_slice(values);
        let mut unit = Vector::repeat(values.len(), 1.0);
        for i in (0..values.len()).filter(|&i| self.is_logarithm(i)) {
            state[i] = libm::log(values[i]);
            unit[i] = 1.0 / values[i];
        }
        (state, unit)
    }

    /// The values in the channels' units for a state, and what a unit of each component is in them.
    pub fn to_units(&self, state: &[f64]) -> (Vector, Vector) {
        let mut values = Vector::from_column_slice(state);
        let mut unit = Vector::repeat(state.len(), 1.0);
        for i in (0..state.len()).filter(|&i| self.is_logarithm(i)) {
            values[i] = libm::exp(state[i]);
            unit[i] = values[i];
        }
        (values, unit)
    }
}

impl Reading {
    /// The component that it reads as it is, if it reads one alone.
    pub fn component(&self) -> Option<usize> {
        match (&self.state[..], &self.rates[..], self.ground) {
            (&[(place, 1.0)], [], 0.0) => Some(place),
            _ => None,
        }
    }

    /// The component whose rate it reads as it is, if it reads that alone.
    pub fn rate_component(&self) -> Option<usize> {
        match (&self.state[..], &self.rates[..], self.ground) {
            ([], &[(place, 1.0)], 0.0) => Some(place),
            _ => None,
        }
    }

    /// Whether it is linear in the state, whatever the plant.
    pub fn is_of_components(&self) -> bool {
        self.rates.is_empty() && self.ground == 0.0
    }
}
