//! The filter begins too sure of itself.

use super::{BadFilter, Cause, LikelyCause};

/// The tried factor on the initial standard deviations.
const WIDER: f64 = 5.0;

pub(super) static CAUSE: Cause = Cause {
    key: "initial_guess",
    name: "an initial guess that is too sure",
    hint: "A filter does not look far from where it begins. Begin with larger standard deviations, or a better guess.",
    likely_causes,
};

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let channels = bad.case.estimates.channels();
    let edits: Vec<_> = channels
        .iter()
        .filter(|&&channel| bad.filter.initial_std[channel] > 0.0 && !bad.filter.knows(channel))
        .map(|&channel| bad.edit(&format!("initial_std.{}", channel.key()), WIDER * bad.filter.initial_std[channel]))
        .collect();
    if !edits.is_empty() {
        let sentence = "the filter begins too sure of a guess that is far off".to_owned();
        found.push(LikelyCause::new(cause, 0.1, 1.0, edits, sentence));
    }
}
