//! The settings that a map's axes may have, and the scores that it can show, with their names.

use kalmanscope_core::setting::{
    Address, INITIAL_MEAN, INITIAL_STD, PROCESS_STD, RECORD_GAIN, SENSOR_STD, TableInfo, of_filter, of_scenario,
};
use kalmanscope_core::{Channel, Quantity, Record, Scenario};
use kalmanscope_diagnosis::Measure;
use kalmanscope_lab::channels;

use crate::text::unit_in;

/// The keys of the settings that may be varied, the filters' first; all filters of `scenario` get the same value.
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
    let mut varied = of_filter().filter(|info| info.is_varied).map(|info| info.key);
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

pub(crate) fn is_possible(scenario: &Scenario, key: &str) -> bool {
    Address::parse(scenario, key).is_ok_and(|address| address.get(scenario).is_finite())
}

pub(crate) fn collide(a: &str, b: &str, scenario: &Scenario) -> bool {
    let [a, b] = [a, b].map(|key| Address::parse(scenario, key));
    matches!((a, b), (Ok(a), Ok(b)) if a.overlaps(&b))
}

pub(crate) fn name(key: &str, scenario: &Scenario) -> String {
    Address::parse(scenario, key).map_or_else(|_| key.to_owned(), |address| address.name)
}

pub(crate) fn label(key: &str, scenario: &Scenario) -> String {
    let unit = Address::parse(scenario, key).map_or("", |address| unit_in(scenario, address.unit));
    let name = name(key, scenario);
    if unit.is_empty() { name } else { format!("{name} [{unit}]") }
}

/// Limits the channels that a map keeps scores of: a wide row for every cell would fill the memory.
const MOST_CHANNELS: usize = 8;

fn scored(scenario: &Scenario) -> Vec<Channel> {
    let places: Vec<usize> = (0..scenario.filters.len()).collect();
    let mut channels = channels(scenario, &places);
    // Parameters first: in a long chain the motion of the last masses is what is cut off.
    channels.sort_by_key(|channel| !channel.is_parameter());
    channels.truncate(MOST_CHANNELS);
    channels
}

/// The scores of every cell: all that need no history, so that the map can switch between them at once.
pub(crate) fn taken(scenario: &Scenario) -> Vec<Measure> {
    Measure::of_sums(&scored(scenario))
}

pub(crate) fn offered(scenario: &Scenario, record: &Record) -> Vec<Measure> {
    let channels = scored(scenario);
    let is_known = |channel: Channel| record.truth(channel).is_some();
    let sensors: Vec<Quantity> = scenario.sensors.iter().map(|sensor| sensor.measures).collect();
    let is_offered = |measure: &Measure| {
        let has_truth = || measure.channel().map_or(channels.iter().any(|channel| is_known(*channel)), is_known);
        !measure.info().is_special && (!measure.info().needs_truth || has_truth())
    };
    let mut offered: Vec<Measure> = Measure::all(&channels, &sensors).into_iter().filter(is_offered).collect();
    offered.sort_by_key(|measure| measure.info().word != Measure::rmse(Channel::NATURAL_FREQUENCY).info().word);
    offered
}

pub(crate) fn measure_label(measure: Measure, scenario: &Scenario) -> String {
    let unit = unit_in(scenario, measure.unit());
    if unit.is_empty() { measure.name() } else { format!("{} [{unit}]", measure.name()) }
}

#[cfg(test)]
mod tests {
    use kalmanscope_core::simulate;

    use super::*;

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

    #[test]
    fn a_score_has_the_unit_of_the_record() {
        let circuit = kalmanscope_lessons::BUILT_IN.iter().find(|entry| entry.title == "Measured: a circuit").unwrap();
        let circuit = circuit.scenario().unwrap();
        let labels = |scenario: &Scenario| {
            let key = "filters.*.initial_mean.velocity";
            [measure_label(Measure::rmse(Channel::VELOCITY), scenario), label(key, scenario)]
        };
        assert!(labels(&circuit).iter().all(|label| label.ends_with("[V/s]")), "{:?}", labels(&circuit));
        assert!(labels(&Scenario::default()).iter().all(|label| label.ends_with("[m/s]")));
    }

    #[test]
    fn what_is_offered_is_taken_or_needs_a_history() {
        let scenario = Scenario { duration: 1.0, ..Scenario::default() };
        let (offered, taken) = (offered(&scenario, &simulate(&scenario)), taken(&scenario));
        assert_eq!(offered[0], Measure::rmse(Channel::NATURAL_FREQUENCY));
        assert!(offered.iter().all(|measure| measure.info().needs_history() || taken.contains(measure)));
        let names: std::collections::BTreeSet<String> = offered.iter().map(|measure| measure.name()).collect();
        assert_eq!(names.len(), offered.len(), "no two scores have one name");
    }
}
