//! The address of a number in a scenario, and the list of all of them.

use std::fmt;

use kalmanscope_filters::{Channel, Quantity};
use thiserror::Error;

use super::place::{Member, Place};
use super::{CHOICES_OF_FILTER, Entry, SettingInfo, TABLES, TableInfo, filters, of_filter, of_scenario};
use crate::scenario::{FilterSettings, Scenario, Sensor};
use crate::signal::Signal;

/// The address of a number of a scenario, or of a factor on several of them.
///
/// In text it is `seed`, `plant.natural_frequency`, `plant.natural_frequency.step.at`, `sensors.velocity.noise_std` or `filters.EKF.initial_mean.natural_frequency`. A
/// filter is found by its name, or by its id as in `filters#1.fading`, which is how an address is written; `*` stands for all
/// filters. A whole table of standard deviations, such as `filters.EKF.process_std`, stands for a factor on each of its numbers.
///
/// ```
/// use kalmanscope_core::{Scenario, setting::Address};
///
/// let mut scenario = Scenario::default();
/// let address = Address::parse(&scenario, "filters.UKF.fading").unwrap();
/// address.set(&mut scenario, 1.02);
/// assert_eq!((address.get(&scenario), address.to_string()), (1.02, "filters#2.fading".to_owned()));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Address {
    place: Place,
    /// The text as it is written, by the id of a filter.
    pub key: String,
    /// The name without that of a filter, short enough for an axis.
    pub name: String,
    /// The unit, empty for a pure number.
    pub unit: &'static str,
    /// Whether the number has no fractions, as a seed has none.
    pub is_whole: bool,
    /// Whether it is a standard deviation, or a factor on some.
    pub is_std: bool,
    /// The channel that the number is of, if it is of one.
    pub channel: Option<Channel>,
    /// The table of filters that the number, or the factor, is of.
    pub table: Option<&'static TableInfo>,
}

/// The reason why a text is the address of no number.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("the scenario has no number `{key}` to vary{instead}")]
pub struct UnknownSetting {
    /// The text.
    pub key: String,
    instead: String,
}

impl Address {
    /// The address in a text. A factor is relative to the scenario's present numbers.
    ///
    /// # Errors
    /// [`UnknownSetting`] where the scenario has no such number.
    pub fn parse(scenario: &Scenario, text: &str) -> Result<Self, UnknownSetting> {
        let unknown = || UnknownSetting { key: text.to_owned(), instead: Place::instead(scenario, text) };
        Place::parse(scenario, text).as_ref().map(Self::of).ok_or_else(unknown)
    }

    fn of(place: &Place) -> Self {
        let number = |key: String, name: String, unit| {
            let (is_whole, is_std, channel, table) = (false, false, None, None);
            Self { place: place.clone(), key, name, unit, is_whole, is_std, channel, table }
        };
        match place {
            Place::Scenario(info) => {
                let is_std = **info == super::DISTURBANCE;
                let name = format!("{}{}", if is_std { "true " } else { "" }, info.name);
                Self { is_std, is_whole: info.allowed.is_whole(), ..number(info.key.to_owned(), name, info.unit) }
            }
            Place::Parameter(channel) => {
                let (key, name) = (format!("plant.{}", channel.key()), format!("true {}", channel.symbol()));
                Self { channel: Some(*channel), ..number(key, name, channel.unit()) }
            }
            Place::Signal(channel, own) => {
                let (words, unit) = signal_words(own);
                let (key, name) =
                    (format!("plant.{}{own}", channel.key()), format!("{words} of true {}", channel.symbol()));
                Self { channel: Some(*channel), ..number(key, name, unit.unwrap_or(channel.unit())) }
            }
            Place::Noise(quantity) => {
                let key = format!("sensors.{}.noise_std", quantity.key());
                Self { is_std: true, ..number(key, format!("true noise of {}", quantity.symbol()), quantity.unit()) }
            }
            Place::Fault(quantity, fault, at) => {
                let info = &fault.info().numbers[*at];
                let name = format!("{} of {}", info.name, quantity.symbol());
                let number = number(fault.address(*quantity, info), name, info.scale.unit(*quantity));
                Self { is_whole: info.allowed.is_whole(), ..number }
            }
            Place::Filters(id, member) => {
                let key = |key: &str| id.map_or_else(|| format!("filters.*.{key}"), |id| filters::address(id, key));
                match member {
                    Member::Number(info) => {
                        let label = (info.label)(&FilterSettings::default()).unwrap_or(info.name);
                        let words = label.strip_prefix(info.symbol).unwrap_or(label);
                        let name = format!("{words} {}", info.symbol).trim().to_owned();
                        Self { is_whole: info.allowed.is_whole(), ..number(key(info.key), name, info.unit) }
                    }
                    Member::Entry(table, entry) => {
                        let channel = if let Entry::Channel(channel) = entry { Some(*channel) } else { None };
                        let name = format!("{} of {}", table.words, entry.symbol());
                        let number =
                            number(key(&format!("{}.{}", table.key, entry.key())), name, table.unit_of(*entry));
                        Self { is_std: table.factor.is_some(), channel, table: Some(table), ..number }
                    }
                    Member::Factor(table, _) => {
                        let name = format!("factor on {}", table.factor.unwrap_or(table.symbol));
                        Self { is_std: true, table: Some(table), ..number(key(table.key), name, "") }
                    }
                }
            }
        }
    }

