//! The filter begins too sure of itself.

use super::{Cause, Matter, Suspect};

/// The tried factor on the initial standard deviations.
const WIDER: f64 = 5.0;

pub(super) static CAUSE: Cause = Cause {
    key: "initial_guess",
    name: "an initial guess that is too sure",
    hint: "A filter does not look far from where it begins. Begin with larger standard deviations, or a better guess.",
    suspects,
};

fn suspects(matter: &Matter<'_>, cause: &'static Cause, found: &mut Vec<Suspect>) {
    let channels = matter.case.estimates.channels();
    let knobs: Vec<_> = channels
        .iter()
        .filter(|&&channel| matter.filter.initial_std[channel] > 0.0 && !matter.filter.knows(channel))
        .map(|&channel| {
            matter.knob(&format!("initial_std.{}", channel.key()), WIDER * matter.filter.initial_std[channel])
        })
        .collect();
    if !knobs.is_empty() {
        let sentence = "the filter begins too sure of a guess that is far off".to_owned();
        found.push(Suspect::new(cause, 0.1, 1.0, knobs, sentence));
    }
}
