//! A plant with everything that surrounds it: augmentations, decay of the parameters, logarithms, readings of sensors.

use serde::{Deserialize, Serialize};

use crate::linalg::{Matrix, Vector};
use crate::quantity::Term;
use crate::{Channel, PlantKind, Quantity};

/// The physical meaning of a record's input.
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

/// The course of the input between samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Hold {
    /// It keeps the value of a sample until the next one: a zero-order hold.
    #[default]
    Zero,
    /// It is linear from each sample to the next: a first-order hold.
    First,
}

/// The n-component state `y` of a plant and its surroundings, its motion, and the readings of sensors.
///
/// ```text
/// y = [motion, parameters, augmentations]
/// ẏ = g(y, f):  motion as the plant has it under F = g f + o + u + w, parameters ṗ = -η p, augmentations constant
/// ```
///
/// With logarithms the state has `ln θ` in place of every parameter θ that cannot be negative
/// ([`Channel::is_positive`]), so that no estimate is: `d(ln θ)/dt = θ̇/θ`, `∂g/∂(ln θ) = θ ∂g/∂θ`.
#[derive(Clone, Debug)]
pub struct Model {
    plant: PlantKind,
    channels: Vec<Channel>,
    motion: usize,
    own: usize,
    eta: f64,
    logarithms: Vec<usize>,
    input: InputKind,
    gain: Option<usize>,
    offset: Option<usize>,
    unknown: Option<usize>,
    white: Option<usize>,
    /// The places of components that decay, and the times after which 1/e of them is left \[s\].
    forgotten: Vec<(usize, f64)>,
}

impl Model {
    /// A plant without augmentations.
    pub fn new(plant: PlantKind) -> Self {
        let channels = plant.channels().to_vec();
        let (motion, own) = (plant.motion(), channels.len());
        let (eta, logarithms, input) = (0.0, Vec::new(), InputKind::Force);
        let (gain, offset, unknown, white) = (None, None, None, None);
        let forgotten = Vec::new();
        Self { plant, channels, motion, own, eta, logarithms, input, gain, offset, unknown, white, forgotten }
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
        self.white = self.place(Channel::WHITE_FORCE);
        self
    }

    /// With parameters that decay at the rate `eta` \[1/s\].
    #[must_use]
    pub fn decaying(self, eta: f64) -> Self {
        Self { eta, ..self }
    }

    /// With the logarithms of positive parameters in the state if `log_parameters`.
    #[must_use]
    pub fn with_logarithms(self, log_parameters: bool) -> Self {
        let parameters = self.motion..self.own;
        let logarithms = parameters.filter(|&place| log_parameters && self.channels[place].is_positive()).collect();
        Self { logarithms, ..self }
    }

    /// With augmentations that are Gauss-Markov processes of these correlation times \[s\]; 0 for one that lasts.
    ///
    /// ```text
    /// b⁺ = φ b + w,  φ = exp(-dt / τ)
    /// ```
    ///
    /// Source: Brown and Hwang (2012), *Introduction to Random Signals and Applied Kalman Filtering*, section 2.9.
    #[must_use]
    pub fn forgetting(self, times: impl Iterator<Item = (Channel, f64)>) -> Self {
        let forgotten =
            times.filter(|(_, time)| *time > 0.0).filter_map(|(channel, time)| Some((self.place(channel)?, time)));
        Self { forgotten: forgotten.collect(), ..self }
    }

    /// The places of what does not last, and their correlation times \[s\].
    pub fn forgotten(&self) -> &[(usize, f64)] {
        &self.forgotten
    }

    /// With an input of this kind.
    #[must_use]
    pub fn driven_by(self, input: InputKind) -> Self {
        Self { input, ..self }
    }

    /// The plant.
    pub fn plant(&self) -> &PlantKind {
        &self.plant
    }

