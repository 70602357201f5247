//! The place of a number in a scenario.

use kalmanscope_filters::channel::Channel;
use kalmanscope_filters::quantity::Quantity;

use super::filters::is_of_all;
use super::{Entry, SettingInfo, TABLES, TableInfo, of_filter, of_scenario};
use crate::scenario::{Fault, FilterSettings, Scenario, Sensor};

const PLANT: &str = "plant.";

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Place {
    Scenario(&'static SettingInfo<Scenario>),
    Parameter(Channel),
    /// A number of the signal of a parameter that moves: the key behind that of the parameter.
    Signal(Channel, &'static str),
    Noise(Quantity),
    Fault(Quantity, Fault, usize),
    Filters(Option<u32>, Member),
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Member {
    Number(&'static SettingInfo<FilterSettings>),
    Entry(&'static TableInfo, Entry),
    Factor(&'static TableInfo, Vec<FilterSettings>),
}

impl Place {
    pub(super) fn parse(scenario: &Scenario, text: &str) -> Option<Self> {
        let is_it =
            |info: &&'static SettingInfo<Scenario>| info.key == text && (info.serves)(scenario, &scenario.plant.kind);
        if let Some(info) = of_scenario().find(is_it) {
            return Some(Self::Scenario(info));
        }
        let keys: Vec<&str> = text.split('.').collect();
        match keys[..] {
            ["plant", parameter, ref rest @ ..] => {
                let channel = scenario.plant.parameters().find(|own| own.key() == parameter)?;
                if rest.is_empty() {
                    return Some(Self::Parameter(channel));
                }
                let key = text.strip_prefix(PLANT)?.strip_prefix(parameter)?;
                let numbers = scenario.plant.parameter(channel)?.numbers();
                numbers.into_iter().find(|(own, _)| *own == key).map(|(own, _)| Self::Signal(channel, own))
            }
            ["sensors", sensor, "noise_std"] => Some(Self::Noise(quantity(scenario, sensor)?)),
            ["sensors", sensor, "faults", fault, number] => {
                let (quantity, fault) = (quantity(scenario, sensor)?, Fault::from_key(fault)?);
                let has = scenario.sensors.iter().any(|s| s.measures == quantity && s.faults.numbers(fault).is_some());
                let number = fault.info().numbers.iter().position(|info| info.key == number).filter(|_| has)?;
                Some(Self::Fault(quantity, fault, number))
            }
            _ => Self::of_filters(scenario, text),
        }
    }

    fn of_filters(scenario: &Scenario, text: &str) -> Option<Self> {
        let (places, key) = scenario.filters_at(text)?;
        let meant: Vec<&FilterSettings> = places.iter().filter_map(|&place| scenario.filters.get(place)).collect();
        let first = meant.first()?;
        let id = Some(first.id).filter(|_| !is_of_all(text, key));
        // An id that several filters have would mean another one of them.
        if id.is_some_and(|id| scenario.filters.iter().filter(|filter| filter.id == id).count() > 1) {
            return None;
        }
        let number = of_filter().find(|info| info.key == key);
        let member = if let Some(info) = number {
            Member::Number(info)
        } else if let Some(table) = TableInfo::from_key(key).filter(|table| table.factor.is_some()) {
            Member::Factor(table, meant.into_iter().cloned().collect())
        } else {
            let channel_of = |filter: &FilterSettings, key: &str| {
                let model = filter.model(&scenario.plant.kind, scenario.input);
                model.channels().iter().copied().find(|channel| channel.key() == key)
            };
            let (table, entry) =
                TableInfo::entry(key, &|key| channel_of(first, key), &|sensor| quantity(scenario, sensor))?;
            let has = |filter: &&FilterSettings| match entry {
                Entry::Channel(channel) => channel_of(filter, channel.key()).is_some(),
                Entry::Sensor(_) => true,
            };
            meant[1..].iter().all(has).then_some(Member::Entry(table, entry))?
        };
        Some(Self::Filters(id, member))
    }

    pub(super) fn instead(scenario: &Scenario, text: &str) -> String {
        if scenario.filters_at(text).is_some() {
            let numbers = of_filter().map(|info| info.key);
            let keys = listed(numbers.chain(TABLES.map(|table| table.key)));
            let count = TABLES.len();
            return format!("; a filter has {keys}, and in the last {count} a number for each channel or sensor");
        }
        if text.starts_with("filters") {
            return scenario.filters_instead_of(text);
        }
        let serving = of_scenario().filter(|info| (info.serves)(scenario, &scenario.plant.kind));
        let (of_plant, others): (Vec<&str>, Vec<&str>) =
            serving.map(|info| info.key).partition(|key| key.starts_with(PLANT));
        if text.starts_with(PLANT) {
            let parameters = scenario.plant.parameters().map(Channel::key);
            let keys = listed(parameters.chain(of_plant.into_iter().map(|key| &key[PLANT.len()..])));
            return format!("; its plant has {keys}");
        }
        if text.starts_with("sensors") {
            return match &scenario.sensors[..] {
                [] => "; it has no sensor".to_owned(),
                sensors => {
                    let keys = listed(sensors.iter().map(|sensor| sensor.measures.key()));
                    format!("; a sensor has `noise_std` and numbers of its `faults`, and its sensors are {keys}")
                }
            };
        }
        format!("; it has {}, and numbers of its `plant`, `sensors` and `filters`", listed(others.into_iter()))
    }
}

fn listed<'a>(keys: impl Iterator<Item = &'a str>) -> String {
    keys.map(|key| format!("`{key}`")).collect::<Vec<_>>().join(", ")
}

fn quantity(scenario: &Scenario, sensor: &str) -> Option<Quantity> {
    let sensors = &scenario.sensors;
    match Quantity::from_key(sensor) {
        Some(quantity) => sensors.iter().any(|sensor| sensor.measures == quantity).then_some(quantity),
        None => sensors.get(sensor.parse::<usize>().ok()?).map(|sensor| sensor.measures),
    }
}

impl Member {
    pub(super) fn get(&self, filter: &FilterSettings, sensors: &[Sensor]) -> Option<f64> {
        match self {
            Self::Number(info) => Some((info.get)(filter)),
            Self::Entry(table, entry) => table.get(filter, *entry, sensors),
            Self::Factor(table, bases) => bases.first().map(|base| table.factor_over(base, filter)),
        }
    }

    pub(super) fn set(&self, filter: &mut FilterSettings, nth: usize, value: f64, sensors: &[Sensor]) {
        match self {
            Self::Number(info) => (info.set)(filter, value),
            Self::Entry(table, entry) => {
                if let Some(number) = table.get_mut(filter, *entry, sensors) {
                    *number = value;
                }
            }
            Self::Factor(table, bases) => {
                if let Some(base) = bases.get(nth) {
                    table.scale(base, filter, value);
                }
            }
        }
    }

    pub(super) fn overlaps(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Number(one), Self::Number(other)) => one == other,
            (Self::Entry(table, entry), Self::Entry(other, of)) => table == other && entry == of,
            (Self::Factor(table, _), Self::Entry(other, _) | Self::Factor(other, _))
            | (Self::Entry(table, _), Self::Factor(other, _)) => table == other,
            _ => false,
        }
    }
}
