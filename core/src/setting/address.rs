//! The address of a number in a scenario, and the list of all of them.

use std::fmt;

use kalmanscope_filters::channel::Channel;
use thiserror::Error;

use super::place::{Member, Place};
use super::{CHOICES_OF_FILTER, Entry, SettingInfo, TABLES, TableInfo, of_filter, of_scenario};
use crate::scenario::{FilterSettings, Scenario};
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
pub struct Address(Place);

/// The reason why a text is the address of no number.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("the scenario has no number `{key}` to vary{instead}")]
#[non_exhaustive]
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
        Place::parse(scenario, text).map(Self).ok_or_else(unknown)
    }

    /// Whether the number belongs to filters: the record stays the same whatever its value.
    pub fn is_of_filters(&self) -> bool {
        matches!(self.0, Place::Filters(..))
    }

    /// Whether a given record can follow the number: it stays as it is, or its input is multiplied.
    pub fn suits_given_record(&self) -> bool {
        self.is_of_filters() || matches!(self.0, Place::Scenario(info) if *info == super::RECORD_GAIN)
    }

    /// Whether the number has no fractions, as a seed has none.
    pub fn is_whole(&self) -> bool {
        match &self.0 {
            Place::Scenario(info) => info.allowed.is_whole(),
            Place::Filters(_, Member::Number(info)) => info.allowed.is_whole(),
            Place::Fault(_, fault, place) => fault.info().numbers[*place].allowed.is_whole(),
            _ => false,
        }
    }

    /// A value as the scenario takes it: a number without fractions is rounded, and a seed is not negative.
    pub fn rounded(&self, value: f64) -> f64 {
        match &self.0 {
            _ if !self.is_whole() => value,
            Place::Scenario(info) if **info == super::SEED => libm::round(value).max(0.0),
            _ => libm::round(value),
        }
    }

    /// Whether it is this number of the scenario.
    pub fn is_of_scenario(&self, info: &SettingInfo<Scenario>) -> bool {
        matches!(self.0, Place::Scenario(own) if own == info)
    }

    /// Whether it is this number of a filter, or of all.
    pub fn is_of(&self, info: &SettingInfo<FilterSettings>) -> bool {
        matches!(self.0, Place::Filters(_, Member::Number(own)) if own == info)
    }

    /// Whether it stands for a factor on the numbers of a table.
    pub fn is_factor(&self) -> bool {
        matches!(self.0, Place::Filters(_, Member::Factor(..)))
    }

    /// Whether it is a standard deviation, or a factor on some.
    pub fn is_std(&self) -> bool {
        match &self.0 {
            Place::Scenario(info) => **info == super::DISTURBANCE,
            Place::Noise(_) => true,
            Place::Filters(..) => self.table().is_some_and(|table| table.factor.is_some()),
            Place::Parameter(_) | Place::Signal(..) | Place::Fault(..) => false,
        }
    }

    /// The table of filters that the number, or the factor, is of.
    pub fn table(&self) -> Option<&'static TableInfo> {
        match &self.0 {
            Place::Filters(_, Member::Entry(table, _) | Member::Factor(table, _)) => Some(table),
            _ => None,
        }
    }

    /// The channel that the number is of, if it is of one.
    pub fn channel(&self) -> Option<Channel> {
        match &self.0 {
            Place::Parameter(channel)
            | Place::Signal(channel, _)
            | Place::Filters(_, Member::Entry(_, Entry::Channel(channel))) => Some(*channel),
            _ => None,
        }
    }

    /// The unit, empty for a pure number.
    pub fn unit(&self) -> &'static str {
        match &self.0 {
            Place::Scenario(info) => info.unit,
            Place::Parameter(channel) => channel.unit(),
            Place::Signal(channel, key) => signal_words(key).1.unwrap_or(channel.unit()),
            Place::Noise(quantity) => quantity.unit(),
            Place::Fault(quantity, fault, place) => fault.info().numbers[*place].scale.unit(*quantity),
            Place::Filters(_, Member::Number(info)) => info.unit,
            Place::Filters(_, Member::Entry(table, entry)) => table.unit_of(*entry),
            Place::Filters(_, Member::Factor(..)) => "",
        }
    }

    /// The name without that of a filter, short enough for an axis.
    pub fn name(&self) -> String {
        match &self.0 {
            Place::Scenario(info) if **info == super::DISTURBANCE => format!("true {}", info.name),
            Place::Scenario(info) => info.name.to_owned(),
            Place::Parameter(channel) => format!("true {}", channel.symbol()),
            Place::Signal(channel, key) => format!("{} of true {}", signal_words(key).0, channel.symbol()),
            Place::Noise(quantity) => format!("true noise of {}", quantity.symbol()),
            Place::Fault(quantity, fault, place) => {
                format!("{} of {}", fault.info().numbers[*place].name, quantity.symbol())
            }
            Place::Filters(_, Member::Number(info)) => {
                let label = (info.label)(&FilterSettings::default()).unwrap_or(info.name);
                let words = label.strip_prefix(info.symbol).unwrap_or(label);
                format!("{words} {}", info.symbol).trim().to_owned()
            }
            Place::Filters(_, Member::Entry(table, entry)) => format!("{} of {}", table.words, entry.symbol()),
            Place::Filters(_, Member::Factor(table, _)) => {
                format!("factor on {}", table.factor.unwrap_or(table.symbol))
            }
        }
    }

    /// Whether two addresses share a number: they are the same, or a number and the factor on its table, of filters that are the
    /// same or among all.
    pub fn overlaps(&self, other: &Self) -> bool {
        match (&self.0, &other.0) {
            (Place::Filters(one, a), Place::Filters(two, b)) => {
                (one == two || one.is_none() || two.is_none()) && a.overlaps(b)
            }
            (one, two) => one == two,
        }
    }

    /// The present value in a scenario, that of the first filter where there are several; of a parameter that moves, the first
    /// value. NaN where the scenario has no such number.
    pub fn get(&self, scenario: &Scenario) -> f64 {
        let sensor = |quantity| scenario.sensor_place(quantity).map(|place| &scenario.sensors[place]);
        let number = match &self.0 {
            Place::Scenario(info) => Some((info.get)(scenario)),
            Place::Parameter(channel) => scenario.plant.parameter(*channel).map(|signal| signal.at(0.0)),
            Place::Signal(channel, key) => {
                let numbers = scenario.plant.parameter(*channel).map(|signal| signal.numbers()).unwrap_or_default();
                numbers.into_iter().find(|(own, _)| own == key).map(|(_, number)| number)
            }
            Place::Noise(quantity) => sensor(*quantity).map(|sensor| sensor.noise_std),
            Place::Fault(quantity, fault, place) => {
                sensor(*quantity).and_then(|sensor| sensor.faults.numbers(*fault)?.get(*place).copied())
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
        match &self.0 {
            Place::Scenario(info) => (info.set)(scenario, value),
            Place::Parameter(channel) => scenario.plant.set(*channel, Signal::Constant(value)),
            Place::Signal(channel, key) => {
                let numbers = scenario.plant.parameter_mut(*channel).map(Signal::numbers_mut).unwrap_or_default();
                numbers.into_iter().filter(|(own, _)| own == key).for_each(|(_, number)| *number = value);
            }
            Place::Noise(quantity) => {
                let sensors = scenario.sensors.iter_mut().filter(|sensor| sensor.measures == *quantity);
                sensors.for_each(|sensor| sensor.noise_std = value);
            }
            Place::Fault(quantity, fault, place) => {
                let sensors = scenario.sensors.iter_mut().filter(|sensor| sensor.measures == *quantity);
                let numbers = sensors.filter_map(|sensor| sensor.faults.numbers_mut(*fault)?.get_mut(*place));
                numbers.for_each(|number| *number = value);
            }
            Place::Filters(id, member) => {
                let Scenario { filters: all, sensors, .. } = scenario;
                let meant = all.iter_mut().filter(|filter| id.is_none_or(|id| filter.id == id));
                meant.enumerate().for_each(|(nth, filter)| member.set(filter, nth, value, sensors));
            }
        }
    }
}

impl Address {
    pub(super) fn shape(&self, scenario: &Scenario) -> Option<&'static str> {
        let Place::Parameter(channel) = &self.0 else { return None };
        let numbers = scenario.plant.parameter(*channel)?.numbers();
        numbers.first()?.0.split('.').nth(1)
    }

    /// The addresses of the single numbers that it stands for, by the ids of filters; none where the scenario has no such number.
    pub(super) fn keys(&self, scenario: &Scenario) -> Vec<String> {
        match &self.0 {
            Place::Filters(id, member) => {
                let meant = scenario.filters.iter().filter(|filter| id.is_none_or(|id| filter.id == id));
                let one = |filter| match member {
                    Member::Factor(table, _) => entries(scenario, filter, table),
                    member => vec![filter.address(&member.to_string())],
                };
                meant.flat_map(one).collect()
            }
            _ if self.get(scenario).is_nan() => Vec::new(),
            _ => vec![self.to_string()],
        }
    }
}

