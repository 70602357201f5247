//! Q of the motion is too small or too large.

use super::{BadFilter, Cause, LikelyCause};
use crate::Channel;
use crate::judgement::diagnosis::words::short;

/// The tried factors on the standard deviations.
const FACTORS: [f64; 6] = [0.03, 0.1, 0.3, 3.0, 10.0, 30.0];

pub(super) static CAUSE: Cause = Cause {
    key: "process_noise",
    name: "Q of the motion",
    hint: "Q of the motion stands for forces that nobody records. Too small, and innovations resemble the one before; too \
           large, and they alternate.",
    likely_causes,
};

/// Uses the signs of the innovations' correlation.
///
/// Source: Mehra (1970), On the identification of variances and adaptive Kalman filtering.
fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let (case, filter) = (bad.case, bad.filter);
    let first = case.sensors.iter().map(|one| one.autocorrelation(&case.kept)[0]);
    let first = first.fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
    // If a white force drives the motion, it is the motion's only process noise.
    let is_white = filter.augment.contains(&Channel::WHITE_FORCE) && filter.process_std[Channel::WHITE_FORCE] > 0.0;
    let moves = |channel: &Channel| if is_white { *channel == Channel::WHITE_FORCE } else { !channel.is_parameter() };
    let motions = || case.estimates.channels().iter().copied().filter(moves);
    for factor in FACTORS {
        let edits = motions().map(|channel| {
            let std = filter.process_std[channel];
            bad.edit(
                &format!("process_std.{}", channel.key()),
                factor * if std > 0.0 { std } else { smallest(bad, channel) },
            )
        });
        let agrees = (first > 0.0) == (factor > 1.0);
        let weight = if agrees { 2.0 * first.abs() / (1.0 + 2.0 * first.abs()) } else { 0.05 };
        // The change since the user's own settings.
        let since = factor * motions().next().map_or(1.0, |channel| turned_since(bad, channel));
        let (word, by) = if since > 1.0 { ("small", since) } else { ("large", 1.0 / since) };
        let sentence = format!(
            "Q of the motion is about {} times too {word}; the innovations are correlated by {first:.2} at lag 1",
            short(by * by)
        );
        let sentence = if libm::log(by) < 0.1 { String::new() } else { sentence };
        found.push(LikelyCause::new(cause, weight, 1.0, edits.collect(), sentence));
    }
}

/// A process noise for a channel without one: a thousandth of its initial standard deviation.
fn smallest(bad: &BadFilter<'_>, channel: Channel) -> f64 {
    1e-3 * bad.filter.initial_std[channel]
}

/// The factor on the process noise of a channel since the user's own settings.
fn turned_since(bad: &BadFilter<'_>, channel: Channel) -> f64 {
    let of = |std: f64| if std > 0.0 { std } else { smallest(bad, channel) };
    let factor = of(bad.filter.process_std[channel]) / of(bad.origin.process_std[channel]);
    if factor > 0.0 && factor.is_finite() { factor } else { 1.0 }
}
