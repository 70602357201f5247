//! The damping is dry friction, at least in part.

use super::own_equation::{Component, Oscillator};
use super::{BadFilter, Cause, LikelyCause};

pub(super) static CAUSE: Cause = Cause {
    key: "dry_friction",
    name: "dry friction",
    hint: "Friction that has the same size at any speed takes away as much of a small swing as of a large one: a decay is a straight \
           line, and ends. Take an equation with such a term.",
    likely_causes,
};

/// The speed below which friction is less than whole, over the root mean square of all speeds: a jump has no derivative.
const SLOW: f64 = 0.05;

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let Some(oscillator) = Oscillator::of(bad) else { return };
    let Oscillator { frequency, size } = oscillator;
    let weight = 0.4 * bad.effect_of(|one| one.test.name.contains("spectrum") || one.test.name.contains("whiteness"));
    // Two digits, as a person would write it.
    let slow = SLOW * frequency * size;
    let scaled = format!("{slow:.1e}");
    let rounded = scaled.parse().unwrap_or(slow);
    let slow = if (1e-4..1e6).contains(&rounded) { rounded.to_string() } else { scaled };
    let equation = format!("x'' + 2 ζ ωₙ x' + ωₙ² x + d tanh(x'/{slow}) = f");
    let force = 0.05 * frequency * frequency * size;
    let parameter = Some(["friction", "m/s²", "not_negative"]);
    let friction = Component { key: "d", parameter, mean: force, std: force };
    let edits = oscillator.edits(bad, &equation, &[friction]);
    let sentence = "there is dry friction, which has the same size at any speed".to_owned();
    found.push(LikelyCause::new(cause, weight, 1.0, edits, sentence));
}
