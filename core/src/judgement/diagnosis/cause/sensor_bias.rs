//! A sensor has a bias, or drifts.

use super::{BadFilter, Cause, LikelyCause};

/// The initial standard deviation of a bias, relative to that of the noise.
const WIDE: f64 = 10.0;

pub(super) static CAUSE: Cause = Cause {
    key: "sensor_bias",
    name: "a sensor's bias or drift",
    hint: "A zero that is off, or wanders. Let the filter estimate it; with a process noise if it drifts.",
    likely_causes,
};

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let case = bad.case;
    for (one, std) in case.sensors.iter().zip(&bad.filter.sensor_std) {
        let bias = one.sensor.bias();
        if bad.filter.augment.contains(&bias) {
            continue;
        }
        let mean = one.mean(&case.kept).abs();
        let (key, name) = (bias.key(), one.sensor.key());
        let still = vec![bad.augmented(bias), bad.edit(&format!("initial_std.{key}"), WIDE * std)];
        let step = WIDE * std / (case.len().max(1) as f64).sqrt();
        let mut drifting = still.clone();
        drifting.push(bad.edit(&format!("process_std.{key}"), step));
        let weight = 2.0 * mean / (1.0 + 2.0 * mean);
        found.push(LikelyCause::new(cause, weight, 1.0, still, format!("the {name} has a bias")));
        found.push(LikelyCause::new(cause, 0.8 * weight, 2.0, drifting, format!("the bias of the {name} drifts")));
    }
}
