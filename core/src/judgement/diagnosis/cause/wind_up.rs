//! The filter forgets faster than the measurements inform it.

use super::{BadFilter, Cause, LikelyCause};
use crate::judgement::diagnosis::verdict_kind::VerdictKind;
use crate::judgement::diagnosis::words::short;

pub(super) static CAUSE: Cause = Cause {
    key: "wind_up",
    name: "wind-up by fading",
    hint: "A fading memory forgets even while nothing is learnt. Switch it off, or give the parameters a process noise instead.",
    likely_causes,
};

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    if bad.filter.fading <= 1.0 {
        return;
    }
    let weight = bad.effect_of(|one| one.speaks_for == VerdictKind::WoundUp);
    let fading = bad.filter.fading;
    let fading = if fading < 1e6 { fading.to_string() } else { short(fading) };
    let sentence = format!("the memory fades by λ = {fading} a sample while little is learnt");
    let edits = vec![bad.edit("fading", 1.0)];
    found.push(LikelyCause { certain: weight > 0.0, ..LikelyCause::new(cause, weight, 0.0, edits, sentence) });
}