pub(super) fn keys_below(scenario: &Scenario, address: &str) -> Vec<String> {
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
        match &self.0 {
            Place::Scenario(info) => f.write_str(info.key),
            Place::Parameter(channel) => write!(f, "plant.{}", channel.key()),
            Place::Signal(channel, key) => write!(f, "plant.{}{key}", channel.key()),
            Place::Noise(quantity) => write!(f, "sensors.{}.noise_std", quantity.key()),
            Place::Fault(quantity, fault, place) => {
                f.write_str(&fault.address(*quantity, &fault.info().numbers[*place]))
            }
            Place::Filters(None, member) => write!(f, "filters.*.{member}"),
            Place::Filters(Some(id), member) => write!(f, "filters#{id}.{member}"),
        }
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
    let key = address.to_string();
    let channel = address.channel().map_or("", kalmanscope_filters::Channel::name);
    let words = format!("{} {} {channel} {}", scenario.address_by_name(&key), key, address.name());
    let greek = "ληωζμκσ".chars().zip([" lambda", " eta", " omega", " zeta", " mu", " kappa", " sigma"]);
    let spelled: String = greek.filter(|(letter, _)| words.contains(*letter)).map(|(_, name)| name).collect();
    (words + &spelled).replace(['_', '.'], " ").to_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_of_setting_is_set_and_read_back() {
        let mut scenario = Scenario::default();
        let settings = "seed=12 dt=0.02 duration=20 plant.disturbance_std=0.3 plant.input_delay=2 plant.initial.displacement=0.1 \
             plant.natural_frequency.step.to=4 plant.natural_frequency.step.at=12 plant.natural_frequency=5 \
             sensors.velocity.noise_std=0.2 filters.EKF.fading=1.01 filters.EKF.eta=0.1 filters.UKF.input_delay=-1 \
             filters.EKF.sensor_std.velocity=0.5 filters.EKF.sensor_std.0=0.25 \
             filters.UKF.initial_mean.natural_frequency=12 filters.*.initial_std.damping_ratio=0.3 \
             filters.EKF.process_std.velocity=0.001";
        for (key, value) in settings.split(' ').filter_map(|setting| setting.split_once('=')) {
            let value: f64 = value.parse().unwrap();
            let address = Address::parse(&scenario, key).unwrap();
            address.set(&mut scenario, value);
            assert_eq!(address.get(&scenario), value, "{key}");
            assert_eq!(Address::parse(&scenario, key).unwrap().get(&scenario), value, "{key} is found again");
            scenario.validate().unwrap();
        }
        assert!(scenario.filters.iter().all(|f| f.initial_std[Channel::DAMPING_RATIO] == 0.3));
    }

    #[test]
    fn a_factor_multiplies_the_present_numbers() {
        let before = Scenario::default();
        let mut scenario = before.clone();
        for key in ["filters.*.process_std", "filters.EKF.sensor_std", "filters.UKF.initial_std"] {
            let address = Address::parse(&before, key).unwrap();
            assert_eq!(address.get(&scenario), 1.0);
            address.set(&mut scenario, 4.0);
            address.set(&mut scenario, 3.0);
            assert!((address.get(&scenario) - 3.0).abs() < 1e-12, "{key}");
        }
        let [ekf, ukf] = &scenario.filters[..] else { panic!("two filters") };
        assert_eq!(ekf.sensor_std, before.filters[0].sensor_std.iter().map(|s| 3.0 * s).collect::<Vec<_>>());
        assert_eq!(ukf.sensor_std, before.filters[1].sensor_std);
        assert_eq!(ukf.initial_std[Channel::VELOCITY], 3.0 * before.filters[1].initial_std[Channel::VELOCITY]);
        scenario.filters[0].sensor_std[0] *= 2.0;
        let address = Address::parse(&before, "filters.EKF.sensor_std").unwrap();
        assert!(address.get(&scenario).is_nan(), "one sensor alone has another factor");
    }

    #[test]
    fn unknown_keys_are_refused() {
        let a_filter = "; a filter has `fading`, `eta`, `jump`, ";
        let its_plant = "; its plant has `natural_frequency`, `damping_ratio`, `initial.displacement`, ";
        for (key, instead) in [
            (
                "",
                "; it has `seed`, `dt`, `duration`, `force.white_noise.std`, and numbers of its `plant`, `sensors` and `filters`",
            ),
            ("plant.mass", its_plant),
            ("plant.input_gain", its_plant),
            ("plant.natural_frequency.ramp.to", its_plant),
            ("plant.natural_frequency.step.by", its_plant),
            ("filters.KF.fading", "; its filters are `EKF` and `UKF`"),
            ("filters.EKF", ""),
            ("filters.EKF.fadng", a_filter),
            ("filters.EKF.sensor_std.acceleration", a_filter),
            ("filters.EKF.sensor_std.2", a_filter),
            ("filters.EKF.initial_mean.cubic_stiffness", a_filter),
            (
                "sensors.acceleration.noise_std",
                "; a sensor has `noise_std` and numbers of its `faults`, and its sensors are `displacement`, `velocity`",
            ),
        ] {
            let unknown = Address::parse(&Scenario::default(), key).unwrap_err().to_string();
            let begin = format!("the scenario has no number `{key}` to vary{instead}");
            assert!(if instead.ends_with(' ') { unknown.starts_with(&begin) } else { unknown == begin }, "{unknown}");
        }
    }

    #[test]
    fn an_address_is_written_by_id_and_is_none_where_an_id_is_not_unique() {
        let mut scenario = Scenario::default();
        for (text, written) in [
            ("filters.UKF.sensor_std.1", "filters#2.sensor_std.velocity"),
            ("filters.EKF.process_std", "filters#1.process_std"),
            ("filters.*.initial_mean.natural_frequency", "filters.*.initial_mean.natural_frequency"),
            ("sensors.0.noise_std", "sensors.displacement.noise_std"),
        ] {
            let address = Address::parse(&scenario, text).unwrap();
            assert_eq!(address.to_string(), written);
            assert_eq!(Address::parse(&scenario, written).unwrap(), address);
            assert!(!address.name().contains('.'), "{}", address.name());
        }
        let ukf = Address::parse(&scenario, "filters.UKF.fading").unwrap();
        let filter = scenario.filters.remove(0);
        ukf.set(&mut scenario, 1.25);
        assert_eq!(scenario.filters[0].fading, 1.25, "it is the same filter at another place");
        scenario.filters.push(crate::FilterSettings { id: 2, ..filter });
        assert!(Address::parse(&scenario, "filters.EKF.fading").is_err(), "which of the two?");
    }

    #[test]
    fn a_factor_and_a_number_of_its_table_overlap() {
        let scenario = Scenario::default();
        let overlap = |a: &str, b: &str| {
            let [a, b] = [a, b].map(|text| Address::parse(&scenario, text).unwrap());
            assert_eq!(a.overlaps(&b), b.overlaps(&a));
            a.overlaps(&b)
        };
        assert!(overlap("filters.*.process_std", "filters.*.process_std.velocity"));
        assert!(overlap("seed", "seed") && !overlap("seed", "dt"));
        assert!(overlap("filters.*.process_std", "filters#2.process_std.velocity"));
        assert!(overlap("filters#2.process_std", "filters.UKF.process_std"));
        assert!(!overlap("filters#2.process_std", "filters#1.process_std"));
        assert!(!overlap("filters#2.process_std", "filters#2.initial_std"));
        assert!(!overlap("filters.*.process_std.velocity", "filters.*.process_std.displacement"));
    }

    #[test]
    fn every_number_has_an_address_that_is_read_back_and_words_that_find_it() {
        let scenario = Scenario::default();
        let all = addresses(&scenario);
        assert!(all.len() > 40, "{}", all.len());
        for address in &all {
            assert_eq!(Address::parse(&scenario, &address.to_string()).as_ref(), Ok(address));
            assert!(address.get(&scenario).is_finite(), "{address}");
        }
        let found = |words: &[&str]| {
            let has = |address: &&Address| words.iter().all(|word| words_of(&scenario, address).contains(word));
            all.iter().filter(has).map(Address::to_string).collect::<Vec<_>>()
        };
        assert_eq!(found(&["lambda", "ekf"]), ["filters#1.fading"]);
        assert_eq!(found(&["process", "zeta", "ukf"]), ["filters#2.process_std.damping_ratio"]);
        assert_eq!(found(&["time of the change"]), ["plant.natural_frequency.step.at"]);
        assert_eq!(found(&["seed"]), ["seed"]);
    }
}
