//! The settings of the truth, which an equation of motion can be.

use std::fmt;

use crate::equation::{Equation, EquationSettings, RESERVED};
use kalmanscope_filters::catalogue::{KnownChannels, expected_channels};
use kalmanscope_filters::{Channel, InputKind};
use serde::de::{self, Deserializer, MapAccess, Visitor};
use serde::ser::SerializeMap as _;
use serde::{Deserialize, Serialize, Serializer};

use super::Scenario;
use crate::signal::Step;
use crate::{Model, PlantKind, Signal};

/// The plant to identify, with [`PlantKind::parameters`], and the augmentations that have a signal.
#[derive(Clone, Debug)]
pub struct Plant {
    /// The kind of plant.
    pub kind: PlantKind,
    /// The motion of the first mass at t = 0; everything else is at rest.
    pub initial: Motion,
    /// Standard deviation of an unmeasured normal force over mass, held over each step, the same for every mass \[m/s²\].
    pub disturbance_std: f64,
    /// The delay of the input, in samples, from the record to the plant; negative where the record is late.
    pub input_delay: i32,
    pub(super) signals: Vec<(Channel, Signal)>,
}

/// Displacement and velocity of the mass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields, expecting = "a table")]
pub struct Motion {
    /// x \[m\]
    pub displacement: f64,
    /// ẋ \[m/s\]
    pub velocity: f64,
}

impl Plant {
    /// The signal of a channel: a parameter's own or usual one, an augmentation's own, if any. `None` for the motion.
    pub fn parameter(&self, channel: Channel) -> Option<Signal> {
        let set = self.signals.iter().find(|(c, _)| *c == channel).map(|(_, signal)| *signal);
        let usual = || Signal::Constant(channel.usual_truth());
        set.or_else(|| (channel.is_parameter() && !channel.is_augmentation()).then(usual))
    }

    /// The signal of a parameter or an augmentation, to be changed. Without one, it first gets the usual value.
    pub fn parameter_mut(&mut self, channel: Channel) -> Option<&mut Signal> {
        if !channel.is_parameter() {
            return None;
        }
        let place = self.signals.iter().position(|(c, _)| *c == channel).unwrap_or_else(|| {
            self.signals.push((channel, Signal::Constant(channel.usual_truth())));
            self.signals.len() - 1
        });
        Some(&mut self.signals[place].1)
    }

    /// Sets the signal of a parameter or an augmentation; does nothing for a component of the motion.
    pub fn set(&mut self, channel: Channel, signal: impl Into<Signal>) {
        if let Some(parameter) = self.parameter_mut(channel) {
            *parameter = signal.into();
        }
    }

    /// The same plant with another signal for a parameter or an augmentation.
    #[must_use]
    pub fn with(mut self, channel: Channel, signal: impl Into<Signal>) -> Self {
        self.set(channel, signal);
        self
    }

    /// The parameters and augmentations of the truth, in the order of its state.
    pub fn parameters(&self) -> impl Iterator<Item = Channel> {
        let augmentations = self.signals.iter().map(|(channel, _)| *channel).filter(|c| c.is_augmentation());
        self.kind.parameters().chain(augmentations)
    }

    /// The truth as a model under an input.
    pub fn model(&self, input: InputKind) -> Model {
        let augmentations = self.parameters().filter(|c| c.is_augmentation());
        Model::new(self.kind.clone()).augmented(augmentations).driven_by(input)
    }
}

impl PartialEq for Plant {
    fn eq(&self, other: &Self) -> bool {
        let Self { kind, initial, disturbance_std, input_delay, signals } = self;
        let same = |(channel, _): &(Channel, Signal)| self.parameter(*channel) == other.parameter(*channel);
        (kind, initial) == (&other.kind, &other.initial)
            && (disturbance_std, input_delay) == (&other.disturbance_std, &other.input_delay)
            && signals.iter().chain(&other.signals).all(same)
    }
}

impl Default for Plant {
    fn default() -> Self {
        let loss = Signal::Step(Step { from: 6.0, to: 4.8, at: 30.0 });
        Self {
            kind: PlantKind::SDOF,
            initial: Motion::default(),
            disturbance_std: 0.0,
            input_delay: 0,
            signals: vec![(Channel::NATURAL_FREQUENCY, loss)],
        }
    }
}

