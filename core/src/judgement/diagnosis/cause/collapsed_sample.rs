//! Too few particles.

use super::{BadFilter, Cause, LikelyCause};
use crate::judgement::diagnosis::verdict_kind::VerdictKind;
use crate::judgement::diagnosis::words::short;

/// The least effective sample size of a sound sample.
const FEW: f64 = 3.0;

/// Limits the proposed number of particles.
const MOST: usize = 20_000;

pub(super) static CAUSE: Cause = Cause {
    key: "collapsed_sample",
    name: "a collapsed sample",
    hint: "Hardly a particle agrees with the measurements, and one stands for all. Take more of them, or a wider process noise.",
    likely_causes,
};

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let sizes = bad.case.estimates.effective_samples();
    let least = sizes.iter().copied().filter(|size| !size.is_nan()).fold(f64::INFINITY, f64::min);
    if least == f64::INFINITY {
        return;
    }
    let collapsed = bad.effect_of(|one| one.speaks_for == VerdictKind::Collapsed);
    let particles = bad.filter.ensemble_size;
    let more = (10 * particles).min(MOST);
    let edits = vec![bad.edit("ensemble_size", more as i64)];
    let sentence = format!("of {particles} particles as few as {} have had all the weight", short(least));
    let weight = if collapsed > 0.0 || least < FEW { 0.9 } else { 0.3 };
    found.push(LikelyCause { certain: weight > 0.5, ..LikelyCause::new(cause, weight, 0.0, edits, sentence) });
}
