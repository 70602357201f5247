//! The settings of a run.

pub mod cost;
pub(crate) mod fault;
pub(crate) mod filter;
mod identity;
pub(crate) mod numbers;
pub mod option;
mod plant;
mod population;
pub(crate) mod row;
pub(crate) mod table;
mod true_noise;
mod validate;
mod values;

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::document::is_default;
use kalmanscope_filters::catalogue::KnownChannels;
use kalmanscope_filters::filter::FilterKind;
use kalmanscope_filters::lists::mapped;
use kalmanscope_filters::{Channel, ForcedMass, Hold, InputKind, Quantity};
use kalmanscope_records::mapping::Mapping;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::{Force, PlantKind};

pub use fault::{Fault, FaultInfo, FaultNumber, Faults, Scale};
pub use filter::{FilterColor, FilterSettings};
pub(crate) use identity::{ALL, SMOOTHED, clash};
pub use identity::{is_text, shown};
pub use kalmanscope_filters::quantity::MAX_SENSORS;
pub use plant::{Motion, Plant};
pub(crate) use population::short;
pub use population::{Law, LawInfo};
pub use validate::ScenarioError;
pub use values::{Between, Bounds, Values};

use true_noise::usable_std;

/// A truth, its sensors and the filters that estimate it: plain data, stored as TOML.
///
/// A missing key has a default, an unknown key is an error. A run depends on these settings only.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self", default, deny_unknown_fields, expecting = "a table")]
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
    /// Measured forces over mass on single masses besides the input, by `force_on_1`, `force_on_2`, ….
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub forces: BTreeMap<ForcedMass, Force>,
    /// The kind of input.
    #[serde(skip_serializing_if = "is_default")]
    pub input: InputKind,
    /// The hold of the input between samples.
    #[serde(skip_serializing_if = "is_default")]
    pub hold: Hold,
    /// The sensors, at most one per quantity.
    pub sensors: Vec<Sensor>,
    /// The filters.
    #[serde(default = "default_filters")]
    pub filters: Vec<FilterSettings>,
    /// The measured record in place of a simulated one; who runs the scenario reads it ([`kalmanscope_records::import`]).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub record: Option<Mapping>,
    /// The laws of numbers that are drawn for each member of a population, by their addresses: [`Self::member`].
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub draw: BTreeMap<String, Law>,
}

/// A sensor and its true noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub struct Sensor {
    /// The quantity that it measures.
    pub measures: Quantity,
    /// Standard deviation of its white normal noise, in the quantity's unit.
    pub noise_std: f64,
    /// The faults of its readings besides noise.
    #[serde(default, skip_serializing_if = "is_default")]
    pub faults: Faults,
}

impl Sensor {
    /// A sensor with white normal noise of a standard deviation, in the quantity's unit.
    pub const fn new(measures: Quantity, noise_std: f64) -> Self {
        Self { measures, noise_std, faults: Faults::NONE }
    }
}

impl Serialize for Scenario {
    /// Leaves out numbers of channels that no plant here has, such as those of an earlier equation: no reader could know their keys.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let is_known = |channel: Channel| self.channel(channel.key()).is_some();
        let values = self.filters.iter().flat_map(|one| [&one.initial_mean, &one.initial_std, &one.process_std]);
        let signals = self.plant.signals.iter().map(|(channel, _)| *channel);
        if values.flat_map(Values::iter).map(|(channel, _)| channel).chain(signals).all(is_known) {
            return Self::serialize(self, serializer);
        }
        let mut written = self.clone();
        written.plant.signals.retain(|(channel, _)| is_known(*channel));
        for one in &mut written.filters {
            for values in [&mut one.initial_mean, &mut one.initial_std, &mut one.process_std] {
                values.set.retain(|(channel, _)| is_known(*channel));
            }
        }
        Self::serialize(&written, serializer)
    }
}

impl<'de> Deserialize<'de> for Scenario {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::deserialize(deserializer)
    }
}

impl From<&Scenario> for Arc<Scenario> {
    fn from(scenario: &Scenario) -> Self {
        Self::new(scenario.clone())
    }
}

impl Default for Scenario {
    fn default() -> Self {
        let mut scenario = Self {
            seed: 1,
            dt: 0.01,
            duration: 60.0,
            plant: Plant::default(),
            force: Force::default(),
            forces: BTreeMap::new(),
            input: InputKind::default(),
            hold: Hold::default(),
            sensors: vec![Sensor::new(Quantity::DISPLACEMENT, 0.01), Sensor::new(Quantity::VELOCITY, 0.06)],
            filters: default_filters(),
            record: None,
            draw: BTreeMap::new(),
        };
        scenario.fill_in();
        scenario
    }
}

