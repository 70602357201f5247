//! The scores that a map can show, and their names.

use kalmanscope_core::{Channel, Measure, Quantity, Record, Scenario};
use kalmanscope_lab::channels;

use crate::text::unit_in;

/// Limits the channels that a map keeps scores of: a wide row for every cell would fill the memory.
const MOST_CHANNELS: usize = 8;

fn scored(scenario: &Scenario) -> Vec<Channel> {
    let places: Vec<usize> = (0..scenario.filters.len()).collect();
    let mut channels = channels(scenario, &places);
    channels.sort_by_key(|channel| !channel.is_parameter());
    channels.truncate(MOST_CHANNELS);
    channels
}

/// The scores that are computed for every cell: all that need no history, so that the map can switch between them at
/// once.
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

pub(crate) fn label(measure: Measure, scenario: &Scenario) -> String {
    let unit = unit_in(scenario, measure.unit());
    if unit.is_empty() { measure.name() } else { format!("{} [{unit}]", measure.name()) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kalmanscope_core::simulate;

    #[test]
    fn a_score_has_the_unit_of_the_record() {
        let circuit = kalmanscope_lessons::BUILT_IN.iter().find(|entry| entry.title == "Measured: a circuit").unwrap();
        let circuit = circuit.scenario().unwrap();
        let labels = |scenario: &Scenario| {
            let key = "filters.*.initial_mean.velocity";
            [label(Measure::rmse(Channel::VELOCITY), scenario), super::super::setting_label(key, scenario)]
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
