//! The settings from which everything follows.

mod color;
mod identity;
mod plant;
mod syntax;
mod validate;
mod values;
mod written;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::filter::{Adaptation, FilterKind, Propagation};
use crate::model::{Hold, InputKind, Model};
use crate::{Channel, Force, PlantKind, Quantity, Signal};

pub use color::FilterColor;
pub use plant::{Motion, Plant};
pub use values::Values;

/// A truth, the sensors that watch it and the filters that estimate it: plain data, TOML on disk.
///
/// A missing key has a default, an unknown key is an error. Everything that a run shows follows from these settings.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Scenario {
    /// Seed of every random number.
    pub seed: u64,
    /// Time between samples \[s\].
    pub dt: f64,
    /// Time from the first sample to the last \[s\].
    pub duration: f64,
    /// The truth.
    pub plant: Plant,
    /// The measured input: a force over mass, or the ground's acceleration.
    pub force: Force,
    /// What the input is.
    #[serde(skip_serializing_if = "is_default")]
    pub input: InputKind,
    /// How the input runs between samples.
    #[serde(skip_serializing_if = "is_default")]
    pub hold: Hold,
    /// What is measured, each quantity at most once.
    pub sensors: Vec<Sensor>,
    /// What estimates.
    #[serde(default = "default_filters")]
    pub filters: Vec<FilterSettings>,
}

/// A sensor and its true noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sensor {
    /// The quantity that it measures.
    pub measures: Quantity,
    /// Standard deviation of its noise, which is white and normal; in the quantity's unit.
    pub noise_std: f64,
}

/// One filter: what it believes at first and how far it trusts the model and the sensors.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FilterSettings {
    /// The number by which the filter is known as others come and go, from 1 on; 0 or left out in a file for that of its
    /// place. An ensemble's random numbers and the usual colour follow from it.
    #[serde(skip_serializing_if = "is_zero")]
    pub id: u32,
    /// The name on screen and in files; its kind's if left empty.
    pub name: String,
    /// The kind of filter.
    pub kind: FilterKind,
    /// The colour in which the filter is drawn; by its id if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub color: Option<FilterColor>,
    /// The kind of plant that the filter takes the truth for; the truth's own if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plant: Option<PlantKind>,
    /// The augmentations ([`crate::augment`]) that the filter estimates, or knows where their standard deviations are zero.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub augment: Vec<Channel>,
    /// How many samples after it is recorded the plant feels the input, as the filter takes it; negative where the record is
    /// late. Before the record's first sample and after its last, these stand.
    #[serde(skip_serializing_if = "is_default")]
    pub input_delay: i32,
    /// Whether the filter estimates the logarithms of the parameters that cannot be negative.
    pub log_parameters: bool,
    /// How the mean of a KF, EKF or IEKF moves.
    pub propagation: Propagation,
    /// The most times that an IEKF linearises the sensors in one update.
    pub iterations: usize,
    /// The number of members of an EnKF, or of particles of a PF.
    pub ensemble_size: usize,
    /// Whether the filter learns R and Q from its innovations.
    pub adaptation: Adaptation,
    /// Whether the whole record is smoothed once the filter has seen it.
    pub smoother: bool,
    /// Fading factor λ ≥ 1 on the predicted covariance; 1 forgets nothing.
    pub fading: f64,
    /// Rate η ≥ 0 at which the model lets the parameters decay \[1/s\]; 0 keeps them constant.
    pub eta: f64,
    /// Standard deviations that the filter ascribes to the sensors, in their order: the square roots of the diagonal of
    /// R. The sensors' true ones if left empty in a file.
    pub sensor_std: Vec<f64>,
    /// Mean of the initial belief.
    #[serde(deserialize_with = "values::initial_mean")]
    pub initial_mean: Values,
    /// Standard deviations of the initial belief.
    #[serde(deserialize_with = "values::initial_std")]
    pub initial_std: Values,
    /// Standard deviations of the process noise per step: the square roots of the diagonal of Q.
    #[serde(deserialize_with = "values::process_std")]
    pub process_std: Values,
}

