//! Whether the estimates are possible for an oscillator.

use std::f64::consts::PI;

use crate::Channel;
use crate::judgement::diagnosis::case::Case;
use crate::judgement::diagnosis::evidence::{Evidence, Subject, Test};
use crate::judgement::diagnosis::verdict_kind::VerdictKind;
use crate::judgement::diagnosis::words::short;

/// Limits an estimate, relative to its initial mean and standard deviation.
const FAR: f64 = 1e3;

/// Limits how far below zero a positive parameter can be, in standard deviations.
const BELOW: f64 = 4.0;

pub(super) static TEST: Test = Test {
    name: "size and sign of the estimates",
    statistic: "the last estimates",
    distribution: "none",
    source: "Nyquist (1928), Certain topics in telegraph transmission theory (the limit π/dt)",
    reading: "a frequency beyond what the samples can show, a negative damping, or a number far from any start: the filter is lost",
    run,
};

fn run(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    let Some(last) = case.last() else { return };
    let late = case.late();
    for (place, &channel) in case.estimates.channels().iter().enumerate().filter(|(_, c)| c.is_parameter()) {
        let means = case.estimates.canonical_means(place);
        let (mean, std) = (means[last], case.estimates.std(last, place));
        let (name, unit) = (channel.name(), channel.unit());
        let space = if unit.is_empty() { "" } else { " " };
        let start = case.estimates.initial_mean(place).abs().max(2.0 * case.estimates.initial_std(place));
        let nyquist = PI / case.record.dt();
        let evidence = || Evidence { samples: late.clone(), ..Evidence::new(test, Subject::Channel(channel), case) };
        if !mean.is_finite() {
            found.push(evidence().certain(VerdictKind::Lost, f64::MAX, format!("the {name} is no number")));
        } else if start > 0.0 && mean.abs() > FAR * start {
            let sentence = format!("the {name} is {}{space}{unit}, more than 1000 times any start", short(mean.abs()));
            found.push(evidence().certain(VerdictKind::Lost, mean.abs() / (FAR * start), sentence));
        } else if channel == Channel::NATURAL_FREQUENCY {
            let sentence = format!(
                "the {name} is {} rad/s; samples {} s apart show nothing above {} rad/s",
                short(mean.abs()),
                short(case.record.dt()),
                short(nyquist)
            );
            found.push(evidence().certain(VerdictKind::Lost, mean.abs() / nyquist, sentence));
        }
        if channel.is_positive() && case.estimates.initial_std(place) > 0.0 {
            let below = late.clone().map(|k| -means[k] / case.estimates.std(k, place)).fold(f64::INFINITY, f64::min);
            let mirrored = channel.is_mirrored() && channel != Channel::NATURAL_FREQUENCY;
            let whose = if mirrored { ": the oscillator gains energy" } else { "" };
            let sentence =
                format!("the {name} is negative, {}{space}{unit} ± {}{whose}", short(mean), short(2.0 * std));
            if below > 0.0 {
                found.push(evidence().certain(VerdictKind::Lost, below / BELOW, sentence));
            }
        }
    }
}
