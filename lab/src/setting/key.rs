//! Settings by their keys.

use kalmanscope_core::{Channel, Quantity, Scenario};

use super::member::{Member, Stds};
use super::{Global, Place, record_gain};

/// The place of the setting with a key.
pub(super) fn place(scenario: &Scenario, key: &str) -> Option<Place> {
    let keys: Vec<&str> = key.split('.').collect();
    Some(match keys[..] {
        ["seed"] => Place::Scenario(Global::Seed),
        ["dt"] => Place::Scenario(Global::Dt),
        ["duration"] => Place::Scenario(Global::Duration),
        ["plant", "disturbance_std"] => Place::Scenario(Global::Disturbance),
        ["plant", "input_delay"] => Place::Scenario(Global::InputDelay),
        ["plant", "initial", "displacement"] => Place::Scenario(Global::Displacement),
        ["plant", "initial", "velocity"] => Place::Scenario(Global::Velocity),
        ["record", "input", "gain"] => record_gain(scenario).map(|_| Place::Scenario(Global::RecordGain))?,
        ["plant", parameter] => {
            let channel = Channel::from_key(parameter)?;
            scenario.plant.parameters().find(|c| *c == channel).map(Place::Parameter)?
        }
        ["sensors", sensor, "noise_std"] => Place::Noise(sensor_place(scenario, sensor)?),
        _ => filters(scenario, key)?,
    })
}

/// A setting of one filter, or of all.
fn filters(scenario: &Scenario, address: &str) -> Option<Place> {
    let (places, key) = scenario.filters_at(address)?;
    let rest: Vec<&str> = key.split('.').collect();
    let factor = |table| Member::Factor(table, places.iter().map(|&place| scenario.filters[place].clone()).collect());
    let channel = |key: &str| {
        let channel = Channel::from_key(key)?;
        let has = |&place: &usize| {
            scenario.filters[place].model(scenario.plant.kind, scenario.input).channels().contains(&channel)
        };
        places.iter().all(has).then_some(channel)
    };
    let member = match rest[..] {
        ["fading"] => Member::Fading,
        ["eta"] => Member::Eta,
        ["input_delay"] => Member::InputDelay,
        ["ensemble_size"] => Member::EnsembleSize,
        ["iterations"] => Member::Iterations,
        ["sensor_std"] => factor(Stds::Sensor),
        ["initial_std"] => factor(Stds::Initial),
        ["process_std"] => factor(Stds::Process),
        ["sensor_std", sensor] => Member::SensorStd(sensor_place(scenario, sensor)?),
        ["initial_mean", key] => Member::InitialMean(channel(key)?),
        ["initial_std", key] => Member::InitialStd(channel(key)?),
        ["process_std", key] => Member::ProcessStd(channel(key)?),
        _ => return None,
    };
    (!places.is_empty()).then_some(Place::Filters(places, member))
}

/// The place of a sensor by its quantity or its number from 0 on.
fn sensor_place(scenario: &Scenario, sensor: &str) -> Option<usize> {
    let by_number = || sensor.parse().ok().filter(|&place: &usize| place < scenario.sensors.len());
    let quantity = Quantity::from_key(sensor);
    quantity.map_or_else(by_number, |quantity| scenario.sensors.iter().position(|s| s.measures == quantity))
}