/// Why a scenario cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum ScenarioError {
    /// The text is not a scenario: the message has line, key and what is allowed.
    #[error("{0}")]
    Syntax(String),
    /// A value is impossible.
    #[error("`{key}` is {value}, but must be {allowed}")]
    Value {
        /// The key's path in the file.
        key: String,
        /// What it is.
        value: String,
        /// What it may be.
        allowed: String,
    },
}

impl Default for FilterSettings {
    fn default() -> Self {
        Self {
            id: 0,
            name: String::new(),
            kind: FilterKind::EKF,
            color: None,
            plant: None,
            augment: Vec::new(),
            input_delay: 0,
            log_parameters: false,
            propagation: Propagation::LocalLinearisation,
            iterations: 5,
            ensemble_size: 500,
            adaptation: Adaptation::default(),
            smoother: false,
            fading: 1.0,
            eta: 0.0,
            sensor_std: Vec::new(),
            initial_mean: Values::INITIAL_MEAN,
            initial_std: Values::INITIAL_STD,
            process_std: Values::PROCESS_STD,
        }
    }
}

impl FilterSettings {
    /// The filter's model of a truth of some kind under an input.
    pub fn model(&self, truth: PlantKind, input: InputKind) -> Model {
        // The KF knows the parameters: they do not decay.
        let eta = if self.kind == FilterKind::KF { 0.0 } else { self.eta };
        let model = Model::new(self.plant.unwrap_or(truth)).augmented(self.augment.iter().copied());
        model.decaying(eta).with_logarithms(self.log_parameters).driven_by(input)
    }

    /// Whether the filter takes a channel for known and exact, whatever its standard deviations: the KF takes the
    /// parameters of its plant so.
    pub fn knows(&self, channel: Channel) -> bool {
        self.kind == FilterKind::KF && channel.is_parameter() && !channel.is_augmentation()
    }
}

impl Default for Scenario {
    /// A stiffness loss half-way, seen by an EKF and a UKF with fading memory.
    fn default() -> Self {
        let mut scenario = Self {
            seed: 1,
            dt: 0.01,
            duration: 60.0,
            plant: Plant::default(),
            force: Force::default(),
            input: InputKind::default(),
            hold: Hold::default(),
            sensors: vec![
                Sensor { measures: Quantity::DISPLACEMENT, noise_std: 0.01 },
                Sensor { measures: Quantity::VELOCITY, noise_std: 0.06 },
            ],
            filters: default_filters(),
        };
        scenario.fill_in();
        scenario
    }
}

impl Scenario {
    /// Reads a scenario file and checks it.
    ///
    /// # Errors
    /// [`ScenarioError::Syntax`] where it is no TOML, has an unknown key or a value of the wrong type;
    /// [`ScenarioError::Value`] where [`Self::validate`] finds an impossible value.
    pub fn from_toml(text: &str) -> Result<Self, ScenarioError> {
        let mut scenario: Self =
            toml::from_str(text).map_err(|error| ScenarioError::Syntax(syntax::message(text, &error)))?;
        scenario.fill_in();
        scenario.validate()?;
        Ok(scenario)
    }

    /// The scenario as a file that [`Self::from_toml`] reads back to an equal one.
    ///
    /// # Errors
    /// [`ScenarioError::Syntax`] where TOML has no way to write it, which no valid scenario meets.
    pub fn to_toml(&self) -> Result<String, ScenarioError> {
        written::text(self).map_err(|e| ScenarioError::Syntax(e.to_string()))
    }

    /// The number of samples, the one at t = 0 counted.
    pub fn samples(&self) -> usize {
        libm::round(self.duration / self.dt) as usize + 1
    }

    /// Adds a sensor, or does nothing if its quantity is measured already. Every filter ascribes its true noise to it.
    pub fn add_sensor(&mut self, sensor: Sensor) {
        if self.sensors.iter().any(|s| s.measures == sensor.measures) {
            return;
        }
        let place = self.sensors.partition_point(|s| s.measures < sensor.measures);
        self.sensors.insert(place, sensor);
        for filter in &mut self.filters {
            filter.sensor_std.insert(place.min(filter.sensor_std.len()), usable_std(sensor.measures, sensor.noise_std));
        }
    }