    /// The components of the state.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// The place of a channel in the state.
    pub fn place(&self, channel: Channel) -> Option<usize> {
        channel.place_in(&self.channels)
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

    /// Whether the state is in the channels' units: nothing of it is a logarithm.
    pub fn in_units(&self) -> bool {
        self.logarithms.is_empty()
    }

    /// Whether a component is a logarithm.
    pub fn is_logarithm(&self, place: usize) -> bool {
        self.logarithms.contains(&place)
    }

    /// The number of components that a step changes, which come first: those of the motion, and with a decay the parameters.
    pub fn moving(&self) -> usize {
        if self.eta == 0.0 { self.motion } else { self.own }
    }

    fn with_plain<T>(&self, state: &[f64], take: impl FnOnce(&[f64]) -> T) -> T {
        if self.logarithms.is_empty() {
            return take(&state[..self.own]);
        }
        let mut plain = state[..self.own].to_vec();
        self.logarithms.iter().for_each(|&place| plain[place] = libm::exp(plain[place]));
        take(&plain)
    }

    /// F, the force over mass that acts in a state under the recorded force over mass `force`, both in m/s².
    pub fn acting_force(&self, state: &[f64], force: f64) -> f64 {
        let at = |place: Option<usize>, otherwise: f64| place.map_or(otherwise, |place| state[place]);
        let lasting = self.recorded_force(state, force) + at(self.unknown, 0.0);
        self.white.map_or(lasting, |place| lasting + state[place])
    }

    /// The part of F that comes with the recorded input: `g f + o`.
    fn recorded_force(&self, state: &[f64], force: f64) -> f64 {
        let scaled = self.gain.map_or(force, |place| state[place] * force);
        self.offset.map_or(scaled, |place| scaled + state[place])
    }

    /// `g(y, f)` with the recorded force over mass `force` \[m/s²\], n numbers; each in its component's unit per second.
    pub fn rate(&self, state: &[f64], force: f64) -> Vector {
        self.rate_under(state, self.acting_force(state, force))
    }

    /// The rates of the components that move alone, M numbers, under the total force over mass \[m/s²\], written over `rate`.
    pub fn motion_rate_under_into(&self, state: &[f64], acting: f64, rate: &mut [f64]) {
        self.with_plain(state, |plain| self.plant.plant().motion_rate(plain, acting, rate));
    }

    /// `g` under the total force over mass \[m/s²\].
    pub fn rate_under(&self, state: &[f64], acting: f64) -> Vector {
        let mut rate = Vector::zeros(self.size());
        self.rate_under_into(state, acting, rate.as_mut_slice());
        rate
    }

    pub fn rate_under_into(&self, state: &[f64], acting: f64, rate: &mut [f64]) {
        let (motion, rest) = rate.split_at_mut(self.motion);
        self.motion_rate_under_into(state, acting, motion);
        rest.fill(0.0);
        if self.eta != 0.0 {
            for place in self.motion..self.own {
                rest[place - self.motion] = -self.eta * if self.is_logarithm(place) { 1.0 } else { state[place] };
            }
        }
    }

    /// `A = ∂g/∂y`, n × n, under the recorded force over mass `force` \[m/s²\].
    pub fn jacobian(&self, state: &[f64], force: f64) -> Matrix {
        let (n, motion, own) = (self.size(), self.motion, self.own);
        let (mut rows, mut jacobian) = (vec![0.0; motion * own], Matrix::zeros(n, n));
        self.with_plain(state, |plain| {
            self.plant.plant().motion_jacobian(plain, &mut rows);
            for (j, column) in jacobian.as_mut_slice().chunks_exact_mut(n).take(own).enumerate() {
                for (i, entry) in column[..motion].iter_mut().enumerate() {
                    *entry = rows[i * own + j];
                }
            }
            for &place in &self.logarithms {
                jacobian.column_mut(place).scale_mut(plain[place]);
            }
        });
        if self.eta != 0.0 {
            for place in motion..own {
                // -η θ / θ does not depend on θ.
                jacobian[(place, place)] = if self.is_logarithm(place) { 0.0 } else { -self.eta };
            }
        }
        if self.gain.or(self.offset).or(self.unknown).or(self.white).is_some() {
            rows.resize(2 * motion, 0.0);
            let (by_force, work) = rows.split_at_mut(motion);
            self.motion_by_force_into(state, by_force, &mut work[..motion]);
            for (place, factor) in self.force_parts(force) {
                for (entry, by_force) in jacobian.column_mut(place).iter_mut().zip(&*by_force) {
                    *entry = by_force * factor;
                }
            }
        }
        jacobian
    }

    fn force_parts(&self, force: f64) -> impl Iterator<Item = (usize, f64)> {
        let one = |place: usize| (place, 1.0);
        let gain = self.gain.map(|place| (place, force));
        gain.into_iter().chain(self.offset.map(one)).chain(self.unknown.map(one)).chain(self.white.map(one))
    }

    /// `∂g/∂F`, n numbers: the force enters additively.
    pub fn by_force(&self, state: &[f64]) -> Vector {
        let mut by_force = Vector::zeros(self.size());
        let mut work = vec![0.0; self.motion];
        self.motion_by_force_into(state, &mut by_force.as_mut_slice()[..self.motion], &mut work);
        by_force
    }

    /// The first M numbers of [`Self::by_force`], written over `by_force`; `work` is of the same size.
    pub fn motion_by_force_into(&self, state: &[f64], by_force: &mut [f64], work: &mut [f64]) {
        self.with_plain(state, |plain| {
            self.plant.plant().motion_rate(plain, 1.0, by_force);
            self.plant.plant().motion_rate(plain, 0.0, work);
        });
        for (with, without) in by_force.iter_mut().zip(work) {
            *with -= *without;
        }
    }

    /// `∂F/∂f`: the input gain in a state, 1 where there is none.
    pub fn gain(&self, state: &[f64]) -> f64 {
        self.gain.map_or(1.0, |place| state[place])
    }

    /// `∂g/∂f`, n numbers: [`Self::by_force`] times the gain.
    pub fn by_recorded_force(&self, state: &[f64]) -> Vector {
        self.by_force(state) * self.gain(state)
    }

    /// A state where all is zero but the gains of sensors, which `gain` gives by quantity.
    pub fn at_rest(&self, gain: impl Fn(Quantity) -> f64) -> Vec<f64> {
        let mut state = vec![0.0; self.size()];
        for &quantity in Quantity::all() {
            if let Some(place) = self.place(quantity.gain()) {
                state[place] = gain(quantity);
            }
        }
        state
    }

    /// The state for values in the channels' units, and the size of each channel's unit in the state's unit.
    pub fn to_state(&self, values: &[f64]) -> (Vector, Vector) {
        let mut state = Vector::from_column_slice(values);
        let mut unit = Vector::repeat(values.len(), 1.0);
        for &i in &self.logarithms {
            state[i] = libm::log(values[i]);
            unit[i] = 1.0 / values[i];
        }
        (state, unit)
    }

    /// The values in the channels' units in place of a state, and in `unit` the size of each component's unit in its channel's unit.
    pub fn to_units_in_place(&self, state: &mut [f64], unit: &mut [f64]) {
        unit.fill(1.0);
        for &place in &self.logarithms {
            state[place] = libm::exp(state[place]);
            unit[place] = state[place];
        }
    }

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

#[derive(Clone, Copy)]
pub(crate) struct Moving<'a> {
    pub(crate) state: &'a [f64],
    pub(crate) rate: &'a [f64],
    pub(crate) jacobian: &'a Matrix,
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
