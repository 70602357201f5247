//! The filter begins too sure of itself.

use super::{BadFilter, Cause, LikelyCause};
use crate::Channel;
use crate::judgement::diagnosis::words::short;

/// The tried factor on the initial standard deviations.
const WIDER: f64 = 5.0;

/// A guess is far off where it differs by more than this share from the measured frequency, which is spread by that share.
const FAR: f64 = 0.1;
const SPREAD: f64 = 0.2;

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
    if edits.is_empty() {
        return;
    }
    let sentence = "the filter begins too sure of a guess that is far off".to_owned();
    found.push(LikelyCause::new(cause, 0.1, 1.0, edits.clone(), sentence));
    // From far off, a filter may settle elsewhere however wide it begins: then the measured motion has a better guess.
    let frequency = Channel::NATURAL_FREQUENCY;
    let is_estimated = bad.filter.initial_std[frequency] > 0.0 && !bad.filter.knows(frequency);
    let guess = bad.case.estimates.place(frequency).filter(|_| is_estimated);
    let guess = guess.map(|place| bad.case.estimates.initial_mean(place).abs());
    let peak = bad.measured_peak().filter(|peak| guess.is_some_and(|guess| (peak / guess - 1.0).abs() > FAR));
    if let Some(peak) = peak {
        let [mean, std] = ["initial_mean", "initial_std"].map(|table| format!("{table}.{}", frequency.key()));
        let mut edits: Vec<_> = edits.into_iter().filter(|edit| !edit.key.ends_with(&std)).collect();
        edits.extend([bad.edit(&mean, peak), bad.edit(&std, SPREAD * peak)]);
        let sentence =
            format!("the filter begins too sure of a guess that is far off: the motion turns at {} rad/s", short(peak));
        found.push(LikelyCause::new(cause, 0.1, 2.0, edits, sentence));
    }
}