    /// Removes the sensor of a quantity, from the filters too.
    pub fn remove_sensor(&mut self, quantity: Quantity) {
        while let Some(place) = self.sensors.iter().position(|s| s.measures == quantity) {
            self.sensors.remove(place);
            for filter in self.filters.iter_mut().filter(|f| place < f.sensor_std.len()) {
                filter.sensor_std.remove(place);
            }
        }
    }

    /// Takes another kind of plant for the truth; sensors of what it does not have are removed.
    pub fn set_plant(&mut self, kind: PlantKind) {
        self.plant.kind = kind;
        for quantity in self.sensors.iter().map(|s| s.measures).filter(|q| !kind.has(*q)).collect::<Vec<_>>() {
            self.remove_sensor(quantity);
        }
        self.fill_in();
    }

    /// The noise that a filter would be told by someone who knows the truth: that of the sensors
    /// ([`Self::true_sensor_std`]), what the disturbance adds in a step, and the root mean square change of the parameters per step.
    pub fn true_noise(&self) -> (Vec<f64>, Values) {
        let sensor_std = self.true_sensor_std();
        let d = self.plant.disturbance_std;
        let mut process_std = Values::ZERO;
        for &channel in self.plant.model(self.input).channels() {
            if let Some(signal) = self.plant.parameter(channel) {
                process_std[channel] = self.change_per_step(signal);
            } else if let Some(velocity) = channel.rate() {
                process_std[channel] = d * self.dt * self.dt / 2.0;
                process_std[velocity] = d * self.dt;
            }
        }
        (sensor_std, process_std)
    }

    /// The standard deviations of the sensors' noise, as a filter can use them: their own, and what the disturbance adds to
    /// the reading of a sensor that feels it, such as an accelerometer.
    ///
    /// ```text
    /// R = noise² + (∂h/∂F)² disturbance²
    /// ```
    pub fn true_sensor_std(&self) -> Vec<f64> {
        let model = self.plant.model(self.input);
        let at_rest = vec![0.0; model.size()];
        let felt = |quantity: Quantity| {
            let reading = model.reading(quantity);
            let under = |disturbance| {
                reading.as_ref().map_or(0.0, |reading| model.read_disturbed(reading, &at_rest, 0.0, disturbance))
            };
            (under(1.0) - under(0.0)) * self.plant.disturbance_std
        };
        self.sensors.iter().map(|s| usable_std(s.measures, libm::hypot(s.noise_std, felt(s.measures)))).collect()
    }

    /// The root mean square change of a signal from one sample to the next.
    fn change_per_step(&self, signal: Signal) -> f64 {
        let steps = self.samples() - 1;
        let change = |k: usize| signal.at((k + 1) as f64 * self.dt) - signal.at(k as f64 * self.dt);
        let square: f64 = (0..steps).map(|k| change(k) * change(k)).sum();
        (square / steps.max(1) as f64).sqrt()
    }

    /// Completes what a file may leave out because it follows from the rest.
    fn fill_in(&mut self) {
        self.number_filters();
        let Self { sensors, filters, plant, input, .. } = self;
        for filter in filters {
            let model = filter.model(plant.kind, *input);
            for values in [&mut filter.initial_mean, &mut filter.initial_std, &mut filter.process_std] {
                values.complete(model.channels());
            }
            if filter.name.is_empty() {
                filter.name = filter.kind.name().to_owned();
            }
            if filter.sensor_std.is_empty() {
                filter.sensor_std = sensors.iter().map(|s| usable_std(s.measures, s.noise_std)).collect();
            }
        }
    }
}

/// An EKF and a UKF with fading memory; their names and sensors still to be filled in.
fn default_filters() -> Vec<FilterSettings> {
    let fading = |kind: FilterKind| FilterSettings { kind, fading: 1.005, ..FilterSettings::default() };
    vec![fading(FilterKind::EKF), fading(FilterKind::UKF)]
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for a reference")]
fn is_zero(id: &u32) -> bool {
    *id == 0
}

/// The least standard deviation that a filter is told of a sensor, in the usual noise of the quantity. A sensor may be
/// perfect, but a filter that is told so has a singular innovation covariance sooner or later.
const LEAST_NOISE: f64 = 1e-9;

fn usable_std(quantity: Quantity, noise_std: f64) -> f64 {
    noise_std.max(LEAST_NOISE * quantity.aspect().info().usual_noise)
}
