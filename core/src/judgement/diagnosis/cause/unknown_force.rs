//! An unrecorded force acts, and lasts longer than a sample.

use super::{BadFilter, Cause, LikelyCause};
use crate::Channel;

/// The relative change of a force over one period that costs one fitted value per period.
const FREE: f64 = 0.3;

/// The tried changes of the force over one period of the oscillator, relative to the force that moves the spring.
const CHANGES: [f64; 3] = [0.03, 0.3, 2.0];

pub(super) static CAUSE: Cause = Cause {
    key: "unknown_force",
    name: "a force that is not recorded",
    hint: "Wind, a rotor, a load that comes and goes: a force that changes slowly pushes innovations to one side for a while. Let \
           the filter estimate it as a random walk; it takes up what damping and spring do too, so that ζ is known less.",
    likely_causes,
};

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let case = bad.case;
    let Some(place) = case.estimates.place(Channel::NATURAL_FREQUENCY) else { return };
    let frequency = case.estimates.initial_mean(place).abs();
    let force = frequency * frequency * bad.size();
    if bad.filter.augment.contains(&Channel::UNKNOWN_FORCE) || !(force > 0.0 && force.is_finite()) {
        return;
    }
    let first = case.sensors.iter().map(|one| one.autocorrelation(&case.kept)[0]).fold(0.0, f64::max);
    let weight = first / (1.0 + first);
    let key = Channel::UNKNOWN_FORCE.key();
    let period = std::f64::consts::TAU / frequency / case.record.dt();
    let periods = case.len() as f64 / period;
    for change in CHANGES {
        let edits = vec![
            bad.augmented(Channel::UNKNOWN_FORCE),
            bad.edit(&format!("initial_std.{key}"), force),
            bad.edit(&format!("process_std.{key}"), change * force / period.sqrt()),
        ];
        let sentence = "a force acts that the record lacks, and changes slowly".to_owned();
        // A force that changes freely fits any record: its freedom has a price on top of that of its two values.
        let fitted = 2.0 + periods * change / FREE;
        found.push(LikelyCause::new(cause, weight, fitted, edits, sentence));
    }
}
