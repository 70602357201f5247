//! The damping grows with the square of the speed, at least in part.

use super::own_equation::{Component, Oscillator};
use super::{BadFilter, Cause, LikelyCause};

pub(super) static CAUSE: Cause = Cause {
    key: "drag",
    name: "drag, as of air or water",
    hint: "Drag grows with the square of the speed: a large swing dies out fast, a small one hardly. Take an equation with such a term.",
    likely_causes,
};

/// The damping ratio that drag is equal to, at most speeds.
const RATIO: f64 = 0.05;

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let Some(oscillator) = Oscillator::of(bad) else { return };
    let weight = 0.4 * bad.effect_of(|one| one.test.name.contains("spectrum") || one.test.name.contains("whiteness"));
    let of_size = 2.0 * RATIO / oscillator.size;
    let parameter = Some(["drag", "1/m", "not_negative"]);
    let drag = Component { key: "c", parameter, mean: of_size, std: of_size };
    let edits = oscillator.edits(bad, "x'' + 2 ζ ωₙ x' + ωₙ² x + c abs(x') x' = f", &[drag]);
    let sentence = "there is drag, which grows with the square of the speed".to_owned();
    found.push(LikelyCause::new(cause, weight, 1.0, edits, sentence));
}
