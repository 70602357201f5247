//! A plant with everything that surrounds it: augmentations, decay of the parameters, logarithms, readings of sensors.

use kalmanscope_filters::engine::model::{Input, Reading, Scale, StateModel, read};
use kalmanscope_filters::linalg::{Matrix, Vector};
use kalmanscope_filters::{Dynamics as _, InputKind};

use super::PlantKind;
use super::dynamics::EnginePlant;
use crate::{Channel, Quantity, Term};

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
    input: InputKind,
    /// The same by places, for the engine.
    pub state: StateModel<EnginePlant>,
}

impl Model {
    /// A plant without augmentations.
    pub fn new(plant: PlantKind) -> Self {
        let (channels, state) = (plant.channels().to_vec(), StateModel::new(plant.dynamics()));
        Self { plant, channels, input: InputKind::Force, state }
    }

    /// With these augmentations too, each once; channels that are none are left out.
    #[must_use]
    pub fn augmented(mut self, augmentations: impl IntoIterator<Item = Channel>) -> Self {
        for channel in augmentations {
            if channel.is_augmentation() && !self.channels.contains(&channel) {
                self.channels.push(channel);
            }
        }
        self.state.size = self.channels.len();
        self.state.gain = self.place(Channel::INPUT_GAIN);
        self.state.offset = self.place(Channel::INPUT_OFFSET);
        let unrecorded = [Channel::UNKNOWN_FORCE, Channel::WHITE_FORCE];
        self.state.unrecorded = unrecorded.into_iter().filter_map(|channel| self.place(channel)).collect();
        self
    }

    /// With parameters that decay at the rate `eta` \[1/s\].
    #[must_use]
    pub fn decaying(mut self, eta: f64) -> Self {
        let [own, motion] = self.state.plant.sizes();
        self.state.eta = eta;
        self.state.by_force.resize(if eta == 0.0 { motion } else { own }, 0.0);
        self
    }

    /// With the logarithms of positive parameters in the state if `log_parameters`.
    #[must_use]
    pub fn with_logarithms(mut self, log_parameters: bool) -> Self {
        let [own, motion] = self.state.plant.sizes();
        let is_logarithm = |&place: &usize| log_parameters && self.channels[place].is_positive();
        self.state.logarithms = (motion..own).filter(is_logarithm).collect();
        self
    }

    /// With augmentations that are Gauss-Markov processes of these correlation times \[s\]; 0 for one that lasts.
    ///
    /// ```text
    /// b⁺ = φ b + w,  φ = exp(-dt / τ)
    /// ```
    ///
    /// Source: Brown and Hwang (2012), *Introduction to Random Signals and Applied Kalman Filtering*, section 2.9.
    #[must_use]
    pub fn forgetting(mut self, times: impl Iterator<Item = (Channel, f64)>) -> Self {
        let forgotten = times.filter(|(_, time)| *time > 0.0);
        self.state.forgotten = forgotten.filter_map(|(channel, time)| Some((self.place(channel)?, time))).collect();
        self
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
        self.state.plant.sizes()[1]
    }

    /// Whether the motion is linear as long as all other components are constant.
    pub fn is_linear(&self) -> bool {
        self.plant.info().is_linear
    }

    /// F, the force over mass that acts in a state under the recorded force over mass `force`, both in m/s².
    pub fn acting_force(&self, state: &[f64], force: f64) -> f64 {
        self.state.acting(state, force)
    }

    /// `g(y, f)` with the recorded force over mass `force` \[m/s²\], n numbers; each in its component's unit per second.
    pub fn rate(&self, state: &[f64], force: f64) -> Vector {
        self.rate_under(state, self.acting_force(state, force))
    }

    fn rate_under(&self, state: &[f64], acting: f64) -> Vector {
        let mut rate = Vector::zeros(self.size());
        self.rate_under_into(state, acting, rate.as_mut_slice());
        rate
    }

    pub(crate) fn rate_under_into(&self, state: &[f64], acting: f64, rate: &mut [f64]) {
        rate.fill(0.0);
        let mut plain = vec![0.0; if self.state.logarithms.is_empty() { 0 } else { self.size() }];
        let plain = self.state.plain(state, &mut plain);
        self.state.plant.motion_rate(plain, acting, rate);
        self.state.decay(plain, rate);
    }

    /// `A = ∂g/∂y`, n × n, under the recorded force over mass `force` \[m/s²\].
    pub fn jacobian(&self, state: &[f64], force: f64) -> Matrix {
        self.state.jacobian(state, force)
    }

    /// `∂g/∂F`, n numbers: the force enters additively.
    pub fn by_force(&self, state: &[f64]) -> Vector {
        self.rate_under(state, 1.0) - self.rate_under(state, 0.0)
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
        for &i in &self.state.logarithms {
            state[i] = libm::log(values[i]);
            unit[i] = 1.0 / values[i];
        }
        (state, unit)
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
    pub fn read<'a>(&self, reading: &Reading, state: &[f64], input: impl Into<Input<'a>>) -> f64 {
        self.read_disturbed(reading, state, input.into(), 0.0)
    }

    /// [`Self::read`] under an additional, unrecorded force over mass `disturbance` \[m/s²\].
    pub fn read_disturbed(&self, reading: &Reading, state: &[f64], input: Input<'_>, disturbance: f64) -> f64 {
        let mut rate = Vector::zeros(0);
        if reading.is_of_rates() {
            rate = self.rate_under(state, self.acting_force(state, input.force) + disturbance);
            input.push(rate.as_mut_slice());
        }
        read(&self.state, reading, state, rate.as_slice(), input.force)
    }
}
