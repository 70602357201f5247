//! A parameter drifts.

use super::{Cause, Matter, Suspect};
use crate::Channel;
use crate::diagnosis::words::percent;

/// The tried random walks over the record, relative to the parameters.
const WALKS: [f64; 2] = [0.05, 0.3];

pub(super) static CAUSE: Cause = Cause {
    key: "slow_drift",
    name: "a slow drift, or Q of the parameters",
    hint: "The parameters change, and the filter takes them for constant. Give them a process noise.",
    suspects,
};

fn suspects(matter: &Matter<'_>, cause: &'static Cause, found: &mut Vec<Suspect>) {
    let case = matter.case;
    let own = |channel: &Channel| channel.is_parameter() && !channel.is_augmentation();
    let parameters: Vec<(usize, Channel)> =
        case.estimates.channels().iter().copied().enumerate().filter(|(_, c)| own(c)).collect();
    for walk in WALKS {
        let mut knobs = Vec::new();
        for &(place, channel) in &parameters {
            let size = case.estimates.initial_mean(place).abs().max(case.estimates.initial_std(place));
            let std = walk * size / (case.len().max(2) as f64).sqrt();
            if std > matter.filter.process_std[channel] && case.estimates.initial_std(place) > 0.0 {
                knobs.push(matter.knob(&format!("process_std.{}", channel.key()), std));
            }
        }
        if !knobs.is_empty() {
            let sentence = format!("the parameters drift, by about {} over the record", percent(walk));
            found.push(Suspect::new(cause, 0.3, 1.0, knobs, sentence));
        }
    }
}
