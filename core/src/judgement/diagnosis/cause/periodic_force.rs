//! An unrecorded force acts that is a sine: a motor, the mains, a shaft that is out of balance.

use super::own_equation::{Component, Oscillator};
use super::{BadFilter, Cause, LikelyCause};
use crate::judgement::diagnosis::evidence::Subject;
use crate::judgement::diagnosis::words::short;

pub(super) static CAUSE: Cause = Cause {
    key: "periodic_force",
    name: "a periodic force that is not recorded",
    hint: "A motor or the mains push in a line of the spectrum, which the plant has no mode for. Take an equation in which a second \
           oscillator without damping is that force: its frequency is estimated too.",
    likely_causes,
};

/// A line that is so much above the mean power is worth a trial.
const LINE: f64 = 8.0;

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let Some(oscillator) = Oscillator::of(bad) else { return };
    let case = bad.case;
    let Some((height, line)) = bad.line() else { return };
    if height < LINE || line <= 0.0 {
        return;
    }
    let weight = 0.6 * bad.effect_of(|one| one.test.name.contains("spectrum") && one.subject != Subject::All);
    let Oscillator { frequency, size } = oscillator;
    // The force that moves the oscillator as far as it goes at that frequency.
    let force = size * (frequency * frequency - line * line).abs().max(0.1 * frequency * frequency);
    let seconds = case.len() as f64 * case.record.dt();
    let width = (std::f64::consts::TAU / seconds).max(0.01 * line);
    let unit = Some(["frequency of the force", "rad/s", "positive"]);
    let components = [
        Component { key: "u", parameter: None, mean: 0.0, std: force },
        Component { key: "s", parameter: None, mean: 0.0, std: force * line },
        Component { key: "w", parameter: unit, mean: line, std: width },
    ];
    let edits = oscillator.edits(bad, "x'' + 2 ζ ωₙ x' + ωₙ² x = f + u; u' = s; s' = -w² u", &components);
    let sentence = format!("a periodic force acts that the record lacks, at {} rad/s", short(line));
    found.push(LikelyCause::new(cause, weight, 3.0, edits, sentence));
}