    /// Whether the number belongs to filters: the record stays the same whatever its value.
    pub fn is_of_filters(&self) -> bool {
        matches!(self.place, Place::Filters(..))
    }

    /// Whether a given record can follow the number: it stays as it is, or its input is multiplied.
    pub fn suits_given_record(&self) -> bool {
        self.is_of_filters() || self.key == super::RECORD_GAIN.key
    }

    /// A value as the scenario takes it: a number without fractions is rounded, and a seed is not negative.
    pub fn rounded(&self, value: f64) -> f64 {
        match libm::round(value) {
            _ if !self.is_whole => value,
            whole if self.key == super::SEED.key => whole.max(0.0),
            whole => whole,
        }
    }

    /// Whether it is this number of a filter, or of all.
    pub fn is_of(&self, info: &SettingInfo<FilterSettings>) -> bool {
        matches!(self.place, Place::Filters(_, Member::Number(own)) if own == info)
    }

    /// Whether it stands for a factor on the numbers of a table.
    pub fn is_factor(&self) -> bool {
        matches!(self.place, Place::Filters(_, Member::Factor(..)))
    }

    /// Whether two addresses share a number: they are the same, or a number and the factor on its table.
    pub fn overlaps(&self, other: &Self) -> bool {
        match (&self.place, &other.place) {
            (Place::Filters(one, a), Place::Filters(two, b)) => {
                (one == two || one.is_none() || two.is_none()) && a.overlaps(b)
            }
            (one, two) => one == two,
        }
    }

    /// The value in a scenario, that of the first filter where there are several; NaN where it has no such number.
    pub fn get(&self, scenario: &Scenario) -> f64 {
        let sensor = |quantity: &Quantity| scenario.sensors.iter().find(|sensor| sensor.measures == *quantity);
        let number = match &self.place {
            Place::Scenario(info) => Some((info.get)(scenario)),
            Place::Parameter(channel) => scenario.plant.parameter(*channel).map(|signal| signal.at(0.0)),
            Place::Signal(channel, key) => {
                let numbers = scenario.plant.parameter(*channel).map(|signal| signal.numbers()).unwrap_or_default();
                numbers.into_iter().find(|(own, _)| own == key).map(|(_, number)| number)
            }
            Place::Noise(quantity) => sensor(quantity).map(|sensor| sensor.noise_std),
            Place::Fault(quantity, fault, place) => {
                sensor(quantity).and_then(|sensor| sensor.faults.numbers(*fault)?.get(*place).copied())
            }
            Place::Filters(id, member) => {
                let filter = scenario.filters.iter().find(|filter| id.is_none_or(|id| filter.id == id));
                filter.and_then(|filter| member.get(filter, &scenario.sensors))
            }
        };
        number.unwrap_or(f64::NAN)
    }

    /// Sets the value. A whole number is rounded; a signal becomes constant. The scenario may then be impossible.
    pub fn set(&self, scenario: &mut Scenario, value: f64) {
        let Scenario { plant, sensors, .. } = scenario;
        let of = |quantity: Quantity| move |sensor: &&mut Sensor| sensor.measures == quantity;
        match &self.place {
            Place::Scenario(info) => (info.set)(scenario, value),
            Place::Parameter(channel) => plant.set(*channel, Signal::Constant(value)),
            Place::Signal(channel, key) => {
                let numbers = plant.parameter_mut(*channel).map(Signal::numbers_mut).unwrap_or_default();
                numbers.into_iter().filter(|(own, _)| own == key).for_each(|(_, number)| *number = value);
            }
            Place::Noise(quantity) => {
                sensors.iter_mut().filter(of(*quantity)).for_each(|sensor| sensor.noise_std = value);
            }
            Place::Fault(quantity, fault, place) => {
                let faulty = sensors.iter_mut().filter(of(*quantity));
                let numbers = faulty.filter_map(|sensor| sensor.faults.numbers_mut(*fault)?.get_mut(*place));
                numbers.for_each(|number| *number = value);
            }
            Place::Filters(id, member) => {
                let Scenario { filters: all, sensors, .. } = scenario;
                let meant = all.iter_mut().filter(|filter| id.is_none_or(|id| filter.id == id));
                meant.enumerate().for_each(|(nth, filter)| member.set(filter, nth, value, sensors));
            }
        }
    }