impl Serialize for Plant {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { kind, initial, disturbance_std, input_delay, signals: _ } = self;
        let mut map = serializer.serialize_map(None)?;
        match kind.own_equation().map(Equation::settings) {
            None => map.serialize_entry("kind", kind)?,
            Some(EquationSettings { equation, parameters }) => {
                // Before the equation, so that it is read once.
                if !parameters.is_empty() {
                    map.serialize_entry("parameters", parameters)?;
                }
                map.serialize_entry("equation", equation)?;
            }
        }
        let unused = Self::default();
        let rest = self.signals.iter().filter(|(c, signal)| unused.parameter(*c) != Some(*signal)).map(|(c, _)| *c);
        let mut written: Vec<Channel> = self.parameters().collect();
        written.extend(rest.filter(|c| !self.parameters().any(|p| p == *c)));
        for channel in written {
            if let Some(signal) = self.parameter(channel) {
                map.serialize_entry(channel.key(), &signal)?;
            }
        }
        map.serialize_entry("initial", initial)?;
        map.serialize_entry("disturbance_std", disturbance_std)?;
        if *input_delay != 0 {
            map.serialize_entry("input_delay", input_delay)?;
        }
        map.end()
    }
}

impl<'de> Deserialize<'de> for Plant {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Table;

        impl<'de> Visitor<'de> for Table {
            type Value = Plant;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Plant, A::Error> {
                let own = |settings: &EquationSettings| PlantKind::of_equation(settings).map_err(de::Error::custom);
                let mut plant = Plant::default();
                let mut equation: Option<EquationSettings> = None;
                while let Some(PlantKey(key)) = map.next_key()? {
                    match key.as_str() {
                        "kind" => plant.kind = map.next_value()?,
                        "equation" => {
                            let known = equation.get_or_insert_with(|| EquationSettings::new(""));
                            known.equation = map.next_value()?;
                            // A fault of the equation goes before that of the keys that it should have.
                            own(known)?;
                        }
                        "parameters" => {
                            equation.get_or_insert_with(|| EquationSettings::new("")).parameters = map.next_value()?;
                        }
                        "initial" => plant.initial = map.next_value()?,
                        "input_delay" => plant.input_delay = map.next_value()?,
                        "disturbance_std" => plant.disturbance_std = map.next_value()?,
                        other => {
                            let signal = map.next_value::<Signal>()?;
                            KnownChannels::channel(other).into_iter().for_each(|channel| plant.set(channel, signal));
                        }
                    }
                }
                match &equation {
                    Some(one) if one.equation.is_empty() => {
                        return Err(de::Error::custom("`parameters` belong to an `equation`, which is missing"));
                    }
                    Some(one) => plant.kind = own(one)?,
                    None => {}
                }
                Ok(plant)
            }
        }

        deserializer.deserialize_map(Table)
    }
}

/// A key of the truth's table. An unknown key fails here, as a key, so that the message names its line.
struct PlantKey(String);

impl<'de> Deserialize<'de> for PlantKey {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let key = String::deserialize(deserializer)?;
        if RESERVED.contains(&key.as_str()) || KnownChannels::channel(&key).is_some_and(Channel::is_parameter) {
            return Ok(Self(key));
        }
        let (own, channels) = (RESERVED.join("`, `"), expected_channels(Channel::is_parameter));
        Err(de::Error::custom(format!("unknown field `{key}`, expected `{own}` or {channels}")))
    }
}

impl Scenario {
    pub(super) fn take_guesses(&mut self, before: &[Channel]) {
        for &channel in self.plant.kind.channels() {
            let Some(old) = before.iter().find(|old| **old == channel).map(|old| old.usual()) else { continue };
            let new = channel.usual();
            for filter in &mut self.filters {
                if old.mean != new.mean {
                    filter.initial_mean[channel] = new.mean;
                }
                if old.std != new.std {
                    filter.initial_std[channel] = new.std;
                }
            }
        }
    }

    /// A sentence about parameters that neither `parameters` nor a value names, with their guesses, if there are some.
    pub fn assumed_parameters(&self) -> Option<String> {
        let settings = self.plant.kind.own_equation()?.settings();
        let signals = &self.plant.signals;
        let is_named = |channel: Channel| {
            settings.parameter(channel.key()).is_some() || signals.iter().any(|(own, _)| *own == channel)
        };
        let symbols = settings.symbols().ok()?;
        let is_own = |channel: &Channel| {
            symbols.iter().any(|one| one.is_parameter && one.known.is_none() && one.key == channel.key())
        };
        let guess = |channel: Channel| {
            let first = self.filters.iter().find(|filter| filter.plant.is_none());
            first.map_or(channel.usual().mean, |filter| filter.initial_mean[channel])
        };
        let assumed = self.plant.kind.parameters().filter(|channel| is_own(channel) && !is_named(*channel));
        let named: Vec<String> =
            assumed.map(|channel| format!("{} (guess {})", channel.symbol(), guess(channel))).collect();
        let (last, others) = named.split_last()?;
        let all = if others.is_empty() { last.clone() } else { format!("{} and {last}", others.join(", ")) };
        let is = if others.is_empty() { "is taken for a parameter" } else { "are taken for parameters" };
        Some(format!("of the equation, {all} {is}: `parameters` can say name, unit, guess and range"))
    }
}
