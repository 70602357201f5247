//! An equation that a user typed, with the meanings of its names.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use kalmanscope_filters::Channel;
use kalmanscope_filters::channel::{ChannelInfo, Role, Usual};

use super::solve::{Solved, StateComponent, solve};
use super::token::{key, symbol};
use super::typed::Typed;
use super::{EquationError, EquationSettings, Numbers, ParameterSettings, size};

/// Keys of a plant's table, which parameters cannot have.
pub(crate) const RESERVED: [&str; 6] = ["kind", "equation", "parameters", "initial", "disturbance_std", "input_delay"];

/// Limits numbers of parameters, so that products of a few of them stay finite.
const LARGEST: f64 = 1e30;

/// An equation that a user typed, as a plant has it.
#[derive(Debug)]
pub struct Equation {
    settings: EquationSettings,
    pub(crate) channels: Vec<Channel>,
    is_linear: bool,
    pub(crate) typed: Arc<Typed>,
}

impl Equation {
    pub(crate) fn new(settings: &EquationSettings) -> Result<Self, EquationError> {
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
