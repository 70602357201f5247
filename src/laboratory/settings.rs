//! The settings that a map's axes may have, and their names.

use kalmanscope_core::Scenario;
use kalmanscope_core::setting::{
    Address, INITIAL_MEAN, INITIAL_STD, OF_FILTER, PROCESS_STD, RECORD_GAIN, SENSOR_STD, TableInfo, of_scenario,
};
use kalmanscope_lab::channels;

use crate::text::unit_in;

/// The keys of the settings that may be varied, in the order of a menu: first the filters' settings, then the record's.
/// `scenario` has the chosen filters only; all of them get the same value.
pub(crate) fn candidates(scenario: &Scenario, is_measured: bool) -> Vec<String> {
    let mut keys = of_filters(scenario);
    if is_measured {
        keys.push(RECORD_GAIN.key.to_owned());
    } else {
        let sensors = scenario.sensors.iter().map(|sensor| sensor.measures.key());
        keys.extend(scenario.plant.parameters().map(|channel| format!("plant.{}", channel.key())));
        keys.extend(sensors.map(|key| format!("sensors.{key}.noise_std")));
        keys.extend(scenario.fault_addresses());
        keys.extend(of_scenario().filter(|info| info.is_varied).map(|info| info.key.to_owned()));
    }
    keys.retain(|key| is_possible(scenario, key));
    keys
}

pub(crate) fn of_filters(scenario: &Scenario) -> Vec<String> {
    let places: Vec<usize> = (0..scenario.filters.len()).collect();
    let channels = channels(scenario, &places);
    let entries = |table: &TableInfo, keys: Vec<&str>| -> Vec<String> {
        keys.into_iter().map(|key| format!("filters.*.{}.{key}", table.key)).collect()
    };
    let of = |is_parameter: bool| {
        let some = channels.iter().filter(|channel| channel.is_parameter() == is_parameter);
        some.map(|channel| channel.key()).collect::<Vec<_>>()
    };
    let sensors = scenario.sensors.iter().map(|sensor| sensor.measures.key()).collect();
    let whole = |keys: Vec<&str>| keys.into_iter().map(|key| format!("filters.*.{key}")).collect::<Vec<_>>();
    let mut varied = OF_FILTER.into_iter().flatten().filter(|info| info.is_varied).map(|info| info.key);
    let mut keys = entries(&INITIAL_MEAN, of(true));
    keys.extend(whole([&PROCESS_STD, &SENSOR_STD].map(|table| table.key).into_iter().chain(varied.next()).collect()));
    keys.extend(entries(&PROCESS_STD, of(true)));
    keys.extend(entries(&INITIAL_STD, of(true)));
    keys.extend(entries(&SENSOR_STD, sensors));
    keys.extend(entries(&PROCESS_STD, of(false)));
    keys.extend(whole([INITIAL_STD.key].into_iter().chain(varied).collect()));
    keys.retain(|key| is_possible(scenario, key));
    keys
}

/// Whether a setting has a number in this scenario. A factor on numbers that are all zero has none.
pub(crate) fn is_possible(scenario: &Scenario, key: &str) -> bool {
    Address::parse(scenario, key).is_ok_and(|address| address.get(scenario).is_finite())
}

/// Whether two axes would set the same number: the same, or a number and the factor on its table.
pub(crate) fn collide(a: &str, b: &str, scenario: &Scenario) -> bool {
    let [a, b] = [a, b].map(|key| Address::parse(scenario, key));
    matches!((a, b), (Ok(a), Ok(b)) if a.overlaps(&b))
}

pub(crate) fn name(key: &str, scenario: &Scenario) -> String {
    Address::parse(scenario, key).map_or_else(|_| key.to_owned(), |address| address.name())
}

pub(crate) fn label(key: &str, scenario: &Scenario) -> String {
    let unit = Address::parse(scenario, key).map_or("", |address| unit_in(scenario, address.unit()));
    let name = name(key, scenario);
    if unit.is_empty() { name } else { format!("{name} [{unit}]") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kalmanscope_core::Channel;

    #[test]
    fn every_candidate_can_be_varied_and_has_a_name() {
        let scenario = Scenario::default();
        for is_measured in [false, true] {
            let keys = candidates(&scenario, is_measured);
            assert_eq!(keys[0], "filters.*.initial_mean.natural_frequency");
            for key in &keys {
                let address = Address::parse(&scenario, key).unwrap();
                assert!(!is_measured || address.suits_given_record(), "{key} would change the record");
                assert!(!name(key, &scenario).contains('.'), "{key} has no name");
                assert_eq!(address.to_string(), *key);
            }
            assert_eq!(keys.contains(&"seed".to_owned()), !is_measured);
        }
    }

    #[test]
    fn a_factor_on_nothing_is_no_candidate() {
        let mut scenario = Scenario::default();
        for filter in &mut scenario.filters {
            let channels: Vec<Channel> = filter.process_std.iter().map(|(channel, _)| channel).collect();
            channels.into_iter().for_each(|channel| filter.process_std[channel] = 0.0);
        }
        assert!(!candidates(&scenario, false).contains(&"filters.*.process_std".to_owned()));
    }
}
