//! The plant of an equation, and the meanings of its names. In files a plant is the key of a built-in one, or a table with an equation.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

use super::solve::{Solved, StateComponent, solve};
use super::token::{key, symbol};
use super::{EquationError, EquationSettings, Numbers, ParameterSettings, size};
use crate::catalogue::KnownPlants;
use crate::channel::{ChannelInfo, Role, Usual};
use crate::engine::plants::Typed;
use crate::plant::{Plant, PlantInfo, Spring};
use crate::{Channel, PlantKind};

/// Keys of a plant's table, which parameters cannot have.
const RESERVED: [&str; 6] = ["kind", "initial", "disturbance_std", "input_delay", "equation", "parameters"];

/// Limits numbers of parameters, so that products of a few of them stay finite.
const LARGEST: f64 = 1e30;

/// The plant of an equation that a user typed.
#[derive(Debug)]
pub struct Equation {
    settings: EquationSettings,
    channels: Vec<Channel>,
    is_linear: bool,
    pub(crate) typed: Arc<Typed>,
}

impl Equation {
    pub(super) fn new(settings: &EquationSettings) -> Result<Self, EquationError> {
        let Solved { components, typed, is_linear } = solve(&settings.equation)?;
        let known: Vec<(String, &ParameterSettings)> =
            settings.parameters.iter().map(|(name, one)| (key(name), one)).collect();
        for (name, _) in &known {
            if name != "x" && !components.iter().any(|one| one.key() == Some(name)) {
                return Err(EquationError::new(format!("the equation has no parameter `{name}`")));
            }
        }
        let channels = components.iter().map(|one| channel(one, &known)).collect::<Result<Vec<_>, _>>()?;
        Ok(Self { settings: settings.clone(), channels, is_linear, typed: Arc::new(typed) })
    }

    /// The equation's settings, as in a scenario.
    pub fn settings(&self) -> &EquationSettings {
        &self.settings
    }

    /// Whether the motion is linear as long as the parameters are constant.
    pub fn is_linear(&self) -> bool {
        self.is_linear
    }

    /// The numbers of operations for the rates, and for their derivatives.
    pub fn operations(&self) -> [usize; 2] {
        [self.typed.rates.operations(), self.typed.jacobian.operations()]
    }
}

impl Plant for Equation {
    fn info(&self) -> PlantInfo<'_> {
        let text = &self.settings.equation;
        PlantInfo {
            key: text,
            name: "equation of your own",
            equation: text,
            reference: "",
            channels: &self.channels,
            is_linear: self.is_linear,
            spring: Spring::Linear,
        }
    }

    fn motion_rate(&self, state: &[f64], force: f64, rate: &mut [f64]) {
        self.typed.rates.run(state, force, |place, value| rate[place] = value);
    }

    fn motion_jacobian(&self, state: &[f64], jacobian: &mut [f64]) {
        // The force enters additively.
        let Typed { size, motion, jacobian: list, .. } = &*self.typed;
        list.run(state, 0.0, |place, value| jacobian[place % motion * size + place / motion] = value);
    }
}

fn as_key(name: &str) -> &str {
    match name {
        "omega_n" => "natural_frequency",
        "zeta" => "damping_ratio",
        other => other,
    }
}

fn of_all_plants(name: &str) -> Option<Channel> {
    Channel::from_key(as_key(name)).filter(|channel| !channel.is_augmentation())
}

fn channel(component: &StateComponent, known: &[(String, &ParameterSettings)]) -> Result<Channel, EquationError> {
    let (name, is_parameter) = match component {
        StateComponent::Displacement(mass) => return Ok(Channel::displacement(*mass)),
        StateComponent::Velocity(mass) => return Ok(Channel::velocity(*mass)),
        StateComponent::Internal(name) => (name, false),
        StateComponent::Parameter(name) => (name, true),
    };
    let settings = known.iter().find(|(key, _)| key == name).map(|(_, settings)| *settings);
    let as_key = as_key(name);
    if RESERVED.contains(&as_key) {
        return Err(EquationError::new(format!("`{name}` cannot be a name: a plant has a setting of that name")));
    }
    if let Some(channel) = of_all_plants(name) {
        if channel.is_parameter() != is_parameter {
            return Err(EquationError::new(format!("`{name}` already means the {}", channel.name())));
        }
        if settings.is_some() {
            let what = format!("`{name}` is the {} of all plants, and has its numbers from there", channel.name());
            return Err(EquationError::new(what));
        }
        return Ok(channel);
    }
    if Channel::from_key(as_key).is_some() {
        return Err(EquationError::new(format!("`{name}` cannot be a name: an augmentation has that name")));
    }
    let usual = ParameterSettings::default();
    Ok(Channel::new(info(name, is_parameter, settings.unwrap_or(&usual))?))
}

/// Equal names are kept once, a few hundred bytes each, and never freed: a [`Channel`] is copied in thousands of places.
static INFOS: Mutex<BTreeMap<String, &'static ChannelInfo>> = Mutex::new(BTreeMap::new());

