//! The settings that a map's axes may have, and their names.

use kalmanscope_core::{Channel, Quantity, Scenario};
use kalmanscope_lab::{Setting, channels};

/// The keys of the settings that may be varied, in the order of a menu: first the filters' settings, then the record's.
/// `scenario` has the chosen filters only; all of them get the same value.
pub(crate) fn candidates(scenario: &Scenario, is_measured: bool) -> Vec<String> {
    let mut keys = of_filters(scenario);
    if is_measured {
        keys.push("record.input.gain".to_owned());
    } else {
        let sensors = scenario.sensors.iter().map(|sensor| sensor.measures.key());
        keys.extend(scenario.plant.parameters().map(|channel| format!("plant.{}", channel.key())));
        keys.extend(sensors.map(|key| format!("sensors.{key}.noise_std")));
        keys.extend(["plant.disturbance_std", "seed"].map(str::to_owned));
    }
    keys.retain(|key| is_possible(scenario, key));
    keys
}

/// The keys of the settings of filters alone.
pub(crate) fn of_filters(scenario: &Scenario) -> Vec<String> {
    let places: Vec<usize> = (0..scenario.filters.len()).collect();
    let channels = channels(scenario, &places);
    let sensors = || scenario.sensors.iter().map(|sensor| sensor.measures.key());
    let parameters = || channels.iter().filter(|channel| channel.is_parameter()).map(|channel| channel.key());
    let motion = || channels.iter().filter(|channel| !channel.is_parameter()).map(|channel| channel.key());
    let of = |what: &str, key: &str| format!("filters.*.{what}.{key}");
    let mut keys: Vec<String> = parameters().map(|key| of("initial_mean", key)).collect();
    keys.extend(["process_std", "sensor_std", "fading"].map(|what| format!("filters.*.{what}")));
    keys.extend(parameters().map(|key| of("process_std", key)));
    keys.extend(parameters().map(|key| of("initial_std", key)));
    keys.extend(sensors().map(|key| of("sensor_std", key)));
    keys.extend(motion().map(|key| of("process_std", key)));
    keys.extend(["initial_std", "eta"].map(|what| format!("filters.*.{what}")));
    keys.retain(|key| is_possible(scenario, key));
    keys
}

/// Whether a setting has a number in this scenario. A factor on numbers that are all zero has none.
pub(crate) fn is_possible(scenario: &Scenario, key: &str) -> bool {
    Setting::new(scenario, key).is_ok_and(|setting| setting.get(scenario).is_finite())
}

/// Whether two axes would set the same number: the same key, or a number and the factor on its table.
pub(crate) fn collide(a: &str, b: &str) -> bool {
    let is_in = |a: &str, b: &str| a.strip_prefix(b).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'));
    // A setting of all filters collides with that of each.
    let (a, b) = match (of_filter(a), of_filter(b)) {
        (Some((one, a)), Some((other, b))) if one == other || one == "*" || other == "*" => (a, b),
        _ => (a, b),
    };
    is_in(a, b) || is_in(b, a)
}

/// The filter of an address and the key behind it: `*`, or the filter's id.
fn of_filter(key: &str) -> Option<(&str, &str)> {
    key.strip_prefix("filters#")
        .or_else(|| key.strip_prefix("filters.").filter(|key| key.starts_with("*.")))?
        .split_once('.')
}

/// The name of a setting, short enough for an axis.
pub(crate) fn name(key: &str) -> String {
    let spelled = key.replacen("filters#", "filters.", 1);
    let parts: Vec<&str> = spelled.split('.').collect();
    let symbol = |key: &str| Channel::from_key(key).map_or(key.to_owned(), |channel| channel.symbol().to_owned());
    let sensor = |key: &str| Quantity::from_key(key).map_or(key.to_owned(), |quantity| quantity.symbol().to_owned());
    match parts[..] {
        ["filters", .., "initial_mean", key] => format!("guess of {}", symbol(key)),
        ["filters", .., "initial_std", key] => format!("σ of the guess of {}", symbol(key)),
        ["filters", .., "process_std", key] => format!("√Q of {}", symbol(key)),
        ["filters", .., "sensor_std", key] => format!("√R of {}", sensor(key)),
        ["filters", .., "process_std"] => "factor on √Q".to_owned(),
        ["filters", .., "sensor_std"] => "factor on √R".to_owned(),
        ["filters", .., "initial_std"] => "factor on √P₀".to_owned(),
        ["filters", .., "fading"] => "fading factor λ".to_owned(),
        ["filters", .., "eta"] => "decay η".to_owned(),
        ["record", "input", "gain"] => "gain of the input".to_owned(),
        ["plant", "disturbance_std"] => "true disturbance".to_owned(),
        ["plant", key] => format!("true {}", symbol(key)),
        ["sensors", key, "noise_std"] => format!("true noise of {}", sensor(key)),
        _ => key.to_owned(),
    }
}

/// The name of a setting with its unit.
pub(crate) fn label(key: &str, scenario: &Scenario) -> String {
    let unit = Setting::new(scenario, key).map_or("", |setting| setting.unit(scenario));
    if unit.is_empty() { name(key) } else { format!("{} [{unit}]", name(key)) }
}

/// The channel, if the setting is the first guess of one.
pub(crate) fn guessed(key: &str) -> Option<Channel> {
    let (rest, channel) = key.rsplit_once('.')?;
    Channel::from_key(channel).filter(|_| rest.ends_with(".initial_mean"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_candidate_can_be_varied_and_has_a_name() {
        let scenario = Scenario::default();
        for is_measured in [false, true] {
            let keys = candidates(&scenario, is_measured);
            assert_eq!(keys[0], "filters.*.initial_mean.natural_frequency");
            for key in &keys {
                let setting = Setting::new(&scenario, key).unwrap();
                assert!(!is_measured || setting.suits_given_record(), "{key} would change the record");
                assert!(key == "seed" || !name(key).contains('.'), "{key} has no name");
            }
            assert_eq!(keys.contains(&"seed".to_owned()), !is_measured);
        }
    }

    #[test]
    fn a_factor_and_a_number_of_its_table_collide() {
        assert!(collide("filters.*.process_std", "filters.*.process_std.velocity"));
        assert!(collide("seed", "seed"));
        assert!(collide("filters.*.process_std", "filters#2.process_std.velocity"));
        assert!(collide("filters#2.process_std", "filters#2.process_std"));
        assert!(!collide("filters#2.process_std", "filters#1.process_std"));
        assert_eq!(name("filters#2.process_std.velocity"), name("filters.*.process_std.velocity"));
        assert!(!collide("filters.*.process_std.velocity", "filters.*.process_std.velocity_2"));
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
