//! The sentence that says frequency and damping of a free decay in a hall's words.

use std::f64::consts::{LN_2, PI, TAU};

use super::number::with_band;
use super::outcome::Outcome;
use super::phrase::{Phrase, Writer};
use crate::VerdictKind;

/// Limits the band of a parameter over its size.
const VAGUE: f64 = 0.5;

/// Below this period nobody counts swings \[s\].
const QUICK: f64 = 0.05;

/// How the oscillator swings by itself, from the first filter whose band is no narrower than it should be: nothing if none knows
/// both parameters well enough.
///
/// ```text
/// T = 2π / (ωₙ √(1 - ζ²)),  t½ = ln 2 / (ζ ωₙ),  Q = 1 / (2 ζ),  δ = ζ ωₙ T
/// ```
///
/// Source: Clough and Penzien (2003), *Dynamics of Structures*, section 2.6.
pub(super) fn sentence(outcomes: &[Outcome<'_>]) -> Option<Vec<Phrase>> {
    let may_be_believed =
        |outcome: &&Outcome<'_>| outcome.is_honest() || outcome.kind() == Some(VerdictKind::Underconfident);
    let [(frequency, spread), (damping, doubt)] = outcomes.iter().filter(may_be_believed).find_map(Outcome::swing)?;
    let (shares, zeta) = ([2.0 * spread / frequency, 2.0 * doubt / damping], damping);
    if !(frequency > 0.0 && zeta > 0.0 && zeta < 1.0 && shares.iter().all(|share| (0.0..VAGUE).contains(share))) {
        return None;
    }
    let damped = libm::sqrt(1.0 - zeta * zeta);
    let period = TAU / (frequency * damped);
    let half = LN_2 / (zeta * frequency);
    let text = if period < QUICK {
        let text = Writer::default().say("It swings ").result(with_band(period.recip(), shares[0] / period, ""));
        text.say(" times a second")
    } else {
        Writer::default().say("It swings once in ").result(with_band(period, shares[0] * period, "s"))
    };
    let text = text.say(", and in ").result(with_band(half, libm::hypot(shares[0], shares[1]) * half, "s"));
    let text = text.say(" half of the swing is gone: Q = ").result(with_band(0.5 / zeta, 0.5 * shares[1] / zeta, ""));
    let decrement = 2.0 * PI * zeta / damped;
    let text = text.say(", logarithmic decrement ").result(with_band(decrement, shares[1] * decrement, ""));
    Some(text.say(".").done())
}
