//! An accelerometer feels the disturbance that the process noise stands for.

use super::{BadFilter, Cause, LikelyCause};
use crate::Channel;
use crate::judgement::diagnosis::evidence::Subject;
use crate::judgement::diagnosis::words::short;

pub(super) static CAUSE: Cause = Cause {
    key: "felt_disturbance",
    name: "a disturbance felt by an accelerometer",
    hint: "An accelerometer reads the disturbance itself, so that its R is its own noise² and the disturbance² besides; or the \
           filter knows it as a white force, which moves the plant and is read.",
    likely_causes,
};

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let (case, filter) = (bad.case, bad.filter);
    let model = filter.model(bad.scenario.plant.kind, bad.scenario.input);
    // The process noise of a velocity in a step is the disturbance times dt.
    let disturbance = filter.process_std[Channel::VELOCITY] / case.record.dt();
    let at_rest = model.at_rest(|quantity| filter.initial_mean[quantity.gain()]);
    let felt = |i: usize| {
        let reading = model.reading(case.sensors[i].sensor)?;
        let read = |force| model.read_disturbed(&reading, &at_rest, 0.0, force);
        Some((read(1.0) - read(0.0)) * disturbance).filter(|felt| *felt != 0.0)
    };
    let places: Vec<usize> = (0..filter.sensor_std.len()).filter(|&i| felt(i).is_some()).collect();
    // An R that contains the disturbance already is no cause.
    if places.is_empty() || places.iter().all(|&i| filter.sensor_std[i] > 0.9 * felt(i).unwrap_or(0.0).abs()) {
        return;
    }
    let turned: Vec<f64> =
        filter.sensor_std.iter().enumerate().map(|(i, std)| libm::hypot(*std, felt(i).unwrap_or(0.0))).collect();
    let of = |subject: Subject| places.iter().any(|&i| subject == Subject::Sensor(case.sensors[i].sensor));
    let weight = bad.effect_of(|one| of(one.subject));
    let sentence =
        format!("Q stands for a disturbance of {} m/s², which the accelerometer feels too", short(disturbance));
    found.push(LikelyCause::new(cause, weight, 0.0, vec![bad.edit("sensor_std", turned)], sentence.clone()));
    // A white force of the same size also models the accelerometer's reading of it; a larger R does not.
    if !filter.augment.contains(&Channel::WHITE_FORCE) {
        let edits = vec![
            bad.augmented(Channel::WHITE_FORCE),
            bad.edit(&format!("process_std.{}", Channel::WHITE_FORCE.key()), disturbance),
            bad.edit(&format!("process_std.{}", Channel::VELOCITY.key()), 0.0),
        ];
        found.push(LikelyCause::new(cause, weight, 0.0, edits, sentence));
    }
}
