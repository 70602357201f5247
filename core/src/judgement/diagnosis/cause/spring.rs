//! The spring is not linear: it hardens, softens or yields.

use super::{BadFilter, Cause, LikelyCause, Sign};
use crate::{Channel, PlantKind};

pub(super) static CAUSE: Cause = Cause {
    key: "spring",
    name: "a spring that hardens, softens or yields",
    hint: "A linear plant is right for small motions only. Take a plant whose spring has a cubic part, or one that yields.",
    likely_causes,
};

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let believed = bad.filter.plant.unwrap_or(bad.scenario.plant.kind);
    let size = bad.size();
    let Some(place) = bad.case.estimates.place(Channel::NATURAL_FREQUENCY) else { return };
    if size == 0.0 || !size.is_finite() {
        return;
    }
    let frequency = bad.case.estimates.initial_mean(place).abs();
    let weight = 0.4 * bad.effect_of(|one| one.test.name.contains("spectrum") || one.test.name.contains("whiteness"));
    let square = 1.0 / (size * size);
    if believed != PlantKind::DUFFING {
        let key = Channel::CUBIC_STIFFNESS.key();
        let edits = vec![
            bad.edit("plant", PlantKind::DUFFING.key()),
            bad.edit(&format!("initial_mean.{key}"), 0.0),
            bad.edit(&format!("initial_std.{key}"), 0.3 * frequency * frequency * square),
            bad.edit(&format!("process_std.{key}"), 0.0),
        ];
        let sign = Sign {
            channel: Channel::CUBIC_STIFFNESS,
            positive: "the spring hardens: it has a cubic part",
            negative: "the spring softens: it has a negative cubic part",
        };
        let likely = LikelyCause::new(cause, weight, 1.0, edits, "the spring has a cubic part".to_owned());
        found.push(LikelyCause { sign: Some(sign), ..likely });
    }
    if believed != PlantKind::BOUC_WEN {
        let mut edits = vec![bad.edit("plant", PlantKind::BOUC_WEN.key())];
        for channel in [Channel::HYSTERESIS_BETA, Channel::HYSTERESIS_GAMMA] {
            let key = channel.key();
            edits.push(bad.edit(&format!("initial_mean.{key}"), 0.5 * square));
            edits.push(bad.edit(&format!("initial_std.{key}"), 0.4 * square));
            edits.push(bad.edit(&format!("process_std.{key}"), 0.0));
        }
        let key = Channel::HYSTERETIC_DISPLACEMENT.key();
        edits.push(bad.edit(&format!("initial_std.{key}"), 0.5 * size));
        edits.push(bad.edit(&format!("process_std.{key}"), 1e-3 * size));
        let likely = LikelyCause::new(cause, weight, 2.0, edits, "the spring yields".to_owned());
        found.push(LikelyCause { softens: true, ..likely });
    }
}
