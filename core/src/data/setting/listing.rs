//! All numbers of a scenario that have an address, with the words by which one finds them.

use super::{Address, Entry, OF_FILTER, TABLES, of_scenario};
use crate::data::scenario::Scenario;

/// The address of every number of a scenario, one filter's after the other's.
pub fn addresses(scenario: &Scenario) -> Vec<Address> {
    let mut keys: Vec<String> = Vec::new();
    for filter in &scenario.filters {
        let rows = OF_FILTER.into_iter().flatten().filter(|info| (info.serves)(filter, scenario.plant.kind));
        keys.extend(rows.map(|info| filter.address(info.key)));
        let model = filter.model(scenario.plant.kind, scenario.input);
        for table in TABLES {
            let channels = model.channels().iter().map(|channel| Entry::Channel(*channel));
            let sensors = scenario.sensors.iter().map(|sensor| Entry::Sensor(sensor.measures));
            let entries: Vec<Entry> = if table.is_of_sensors() { sensors.collect() } else { channels.collect() };
            keys.extend(entries.into_iter().map(|entry| filter.address(&format!("{}.{}", table.key, entry.key()))));
        }
    }
    for channel in scenario.plant.parameters() {
        let numbers = scenario.plant.parameter(channel).map(|signal| signal.numbers()).unwrap_or_default();
        keys.extend(numbers.into_iter().map(|(name, _)| format!("plant.{}{name}", channel.key())));
    }
    keys.extend(scenario.sensors.iter().map(|sensor| format!("sensors.{}.noise_std", sensor.measures.key())));
    keys.extend(scenario.fault_addresses());
    let rows = of_scenario().filter(|info| (info.serves)(scenario, scenario.plant.kind));
    keys.extend(rows.map(|info| info.key.to_owned()));
    keys.iter().filter_map(|key| Address::parse(scenario, key).ok()).collect()
}

/// The words by which a setting is found: its address, name and symbols, Greek letters also by their names.
pub fn words_of(scenario: &Scenario, address: &Address) -> String {
    let key = address.to_string();
    let channel = address.channel().map_or("", crate::Channel::name);
    let words = format!("{} {} {channel} {}", scenario.address_by_name(&key), key, address.name());
    let greek = [
        ('λ', " lambda"),
        ('η', " eta"),
        ('ω', " omega"),
        ('ζ', " zeta"),
        ('μ', " mu"),
        ('κ', " kappa"),
        ('σ', " sigma"),
    ];
    let spelled: String = greek.iter().filter(|(letter, _)| words.contains(*letter)).map(|(_, name)| *name).collect();
    (words + &spelled).replace(['_', '.'], " ").to_lowercase()
}

#[cfg(test)]
mod tests {
    use super::*;

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
