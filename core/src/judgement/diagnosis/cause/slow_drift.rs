//! A parameter drifts.

use super::{BadFilter, Cause, LikelyCause};
use crate::Channel;
use crate::data::setting::Edit;
use crate::judgement::diagnosis::words::percent;

/// The tried random walks over the record, relative to the parameters.
const WALKS: [f64; 2] = [0.05, 0.3];

/// Limits the number of parameters that are also tried one by one.
const SINGLY: usize = 4;

pub(super) static CAUSE: Cause = Cause {
    key: "slow_drift",
    name: "a slow drift, or Q of the parameters",
    hint: "The parameters change, and the filter takes them for constant. Give them a process noise.",
    likely_causes,
};

/// Tries all parameters together, and each alone: a random walk of a constant parameter only adds to its error.
fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let case = bad.case;
    let own = |channel: &Channel| channel.is_parameter() && !channel.is_augmentation();
    let all: Vec<(usize, Channel)> =
        case.estimates.channels().iter().copied().enumerate().filter(|(_, c)| own(c)).collect();
    let mut propose = |parameters: &[(usize, Channel)], told: &str| {
        for walk in WALKS {
            let edits: Vec<_> = parameters.iter().filter_map(|&one| edit(bad, one, walk)).collect();
            if !edits.is_empty() {
                let sentence = format!("{told}, by about {} over the record", percent(walk));
                found.push(LikelyCause::new(cause, 0.3, 1.0, edits, sentence));
            }
        }
    };
    propose(&all, "the parameters drift");
    if (2..=SINGLY).contains(&all.len()) {
        for one in &all {
            propose(std::slice::from_ref(one), &format!("{} drifts", one.1.name()));
        }
    }
}

/// The process noise of a parameter at a place that walks by a share of itself over the record.
fn edit(bad: &BadFilter<'_>, (place, channel): (usize, Channel), walk: f64) -> Option<Edit> {
    let (mean, doubt) = (bad.case.estimates.initial_mean(place).abs(), bad.case.estimates.initial_std(place));
    let std = walk * mean.max(doubt) / (bad.case.len().max(2) as f64).sqrt();
    let moves = std > bad.filter.process_std[channel] && doubt > 0.0;
    moves.then(|| bad.edit(&format!("process_std.{}", channel.key()), std))
}
