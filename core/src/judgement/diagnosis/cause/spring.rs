//! The spring is not linear: it hardens, softens or yields.

use super::{Cause, Matter, Sign, Suspect};
use crate::{Channel, PlantKind};

pub(super) static CAUSE: Cause = Cause {
    key: "spring",
    name: "a spring that hardens, softens or yields",
    hint: "A linear plant is right for small motions only. Take a plant whose spring has a cubic part, or one that yields.",
    suspects,
};

fn suspects(matter: &Matter<'_>, cause: &'static Cause, found: &mut Vec<Suspect>) {
    let believed = matter.filter.plant.unwrap_or(matter.scenario.plant.kind);
    let size = matter.size();
    let Some(place) = matter.case.estimates.place(Channel::NATURAL_FREQUENCY) else { return };
    if size == 0.0 || !size.is_finite() {
        return;
    }
    let frequency = matter.case.estimates.initial_mean(place).abs();
    let weight =
        0.4 * matter.effect_of(|one| one.test.name.contains("spectrum") || one.test.name.contains("whiteness"));
    let square = 1.0 / (size * size);
    if believed != PlantKind::DUFFING {
        let key = Channel::CUBIC_STIFFNESS.key();
        let knobs = vec![
            matter.knob("plant", PlantKind::DUFFING.key()),
            matter.knob(&format!("initial_mean.{key}"), 0.0),
            matter.knob(&format!("initial_std.{key}"), 0.3 * frequency * frequency * square),
            matter.knob(&format!("process_std.{key}"), 0.0),
        ];
        let sign = Sign {
            channel: Channel::CUBIC_STIFFNESS,
            positive: "the spring hardens: it has a cubic part",
            negative: "the spring softens: it has a negative cubic part",
        };
        let suspect = Suspect::new(cause, weight, 1.0, knobs, "the spring has a cubic part".to_owned());
        found.push(Suspect { sign: Some(sign), ..suspect });
    }
    if believed != PlantKind::BOUC_WEN {
        let mut knobs = vec![matter.knob("plant", PlantKind::BOUC_WEN.key())];
        for channel in [Channel::HYSTERESIS_BETA, Channel::HYSTERESIS_GAMMA] {
            let key = channel.key();
            knobs.push(matter.knob(&format!("initial_mean.{key}"), 0.5 * square));
            knobs.push(matter.knob(&format!("initial_std.{key}"), 0.4 * square));
            knobs.push(matter.knob(&format!("process_std.{key}"), 0.0));
        }
        let key = Channel::HYSTERETIC_DISPLACEMENT.key();
        knobs.push(matter.knob(&format!("initial_std.{key}"), 0.5 * size));
        knobs.push(matter.knob(&format!("process_std.{key}"), 1e-3 * size));
        let suspect = Suspect::new(cause, weight, 2.0, knobs, "the spring yields".to_owned());
        found.push(Suspect { softens: true, ..suspect });
    }
}