fn info(name: &str, is_parameter: bool, settings: &ParameterSettings) -> Result<&'static ChannelInfo, EquationError> {
    let Numbers { mean, std, range: [low, high] } = settings.numbers(is_parameter);
    let (size, sign) = (size(mean), settings.sign);
    let numbers = [mean, std, low, high];
    if !numbers.iter().all(|number| number.abs() <= LARGEST) || std < 0.0 || low >= high {
        return Err(EquationError::new(format!(
            "the numbers of `{name}` are impossible: guess and range are finite, the range rises, std is at least 0"
        )));
    }
    let unsafe_text = |text: &str| text.chars().any(char::is_control) || text.chars().count() > 40;
    if settings.name.as_deref().is_some_and(unsafe_text) || unsafe_text(&settings.unit) {
        return Err(EquationError::new(format!(
            "the name and the unit of `{name}` have at most 40 characters, and no control characters"
        )));
    }
    let mut infos = INFOS.lock().unwrap_or_else(PoisonError::into_inner);
    let content = format!("{:?}", (name, is_parameter, &settings.name, &settings.unit, sign, numbers));
    if let Some(info) = infos.get(&content) {
        return Ok(info);
    }
    let shown: &'static str = symbol(name).leak();
    let texts = |text: String| -> &'static [&'static str] { vec![&*text.leak()].leak() };
    let decimals = (2.0 - libm::floor(libm::log10(size))).clamp(0.0, 8.0);
    let info: &'static ChannelInfo = Box::leak(Box::new(ChannelInfo {
        keys: texts(name.to_owned()),
        names: texts(settings.name.clone().unwrap_or_else(|| {
            let what = if is_parameter { "parameter" } else { "internal state" };
            format!("{what} {shown}")
        })),
        symbols: vec![shown].leak(),
        unit: settings.unit.clone().leak(),
        role: if is_parameter { Role::Parameter(sign) } else { Role::Motion },
        rate: None,
        mirrored: false,
        usual: Usual {
            mean,
            std,
            process: if is_parameter { 1e-5 * size } else { 1e-4 * size },
            truth: if is_parameter { vec![mean].leak() } else { &[] },
            slider: (low, high),
            decimals: decimals as usize,
        },
    }));
    infos.insert(content, info);
    Ok(info)
}

/// A name of an equation that is neither a displacement nor the force.
#[derive(Clone, Debug, PartialEq)]
pub struct Symbol {
    /// The key in files.
    pub key: String,
    /// The name as it is shown.
    pub shown: String,
    /// Whether it is a parameter; an internal state if not.
    pub is_parameter: bool,
    /// The channel of built-in plants that it means; its numbers are those of all plants.
    pub known: Option<Channel>,
}

impl EquationSettings {
    /// The internal states and the parameters of the equation, in the order of its state.
    ///
    /// # Errors
    /// [`EquationError`] where the text is no equation.
    pub fn symbols(&self) -> Result<Vec<Symbol>, EquationError> {
        let of = |component: &StateComponent| {
            let key = component.key()?.clone();
            let is_parameter = matches!(component, StateComponent::Parameter(_));
            Some(Symbol { shown: symbol(&key), known: of_all_plants(&key), key, is_parameter })
        };
        Ok(solve(&self.equation)?.components.iter().filter_map(of).collect())
    }
}

impl PlantKind {
    /// The plant of an equation that a user typed.
    ///
    /// # Errors
    /// [`EquationError`] if it is not an equation, with the character and what is allowed there.
    pub fn of_equation(settings: &EquationSettings) -> Result<Self, EquationError> {
        let is_it = |kind: &Self| kind.own_equation().is_some_and(|own| own.settings() == settings);
        match KnownPlants::find(is_it) {
            Some(kind) => Ok(kind),
            None => Ok(Self::shared(Arc::new(Equation::new(settings)?))),
        }
    }

    /// The equation of a plant that a user typed. `None` for a built-in plant.
    pub fn own_equation(&self) -> Option<&Equation> {
        let plant: &dyn std::any::Any = self.plant();
        plant.downcast_ref()
    }
}

impl PartialEq for PlantKind {
    /// Compares key and type: your own plant differs from the registry's plant with the same key.
    fn eq(&self, other: &Self) -> bool {
        let [own, others] = [self, other].map(|kind| kind.own_equation().map(Equation::settings));
        self.key() == other.key() && self.type_id() == other.type_id() && own == others
    }
}

impl Eq for PlantKind {}

impl Serialize for PlantKind {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.own_equation() {
            Some(equation) => equation.settings().serialize(serializer),
            None => serializer.serialize_str(self.key()),
        }
    }
}

impl<'de> Deserialize<'de> for PlantKind {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct KindVisitor;

        impl<'de> Visitor<'de> for KindVisitor {
            type Value = PlantKind;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("the key of a plant, or a table with an equation")
            }

            fn visit_str<E: de::Error>(self, key: &str) -> Result<PlantKind, E> {
                static ALL: LazyLock<Vec<PlantKind>> = LazyLock::new(|| PlantKind::ALL.into());
                static KEYS: LazyLock<Vec<&str>> = LazyLock::new(|| ALL.iter().map(PlantKind::key).collect());
                PlantKind::from_key(key).ok_or_else(|| de::Error::unknown_variant(key, &KEYS))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<PlantKind, A::Error> {
                let settings = EquationSettings::deserialize(MapAccessDeserializer::new(map))?;
                PlantKind::of_equation(&settings).map_err(de::Error::custom)
            }
        }

        deserializer.deserialize_any(KindVisitor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_equations_are_read_and_each_is_freed_with_its_last_plant() {
        let read = |guess: f64| {
            let mut settings = EquationSettings::new("x'' + k x = f");
            settings.parameter_mut("k").guess = Some(guess);
            PlantKind::of_equation(&settings).expect("it is an equation")
        };
        for guess in (0..10_000).map(f64::from) {
            let (kind, same) = (read(guess), read(guess));
            let typed = Arc::downgrade(&kind.own_equation().expect("it has one").typed);
            let other = kind.clone();
            drop(kind);
            assert_eq!((typed.strong_count(), other.channels()[2].usual().mean), (1, guess));
            assert!(other == same && std::ptr::eq(other.channels()[2].info(), same.channels()[2].info()));
            drop(other);
            assert!(typed.upgrade().is_none());
        }
    }
}
