//! The record has no information on the parameters.

use super::{BadFilter, Cause, LikelyCause};
use crate::Quantity;
use crate::judgement::diagnosis::verdict_kind::VerdictKind;

/// Limits the correlation at lag 1 of readings that are only noise.
const WHITE: f64 = 0.3;

/// Limits the mean square of readings that are only noise, over R.
const NOISE: f64 = 1.5;

pub(super) static CAUSE: Cause = Cause {
    key: "no_excitation",
    name: "too little excitation",
    hint: "Parameters are learnt from motion. Shake the oscillator, near its resonance; until then do not let the memory fade.",
    likely_causes,
};

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let of = [VerdictKind::NotIdentifiable, VerdictKind::WoundUp];
    let still = is_still(bad);
    let weight = bad.effect_of(|one| of.contains(&one.speaks_for)).max(if still { 0.8 } else { 0.0 });
    if weight == 0.0 {
        return;
    }
    let samples =
        bad.evidence.iter().find(|one| one.counts && of.contains(&one.speaks_for)).map(|one| one.samples.clone());
    let sentence = "the motion is too small against the noise to tell the parameters".to_owned();
    found.push(LikelyCause {
        certain: true,
        samples,
        ..LikelyCause::new(cause, 0.9 * weight, 0.0, Vec::new(), sentence)
    });
}

/// Whether the sensors read only noise: white, and of the size R. An accelerometer under a broadband force also reads a
/// white signal, but a much larger one.
fn is_still(bad: &BadFilter<'_>) -> bool {
    let is_noise = |sensor: Quantity| {
        let Some(values) = bad.case.record.measured_quantity(sensor) else { return true };
        let both = values.windows(2).filter(|pair| !(pair[0] * pair[1]).is_nan());
        let (product, square, count) = both.fold((0.0, 0.0, 0_u32), |(product, square, count), pair| {
            (product + pair[0] * pair[1], square + pair[0] * pair[0], count + 1)
        });
        let place = bad.scenario.sensors.iter().position(|one| one.measures == sensor);
        let std = place.and_then(|place| bad.filter.sensor_std.get(place));
        let is_small = std.is_none_or(|std| square <= NOISE * std * std * f64::from(count));
        square <= 0.0 || (product < WHITE * square && is_small)
    };
    let mut sensors = bad.case.sensors.iter().peekable();
    sensors.peek().is_some() && sensors.all(|one| is_noise(one.sensor))
}