    pub(super) fn shape(&self, scenario: &Scenario) -> Option<&'static str> {
        let Place::Parameter(channel) = &self.place else { return None };
        let numbers = scenario.plant.parameter(*channel)?.numbers();
        numbers.first()?.0.split('.').nth(1)
    }

    pub(super) fn is_in(&self, scenario: &Scenario) -> bool {
        match &self.place {
            Place::Filters(id, _) => scenario.filters.iter().any(|filter| id.is_none_or(|id| filter.id == id)),
            _ => !self.get(scenario).is_nan(),
        }
    }
}

/// The addresses of the single numbers that an address stands for, by the ids of filters.
pub(super) fn keys(scenario: &Scenario, address: &str) -> Vec<String> {
    let Some((places, key)) = scenario.filters_at(address) else { return vec![address.to_owned()] };
    let filters = places.into_iter().filter_map(|place| scenario.filters.get(place));
    let one = |filter| match TableInfo::from_key(key) {
        Some(table) => entries(scenario, filter, table),
        None => vec![filter.address(key)],
    };
    filters.flat_map(one).collect()
}

pub(super) fn keys_of(scenario: &Scenario, filter: &FilterSettings) -> Vec<String> {
    let rows = of_filter().map(|info| info.key);
    let choices = CHOICES_OF_FILTER.into_iter().map(|info| info.key);
    let others = ["name", "color", "kind", "plant", "augment", "consider", "bounds", "plucks"];
    let single = rows.chain(choices).chain(others).map(|key| filter.address(key));
    single.chain(TABLES.into_iter().flat_map(|table| entries(scenario, filter, table))).collect()
}

fn entries(scenario: &Scenario, filter: &FilterSettings, table: &TableInfo) -> Vec<String> {
    let address = |entry: Entry| filter.address(&format!("{}.{}", table.key, entry.key()));
    if table.is_of_sensors() {
        return scenario.sensors.iter().map(|sensor| address(Entry::Sensor(sensor.measures))).collect();
    }
    let model = filter.model(&scenario.plant.kind, scenario.input);
    model.channels().iter().map(|channel| address(Entry::Channel(*channel))).collect()
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.key)
    }
}

/// The words of a number of a signal, before "of" and its parameter, and its unit where it is not the parameter's.
fn signal_words(key: &str) -> (&'static str, Option<&'static str>) {
    match key {
        ".step.from" | ".ramp.from" => ("value before the change", None),
        ".step.to" | ".ramp.to" => ("value after the change", None),
        ".step.at" => ("time of the change", Some("s")),
        ".ramp.start" => ("begin of the change", Some("s")),
        ".ramp.end" => ("end of the change", Some("s")),
        ".sine.mean" => ("mean", None),
        ".sine.amplitude" => ("amplitude", None),
        ".sine.period" => ("period", Some("s")),
        _ => ("value", None),
    }
}

/// The address of every number of a scenario, one filter's after the other's.
pub fn addresses(scenario: &Scenario) -> Vec<Address> {
    let mut keys: Vec<String> = Vec::new();
    for filter in &scenario.filters {
        let rows = of_filter().filter(|info| (info.serves)(filter, &scenario.plant.kind));
        keys.extend(rows.map(|info| filter.address(info.key)));
        keys.extend(TABLES.into_iter().flat_map(|table| entries(scenario, filter, table)));
    }
    for channel in scenario.plant.parameters() {
        let numbers = scenario.plant.parameter(channel).map(|signal| signal.numbers()).unwrap_or_default();
        keys.extend(numbers.into_iter().map(|(name, _)| format!("plant.{}{name}", channel.key())));
    }
    keys.extend(scenario.sensors.iter().map(|sensor| format!("sensors.{}.noise_std", sensor.measures.key())));
    keys.extend(scenario.fault_addresses());
    let rows = of_scenario().filter(|info| (info.serves)(scenario, &scenario.plant.kind));
    keys.extend(rows.map(|info| info.key.to_owned()));
    keys.iter().filter_map(|key| Address::parse(scenario, key).ok()).collect()
}

/// The words by which a setting is found: its address, name and symbols, Greek letters also by their names.
pub fn words_of(scenario: &Scenario, address: &Address) -> String {
    let Address { key, name, channel, .. } = address;
    let channel = channel.map_or("", Channel::name);
    let words = format!("{} {key} {channel} {name}", scenario.address_by_name(key));
    let greek = "ληωζμκσ".chars().zip([" lambda", " eta", " omega", " zeta", " mu", " kappa", " sigma"]);
    let spelled: String = greek.filter(|(letter, _)| words.contains(*letter)).map(|(_, name)| name).collect();
    (words + &spelled).replace(['_', '.'], " ").to_lowercase()
}
