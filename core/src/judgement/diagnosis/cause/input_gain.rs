//! The input is scaled wrongly.

use super::{BadFilter, Cause, LikelyCause, rms};
use crate::{Channel, Quantity};

pub(super) static CAUSE: Cause = Cause {
    key: "input_gain",
    name: "the gain of the input",
    hint: "The record's input is not the force over mass: another unit, a mass, a calibration. Let the filter estimate its gain.",
    likely_causes,
};

/// Gains of an input in about the unit that it should have, as the sizes of input and motion tell them roughly.
const FEW: std::ops::Range<f64> = 0.03..30.0;

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    if bad.input_size() == 0.0 || bad.filter.augment.contains(&Channel::INPUT_GAIN) {
        return;
    }
    let case = bad.case;
    let broad = case.sensors.iter().flat_map(|one| one.cross_correlation(&case.kept)[5..].to_vec());
    let broad = broad.fold(0.0, |a: f64, b| a.max(b.abs()));
    let weight = 1.5 * broad / (1.0 + 1.5 * broad);
    let name = Channel::INPUT_GAIN.key();
    let mut edits = vec![bad.augmented(Channel::INPUT_GAIN)];
    // The gain with which the input as it is would carry the spring: of another unit, one of about 1 is out of reach.
    let frequency = case.estimates.place(Channel::NATURAL_FREQUENCY).map(|place| case.estimates.initial_mean(place));
    let load = |wn: f64| {
        let of = |(quantity, by): (Quantity, f64)| Some((case.record.measured_quantity(quantity)?, by));
        let orders = [(Quantity::DISPLACEMENT, wn * wn), (Quantity::VELOCITY, wn), (Quantity::ACCELERATION, 1.0)];
        let (measured, by) = orders.into_iter().find_map(of)?;
        Some(by * rms(&measured[case.samples.clone()]))
    };
    let ratio = frequency.and_then(load).map_or(1.0, |load| load / bad.input_size());
    if ratio.is_normal() && !FEW.contains(&ratio) {
        edits.push(bad.edit(&format!("initial_mean.{name}"), 0.5 * ratio));
        edits.push(bad.edit(&format!("initial_std.{name}"), ratio));
    } else {
        edits.push(bad.edit(&format!("initial_std.{name}"), 0.5));
    }
    found.push(LikelyCause::new(cause, weight, 1.0, edits, "the input has another gain".to_owned()));
}
