//! The filter forgets faster than the measurements inform it.

use super::{Cause, Matter, Suspect};
use crate::judgement::diagnosis::verdict_kind::VerdictKind;
use crate::judgement::diagnosis::words::short;

pub(super) static CAUSE: Cause = Cause {
    key: "wind_up",
    name: "wind-up by fading",
    hint: "A fading memory forgets even while nothing is learnt. Switch it off, or give the parameters a process noise instead.",
    suspects,
};

fn suspects(matter: &Matter<'_>, cause: &'static Cause, found: &mut Vec<Suspect>) {
    if matter.filter.fading <= 1.0 {
        return;
    }
    let weight = matter.effect_of(|one| one.speaks_for == VerdictKind::WoundUp);
    let fading = matter.filter.fading;
    let fading = if fading < 1e6 { fading.to_string() } else { short(fading) };
    let sentence = format!("the memory fades by λ = {fading} a sample while little is learnt");
    let knobs = vec![matter.knob("fading", 1.0)];
    found.push(Suspect { certain: weight > 0.0, ..Suspect::new(cause, weight, 0.0, knobs, sentence) });
}
