//! The scores that a map can show, and their names.

use kalmanscope_core::internals::sort_short_by_key;
use kalmanscope_core::{Channel, Quantity, Record, Scenario};
use kalmanscope_lab::{Measure, channels};

/// Limits the channels that a map keeps scores of: a wide row for every cell would fill the memory.
const MOST_CHANNELS: usize = 8;

/// The channels of the scenario's filters, parameters first.
fn scored(scenario: &Scenario) -> Vec<Channel> {
    let places: Vec<usize> = (0..scenario.filters.len()).collect();
    let mut channels = channels(scenario, &places);
    sort_short_by_key(&mut channels, |channel| !channel.is_parameter());
    channels.truncate(MOST_CHANNELS);
    channels
}

/// The scores that are computed for every cell: all that need no history, so that the map can switch between them at
/// once.
pub(crate) fn taken(scenario: &Scenario) -> Vec<Measure> {
    Measure::of_sums(&scored(scenario))
}

/// The scores that can be shown, in the order of a menu.
pub(crate) fn offered(scenario: &Scenario, record: &Record) -> Vec<Measure> {
    let channels = scored(scenario);
    let is_known = |channel: Channel| record.truth(channel).is_some();
    let of = |of: fn(Channel) -> Measure| channels.iter().copied().map(of).collect::<Vec<_>>();
    let sensors: Vec<Quantity> = scenario.sensors.iter().map(|sensor| sensor.measures).collect();
    let mut offered = of(Measure::Rmse);
    offered.extend([Measure::Nis, Measure::Consistency, Measure::LogLikelihood, Measure::Nees]);
    for each in [Measure::Error, Measure::Estimate, Measure::Std, Measure::Settled, Measure::Coverage] {
        offered.extend(of(each));
    }
    offered.extend([Measure::Diverged, Measure::Stopped, Measure::Verdict]);
    offered.extend(sensors.iter().copied().map(Measure::FreeRun));
    offered.extend(sensors.iter().copied().map(Measure::OneStep));
    offered.retain(|measure| match *measure {
        Measure::Error(c) | Measure::Rmse(c) | Measure::Settled(c) | Measure::Coverage(c) => is_known(c),
        Measure::Nees => channels.iter().any(|channel| is_known(*channel)),
        _ => true,
    });
    offered
}

/// The name of a score, for a menu.
pub(crate) fn name(measure: Measure) -> String {
    match measure {
        Measure::Nis => "mean NIS, 1 expected".to_owned(),
        Measure::Nees => "mean NEES, 1 expected".to_owned(),
        Measure::Consistency => "mean NIS, distance in σ".to_owned(),
        Measure::LogLikelihood => "log likelihood".to_owned(),
        Measure::Diverged => "lost the truth".to_owned(),
        Measure::Stopped => "stopped".to_owned(),
        Measure::Verdict => "verdict".to_owned(),
        Measure::Error(channel) => format!("last error of {}", channel.symbol()),
        Measure::Rmse(channel) => format!("RMS error of {}", channel.symbol()),
        Measure::Estimate(channel) => format!("last estimate of {}", channel.symbol()),
        Measure::Std(channel) => format!("last σ of {}", channel.symbol()),
        Measure::Settled(channel) => format!("settling time of {}", channel.symbol()),
        Measure::Coverage(channel) => format!("share of {} inside ±2σ", channel.symbol()),
        Measure::FreeRun(quantity) => format!("free-run error of {}", quantity.symbol()),
        Measure::OneStep(quantity) => format!("one-step error of {}", quantity.symbol()),
    }
}

/// The name of a score with its unit.
pub(crate) fn label(measure: Measure) -> String {
    let unit = measure.unit();
    if unit.is_empty() { name(measure) } else { format!("{} [{unit}]", name(measure)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kalmanscope_core::simulate;

    #[test]
    fn what_is_offered_is_taken_or_needs_a_history() {
        let scenario = Scenario { duration: 1.0, ..Scenario::default() };
        let (offered, taken) = (offered(&scenario, &simulate(&scenario)), taken(&scenario));
        assert_eq!(offered[0], Measure::Rmse(Channel::NATURAL_FREQUENCY));
        assert!(offered.iter().all(|measure| measure.needs_history() || taken.contains(measure)));
        let names: std::collections::BTreeSet<String> = offered.iter().map(|measure| name(*measure)).collect();
        assert_eq!(names.len(), offered.len(), "no two scores have one name");
    }
}
