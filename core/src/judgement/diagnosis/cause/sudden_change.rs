//! A parameter has changed suddenly.

use super::{BadFilter, Cause, LikelyCause};
use crate::judgement::diagnosis::change::{Change, change_point};
use crate::judgement::diagnosis::words::short;

/// The least rise of the normalised squares that is a change.
const RISE: f64 = 1.3;

/// The weight of fading relative to a jump: fading also forgets information from before the change.
const FADES: f64 = 0.9;

/// Limits the probability that chance explains a change.
const LEVEL: f64 = 1e-4;

/// The tried fading factors.
const FADING: [f64; 2] = [1.005, 1.02];

pub(super) static CAUSE: Cause = Cause {
    key: "sudden_change",
    name: "a sudden change",
    hint: "Something has changed at once, and a filter that is sure of its parameters does not follow. Let it widen P once, where its \
           innovations jump, or let its memory fade.",
    likely_causes,
};

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let case = bad.case;
    let change = change_point(&case.estimates.nis()[case.samples.clone()]);
    let is_one = |change: &Change| change.rise >= RISE && change.p_value < LEVEL;
    let Some(Change { at, rise, p_value }) = change.filter(is_one) else { return };
    let at = case.samples.start + at;
    let samples = at..case.samples.end;
    let time = short(case.record.time(at));
    let chance = if p_value > 0.0 { format!(" (p = {p_value:.0e})") } else { String::new() };
    let weight = 1.0 - 1.0 / rise;
    let jump = (!bad.filter.jump).then(|| bad.edit("jump", true));
    let fading = FADING.into_iter().filter(|fading| *fading > bad.filter.fading);
    let fading = fading.map(|fading| (FADES, bad.edit("fading", fading)));
    for (share, edit) in jump.map(|jump| (1.0, jump)).into_iter().chain(fading) {
        let sentence =
            format!("something changed at once, near {time} s: innovations² rise {} times there{chance}", short(rise));
        let likely = LikelyCause::new(cause, share * weight, 2.0, vec![edit], sentence);
        found.push(LikelyCause { samples: Some(samples.clone()), begins_anew: true, ..likely });
    }
}
