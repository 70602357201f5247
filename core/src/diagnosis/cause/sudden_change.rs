//! A parameter has changed at once.

use super::{Cause, Matter, Suspect};
use crate::diagnosis::change::{Change, change_point};
use crate::diagnosis::words::short;

/// The least rise of the normalised squares that is a change.
const RISE: f64 = 1.3;

/// Limits the probability that chance explains a change.
const LEVEL: f64 = 1e-4;

/// The tried fading factors.
const FADING: [f64; 2] = [1.005, 1.02];

pub(super) static CAUSE: Cause = Cause {
    key: "sudden_change",
    name: "a sudden change",
    hint: "Something has changed at once, and a filter that is sure of its parameters does not follow. Let its memory fade.",
    suspects,
};

fn suspects(matter: &Matter<'_>, cause: &'static Cause, found: &mut Vec<Suspect>) {
    let case = matter.case;
    let change = change_point(&case.estimates.nis()[case.samples.clone()]);
    let is_one = |change: &Change| change.rise >= RISE && change.p_value < LEVEL;
    let Some(Change { at, rise, p_value }) = change.filter(is_one) else { return };
    let at = case.samples.start + at;
    let samples = at..case.samples.end;
    let time = short(case.record.time(at));
    let chance = if p_value > 0.0 { format!(" (p = {p_value:.0e})") } else { String::new() };
    let weight = 1.0 - 1.0 / rise;
    for fading in FADING.into_iter().filter(|fading| *fading > matter.filter.fading) {
        let sentence =
            format!("something changed at once, near {time} s: innovations² rise {} times there{chance}", short(rise));
        let knobs = vec![matter.knob("fading", fading)];
        let suspect = Suspect::new(cause, weight, 2.0, knobs, sentence);
        found.push(Suspect { samples: Some(samples.clone()), begins_anew: true, ..suspect });
    }
}
