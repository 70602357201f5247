//! The plant of an equation, and the meanings of its names.

use super::EquationError;
use super::settings::{EquationSettings, Numbers, ParameterSettings, size};
use super::solve::{Component, Solved, solve};
use super::word::{key, symbol};
use crate::mathematics::channel::{ChannelInfo, Role, Usual};
use crate::mathematics::engine::plants::Typed;
use crate::mathematics::plant::{Plant, PlantInfo, Spring};
use crate::{Channel, PlantKind};

/// Keys of a plant's table, which parameters cannot have.
const RESERVED: [&str; 6] = ["kind", "initial", "disturbance_std", "input_delay", "equation", "parameters"];

/// Limits numbers of parameters, so that products of a few of them stay finite.
const LARGEST: f64 = 1e30;

/// The plant of an equation that a user typed.
#[derive(Debug)]
pub struct Equation {
    info: PlantInfo,
    settings: EquationSettings,
    pub(crate) typed: Typed,
}

impl Equation {
    /// The plant of an equation. Its data stay for as long as the program runs.
    pub(super) fn new(settings: &EquationSettings) -> Result<Self, EquationError> {
        let Solved { components, typed, is_linear } = solve(&settings.equation)?;
        let known: Vec<(String, &ParameterSettings)> =
            settings.parameters.iter().map(|(name, one)| (key(name), one)).collect();
        for (name, _) in &known {
            let is_it =
                |one: &Component| matches!(one, Component::Internal(key) | Component::Parameter(key) if key == name);
            if !components.iter().any(is_it) {
                return Err(EquationError::new(format!("the equation has no parameter `{name}`")));
            }
        }
        let channels = components.iter().map(|one| channel(one, &known)).collect::<Result<Vec<_>, _>>()?;
        let text: &'static str = settings.equation.clone().leak();
        let info = PlantInfo {
            key: text,
            name: "equation of your own",
            equation: text,
            reference: "",
            channels: channels.leak(),
            is_linear,
            spring: Spring::Linear,
        };
        Ok(Self { info, settings: settings.clone(), typed })
    }

    /// The equation's settings, as in a scenario.
    pub fn settings(&self) -> &EquationSettings {
        &self.settings
    }

    pub(crate) fn is_linear(&self) -> bool {
        self.info.is_linear
    }

    /// The numbers of operations for the rates, and for their derivatives.
    pub fn operations(&self) -> [usize; 2] {
        [self.typed.rates.operations(), self.typed.jacobian.operations()]
    }
}

impl Plant for Equation {
    fn info(&self) -> &PlantInfo {
        &self.info
    }

    fn motion_rate(&self, state: &[f64], force: f64, rate: &mut [f64]) {
        self.typed.rates.run(state, force, |place, value| rate[place] = value);
    }

    fn motion_jacobian(&self, state: &[f64], jacobian: &mut [f64]) {
        // The force enters additively.
        let Typed { size, motion, jacobian: list, .. } = &self.typed;
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
    let mut channels = PlantKind::ALL.iter().flat_map(|kind| kind.channels().iter().copied());
    channels.find(|channel| channel.key() == as_key(name))
}

fn channel(component: &Component, known: &[(String, &ParameterSettings)]) -> Result<Channel, EquationError> {
    let (name, is_parameter) = match component {
        Component::Displacement(mass) => return Ok(Channel::displacement(*mass)),
        Component::Velocity(mass) => return Ok(Channel::velocity(*mass)),
        Component::Internal(name) => (name, false),
        Component::Parameter(name) => (name, true),
    };
    let settings = known.iter().find(|(key, _)| key == name).map(|(_, settings)| *settings);
    let as_key = as_key(name);
    if RESERVED.contains(&as_key) {
        return Err(EquationError::new(format!("`{name}` cannot be a name: a plant has a setting that is called so")));
    }
    if let Some(channel) = of_all_plants(name) {
        if channel.is_parameter() != is_parameter {
            return Err(EquationError::new(format!("`{name}` means the {} already", channel.name())));
        }
        if settings.is_some() {
            let what = format!("`{name}` is the {} of all plants, and has its numbers from there", channel.name());
            return Err(EquationError::new(what));
        }
        return Ok(channel);
    }
    if crate::mathematics::channel::augment::all().any(|channel| channel.key() == as_key) {
        return Err(EquationError::new(format!("`{name}` cannot be a name: an augmentation is called so")));
    }
    let usual = ParameterSettings::default();
    Ok(Channel::new(Box::leak(Box::new(info(name, is_parameter, settings.unwrap_or(&usual))?))))
}

fn info(name: &str, is_parameter: bool, settings: &ParameterSettings) -> Result<ChannelInfo, EquationError> {
    let Numbers { mean, std, range: [low, high] } = settings.numbers(is_parameter);
    let (size, sign) = (size(mean), settings.sign.into());
    let numbers = [mean, std, low, high];
    if !numbers.iter().all(|number| number.abs() <= LARGEST) || std < 0.0 || low >= high {
        return Err(EquationError::new(format!(
            "the numbers of `{name}` are impossible: a guess and a range from below to above are finite, std is at least 0"
        )));
    }
    let shown: &'static str = symbol(name).leak();
    let texts = |text: String| -> &'static [&'static str] { vec![&*text.leak()].leak() };
    let unsafe_text = |text: &str| text.chars().any(char::is_control) || text.chars().count() > 40;
    if settings.name.as_deref().is_some_and(unsafe_text) || unsafe_text(&settings.unit) {
        return Err(EquationError::new(format!(
            "the name and the unit of `{name}` have at most 40 characters, none of control"
        )));
    }
    let decimals = (2.0 - libm::floor(libm::log10(size))).clamp(0.0, 8.0);
    Ok(ChannelInfo {
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
    })
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
        let of = |component| {
            let (key, is_parameter) = match component {
                Component::Internal(key) => (key, false),
                Component::Parameter(key) => (key, true),
                Component::Displacement(_) | Component::Velocity(_) => return None,
            };
            Some(Symbol { shown: symbol(&key), known: of_all_plants(&key), key, is_parameter })
        };
        Ok(solve(&self.equation)?.components.into_iter().filter_map(of).collect())
    }
}
