//! The settings that are one of several words: one row each.

use kalmanscope_filters::filter::Robust;
use kalmanscope_filters::{Hold, InputKind, Propagation};
use toml::Value;

use super::Edit;
use crate::scenario::row::by_key;
use crate::scenario::{FilterSettings, Scenario, option};
use crate::signal::Force;

/// A choice of a `T`: a scenario or the settings of a filter.
pub struct ChoiceInfo<T> {
    /// The key in scenario files and addresses.
    pub key: &'static str,
    /// The name in running text.
    pub name: &'static str,
    /// The text beside its control.
    pub label: &'static str,
    /// An explanation in one sentence.
    pub hint: &'static str,
    /// The options, in the order of a menu.
    pub options: fn() -> Vec<Choice>,
    /// The value of the option at a place in scenario files.
    pub value: fn(usize) -> Value,
    /// Whether it has an effect in a `T`.
    pub serves: fn(&T) -> bool,
    /// The place of the chosen option.
    pub get: fn(&T) -> usize,
}

/// One option of a choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Choice {
    /// Its name in running text.
    pub name: &'static str,
    /// Its effect in a few words; empty for none.
    pub hint: &'static str,
}

fn named<const N: usize>(names: [&'static str; N]) -> Vec<Choice> {
    names.map(|name| Choice { name, hint: "" }).into()
}

fn word(words: &[&str], at: usize) -> Value {
    words.get(at).copied().unwrap_or_default().into()
}

impl<T> ChoiceInfo<T> {
    /// The option that is chosen.
    pub fn chosen(&self, of: &T) -> Option<Choice> {
        (self.options)().into_iter().nth((self.get)(of))
    }

    pub(super) fn name_of(&self, value: &Value) -> Option<&'static str> {
        let mut options = (self.options)().into_iter().enumerate();
        options.find(|(place, _)| (self.value)(*place) == *value).map(|(_, option)| option.name)
    }
}

by_key!(ChoiceInfo, T);

static INPUT: ChoiceInfo<Scenario> = ChoiceInfo {
    key: "input",
    name: "kind of input",
    label: "the input is a",
    hint: "The input that is recorded: a force over mass, or the acceleration of the ground under the oscillator",
    options: || named(["force over mass", "ground acceleration"]),
    value: |at| word(&["force", "ground_acceleration"], at),
    serves: |_| true,
    get: |scenario| usize::from(scenario.input == InputKind::GroundAcceleration),
};

static HOLD: ChoiceInfo<Scenario> = ChoiceInfo {
    key: "hold",
    name: "input between samples",
    label: "between samples it is",
    hint: "Between samples the input keeps its value (zero-order hold) or is linear (first-order hold)",
    options: || named(["held", "linear"]),
    value: |at| word(&["zero", "first"], at),
    serves: |_| true,
    get: |scenario| usize::from(scenario.hold == Hold::First),
};

const SHAPES: [(&str, Force); 6] = [
    ("white noise", Force::WhiteNoise { std: 10.0 }),
    ("sine", Force::Sine { amplitude: 5.0, frequency: 6.0 }),
    ("chirp", Force::Chirp { amplitude: 8.0, from: 1.0, to: 20.0, sweep: 20.0 }),
    ("hammer blows", Force::ImpulseTrain { impulse: 1.0, period: 5.0 }),
    ("step", Force::Step { amplitude: 5.0, at: 1.0 }),
    ("none", Force::None),
];

static SHAPE: ChoiceInfo<Scenario> = ChoiceInfo {
    key: "force",
    name: "force over time",
    label: "over time",
    hint: "The shape of the force; the filters know it exactly",
    options: || named(SHAPES.map(|(name, _)| name)),
    value: |at| SHAPES.get(at).and_then(|(_, force)| Value::try_from(force).ok()).unwrap_or_else(|| word(&[], at)),
    serves: |_| true,
    get: |scenario| {
        let same =
            |(_, shape): &(&str, Force)| std::mem::discriminant(shape) == std::mem::discriminant(&scenario.force);
        SHAPES.iter().position(same).unwrap_or(0)
    },
};

static PROPAGATION: ChoiceInfo<FilterSettings> = ChoiceInfo {
    key: "propagation",
    name: "steps",
    label: "integration",
    hint: "How the mean moves from sample to sample; automatic is local linearisation where it is exact, on a linear plant, and \
           Runge-Kutta on others",
    options: || named(["automatic", "local linearisation", "Runge-Kutta", "Euler"]),
    value: |at| word(&["automatic", "local_linearisation", "runge_kutta", "euler"], at),
    serves: |filter| filter.kind.info().has_propagation,
    get: |filter| Propagation::ALL.iter().position(|way| Some(*way) == filter.propagation).map_or(0, |at| at + 1),
};

/// How readings that do not fit are weighed.
pub static ROBUST: ChoiceInfo<FilterSettings> = ChoiceInfo {
    key: "robust",
    name: "outliers",
    label: "outliers",
    hint: "How readings that do not fit are weighed",
    options: || {
        let option = |rule: Robust| Choice { name: rule.info().name, hint: rule.info().description };
        Robust::ALL.map(option).into()
    },
    value: |at| word(&Robust::ALL.map(|rule| rule.info().key), at),
    serves: |filter| filter.can(&option::WEIGHED),
    get: |filter| Robust::ALL.iter().position(|rule| *rule == filter.robust).unwrap_or(0),
};

/// The choices of a scenario besides its filters.
pub static CHOICES_OF_SCENARIO: [&ChoiceInfo<Scenario>; 3] = [&INPUT, &HOLD, &SHAPE];

/// The choices of a filter.
pub static CHOICES_OF_FILTER: [&ChoiceInfo<FilterSettings>; 2] = [&PROPAGATION, &ROBUST];

/// Every option that a scenario could have in place of its own, as an edit.
pub fn other_choices(scenario: &Scenario) -> Vec<Edit> {
    fn others<T>(info: &ChoiceInfo<T>, of: &T, key: &str) -> Vec<Edit> {
        let own = (info.get)(of);
        let others = (0..(info.options)().len()).filter(|place| *place != own && (info.serves)(of));
        others.map(|place| Edit::new(key, (info.value)(place))).collect()
    }
    let of_filters = scenario.filters.iter().flat_map(|filter| {
        CHOICES_OF_FILTER.into_iter().flat_map(|info| others(info, filter, &filter.address(info.key)))
    });
    let of_scenario = CHOICES_OF_SCENARIO.into_iter().flat_map(|info| others(info, scenario, info.key));
    of_filters.chain(of_scenario).collect()
}
