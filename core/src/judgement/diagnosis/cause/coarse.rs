//! A sensor reads in steps that are larger than its noise.

use super::{BadFilter, Cause, LikelyCause};
use crate::data::import::Length;
use crate::judgement::diagnosis::readings::Readings;
use crate::judgement::diagnosis::words::short;

/// The least step, in assumed standard deviations of the noise, that matters.
const LEAST: f64 = 2.0;

pub(super) static CAUSE: Cause = Cause {
    key: "coarse",
    name: "the coarse steps of a sensor",
    hint: "A converter with few bits rounds each reading to a step. The rounding is a noise of a twelfth of the step squared: give it \
           to R.",
    likely_causes,
};

/// Adds the variance of rounding to R: a step squared over twelve (Widrow and Kollár 2008, *Quantization Noise*).
fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let length = Length::of(bad.scenario.record.as_ref());
    let mut stds = bad.filter.sensor_std.clone();
    let (mut told, mut most) = (Vec::new(), 0.0_f64);
    for (place, one) in bad.case.sensors.iter().enumerate() {
        let Some(step) = Readings::of(bad.case, place).and_then(|readings| readings.step()) else { continue };
        let own = stds[place];
        // A filter that knows of the rounding has a larger σ.
        if step < LEAST * own {
            continue;
        }
        stds[place] = (own * own + step * step / 12.0).sqrt();
        most = most.max(step / own);
        told.push(format!(
            "the {} reads in steps of {} {}, {} times the σ that is assumed",
            one.sensor.key(),
            short(step),
            length.in_place_of(one.sensor.unit()),
            short(step / own)
        ));
    }
    if told.is_empty() {
        return;
    }
    let edits = vec![bad.edit("sensor_std", stds)];
    let likely = LikelyCause::new(cause, 1.0 - 1.0 / most, told.len() as f64, edits, told.join(", "));
    found.push(LikelyCause { certain: true, ..likely });
}
