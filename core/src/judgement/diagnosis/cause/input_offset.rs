//! The input has an offset.

use super::{BadFilter, Cause, LikelyCause};
use crate::Channel;

pub(super) static CAUSE: Cause = Cause {
    key: "input_offset",
    name: "an offset of the input",
    hint: "An amplifier's zero, or a constant force that is not recorded. Let the filter estimate it, or subtract the mean.",
    likely_causes,
};

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    if bad.filter.augment.contains(&Channel::INPUT_OFFSET) {
        return;
    }
    let case = bad.case;
    let mean = case.sensors.iter().map(|one| one.mean(&case.kept).abs()).fold(0.0, f64::max);
    let weight = 2.0 * mean / (1.0 + 2.0 * mean);
    // As large as the input, or the restoring force of the motion.
    let stiffness = case.estimates.place(Channel::NATURAL_FREQUENCY).map_or(0.0, |place| {
        let wn = case.estimates.initial_mean(place);
        wn * wn * bad.size()
    });
    let std = bad.input_size().max(stiffness).max(1e-9);
    let name = Channel::INPUT_OFFSET.key();
    let edits = vec![bad.augmented(Channel::INPUT_OFFSET), bad.edit(&format!("initial_std.{name}"), std)];
    found.push(LikelyCause::new(cause, weight, 1.0, edits, "a constant force acts that the record lacks".to_owned()));
}
