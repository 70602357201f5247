//! The input is scaled wrongly.

use super::{Cause, Matter, Suspect};
use crate::Channel;

pub(super) static CAUSE: Cause = Cause {
    key: "input_gain",
    name: "the gain of the input",
    hint: "The record's input is not the force over mass: another unit, a mass, a calibration. Let the filter estimate its gain.",
    suspects,
};

fn suspects(matter: &Matter<'_>, cause: &'static Cause, found: &mut Vec<Suspect>) {
    if matter.input_size() == 0.0 || matter.filter.augment.contains(&Channel::INPUT_GAIN) {
        return;
    }
    let case = matter.case;
    let broad = case.sensors.iter().flat_map(|one| one.cross_correlation(&case.kept)[5..].to_vec());
    let broad = broad.fold(0.0, |a: f64, b| a.max(b.abs()));
    let weight = 1.5 * broad / (1.0 + 1.5 * broad);
    let name = Channel::INPUT_GAIN.key();
    let knobs = vec![matter.augmented(Channel::INPUT_GAIN), matter.knob(&format!("initial_std.{name}"), 0.5)];
    found.push(Suspect::new(cause, weight, 1.0, knobs, "the input has another gain".to_owned()));
}
