//! The input is scaled wrongly.

use super::{BadFilter, Cause, LikelyCause};
use crate::Channel;

pub(super) static CAUSE: Cause = Cause {
    key: "input_gain",
    name: "the gain of the input",
    hint: "The record's input is not the force over mass: another unit, a mass, a calibration. Let the filter estimate its gain.",
    likely_causes,
};

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    if bad.input_size() == 0.0 || bad.filter.augment.contains(&Channel::INPUT_GAIN) {
        return;
    }
    let case = bad.case;
    let broad = case.sensors.iter().flat_map(|one| one.cross_correlation(&case.kept)[5..].to_vec());
    let broad = broad.fold(0.0, |a: f64, b| a.max(b.abs()));
    let weight = 1.5 * broad / (1.0 + 1.5 * broad);
    let name = Channel::INPUT_GAIN.key();
    let edits = vec![bad.augmented(Channel::INPUT_GAIN), bad.edit(&format!("initial_std.{name}"), 0.5)];
    found.push(LikelyCause::new(cause, weight, 1.0, edits, "the input has another gain".to_owned()));
}