impl Scenario {
    /// The number of samples, including the one at t = 0.
    pub fn samples(&self) -> usize {
        libm::round(self.duration / self.dt) as usize + 1
    }

    /// Adds a sensor, unless its quantity is already measured. Every filter assumes its true noise.
    pub fn add_sensor(&mut self, sensor: Sensor) {
        if self.sensors.iter().any(|s| s.measures == sensor.measures) {
            return;
        }
        let place = self.sensors.partition_point(|s| s.measures < sensor.measures);
        self.sensors.insert(place, sensor);
        for filter in &mut self.filters {
            filter.sensor_std.insert(place.min(filter.sensor_std.len()), usable_std(sensor.measures, sensor.noise_std));
            if place <= filter.sensor_delay.len() && !filter.sensor_delay.is_empty() {
                filter.sensor_delay.insert(place, 0.0);
            }
        }
    }

    /// Has sensors for these quantities alone, each with its usual noise, which every filter assumes.
    pub fn set_sensors(&mut self, quantities: &[Quantity]) {
        self.sensors.clear();
        for filter in &mut self.filters {
            filter.sensor_std.clear();
            filter.sensor_delay.clear();
        }
        for &measures in quantities {
            self.add_sensor(Sensor::new(measures, measures.aspect().info().usual_noise));
        }
    }

    /// The channel with a key: one of the truth's plant, of a filter's, or of [`Channel::all`].
    pub fn channel(&self, key: &str) -> Option<Channel> {
        self.channels_of_plants().find(|channel| channel.key() == key).or_else(|| Channel::from_key(key))
    }

    /// Reads something in which keys can be those of this scenario's channels.
    pub fn knowing<T>(&self, read: impl FnOnce() -> T) -> T {
        let _known = KnownChannels::new(self.channels_of_plants());
        read()
    }

    fn channels_of_plants(&self) -> impl DoubleEndedIterator<Item = Channel> {
        let of_filters = self.filters.iter().filter_map(|filter| filter.plant.as_ref());
        std::iter::once(&self.plant.kind).chain(of_filters).flat_map(PlantKind::channels).copied()
    }

    /// The masses on which forces are recorded besides the input: those of the record if there is one, else those of the simulation.
    pub fn forced(&self) -> Vec<ForcedMass> {
        match &self.record {
            Some(mapping) => mapping.forces.keys().copied().collect(),
            None => self.forces.keys().copied().collect(),
        }
    }

    /// The same scenario whose input is the simulated force on one mass, so that [settings of the force](crate::setting::FORCE) are its.
    #[must_use]
    pub fn with_force_of(&self, mass: ForcedMass) -> Option<Self> {
        Some(Self { force: *self.forces.get(&mass)?, ..self.clone() })
    }

    /// The quantity of each sensor.
    pub fn measured(&self) -> Vec<Quantity> {
        mapped(&self.sensors, &|sensor| sensor.measures)
    }

    /// The place of the sensor of a quantity.
    pub fn sensor_place(&self, quantity: Quantity) -> Option<usize> {
        self.sensors.iter().position(|sensor| sensor.measures == quantity)
    }

    /// Removes the sensor of a quantity, also from the filters.
    pub fn remove_sensor(&mut self, quantity: Quantity) {
        while let Some(place) = self.sensor_place(quantity) {
            self.sensors.remove(place);
            for list in self.filters.iter_mut().flat_map(|filter| [&mut filter.sensor_std, &mut filter.sensor_delay]) {
                if place < list.len() {
                    list.remove(place);
                }
            }
        }
    }

    /// Changes the truth's kind of plant and removes the sensors of quantities that it lacks. Filters get the guesses of an equation.
    pub fn set_plant(&mut self, kind: PlantKind) {
        for quantity in self.sensors.iter().map(|s| s.measures).filter(|q| !kind.has(*q)).collect::<Vec<_>>() {
            self.remove_sensor(quantity);
        }
        let before = std::mem::replace(&mut self.plant.kind, kind);
        self.take_guesses(before.channels());
        self.fill_in();
    }

    pub(crate) fn fill_in(&mut self) {
        self.number_filters();
        self.name_filters();
        let Self { sensors, filters, plant, input, .. } = self;
        for filter in filters {
            let model = filter.model(&plant.kind, *input);
            for values in [&mut filter.initial_mean, &mut filter.initial_std, &mut filter.process_std] {
                values.complete(model.channels());
            }
            if filter.sensor_std.is_empty() {
                filter.sensor_std = mapped(sensors, &|s| usable_std(s.measures, s.noise_std));
            }
        }
    }
}

fn default_filters() -> Vec<FilterSettings> {
    let fading = |kind: FilterKind| FilterSettings { kind, fading: 1.005, ..FilterSettings::default() };
    vec![fading(FilterKind::EKF), fading(FilterKind::UKF)]
}
