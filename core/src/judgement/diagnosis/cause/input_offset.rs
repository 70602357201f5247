//! The input has an offset.

use super::{Cause, Matter, Suspect};
use crate::Channel;

pub(super) static CAUSE: Cause = Cause {
    key: "input_offset",
    name: "an offset of the input",
    hint: "An amplifier's zero, or a constant force that is not recorded. Let the filter estimate it, or subtract the mean.",
    suspects,
};

fn suspects(matter: &Matter<'_>, cause: &'static Cause, found: &mut Vec<Suspect>) {
    if matter.filter.augment.contains(&Channel::INPUT_OFFSET) {
        return;
    }
    let case = matter.case;
    let mean = case.sensors.iter().map(|one| one.mean(&case.kept).abs()).fold(0.0, f64::max);
    let weight = 2.0 * mean / (1.0 + 2.0 * mean);
    // As large as the input, or the restoring force of the motion.
    let stiffness = case.estimates.place(Channel::NATURAL_FREQUENCY).map_or(0.0, |place| {
        let wn = case.estimates.initial_mean(place);
        wn * wn * matter.size()
    });
    let std = matter.input_size().max(stiffness).max(1e-9);
    let name = Channel::INPUT_OFFSET.key();
    let knobs = vec![matter.augmented(Channel::INPUT_OFFSET), matter.knob(&format!("initial_std.{name}"), std)];
    found.push(Suspect::new(cause, weight, 1.0, knobs, "a constant force acts that the record lacks".to_owned()));
}
