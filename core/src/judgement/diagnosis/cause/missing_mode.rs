//! The plant has a mode that the model lacks.

use super::{BadFilter, Cause, LikelyCause};
use crate::judgement::diagnosis::evidence::Subject;
use crate::judgement::diagnosis::words::short;
use crate::{Channel, PlantKind};

/// The stiffness of both storeys over the square of the lower frequency of two equal storeys: `(1 + √5)² / 4`.
const STIFFNESS: f64 = 2.618;

pub(super) static CAUSE: Cause = Cause {
    key: "missing_mode",
    name: "a mode that the model lacks",
    hint: "A line in the spectrum of the innovations is a resonance that the model does not have. Take a plant with one mass more.",
    likely_causes,
};

fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let believed = bad.filter.plant.unwrap_or(bad.scenario.plant.kind);
    let Some(place) = bad.case.estimates.place(Channel::NATURAL_FREQUENCY) else { return };
    if believed.masses() != 1 {
        return;
    }
    let weight = 0.6 * bad.effect_of(|one| one.test.name.contains("spectrum") && one.subject != Subject::All);
    let when = bad.line().map_or(String::new(), |(_, frequency)| format!(", near {} rad/s", short(frequency)));
    // The first mode, as far as the filter and the measurements know it.
    let mut frequencies = vec![bad.case.estimates.initial_mean(place).abs()];
    frequencies.extend(bad.measured_peak());
    for frequency in frequencies {
        let stiffness = STIFFNESS * frequency * frequency;
        let mut edits = vec![bad.edit("plant", PlantKind::SHEAR_2.key())];
        for mass in 0..2 {
            let key = Channel::stiffness(mass).key();
            edits.push(bad.edit(&format!("initial_mean.{key}"), stiffness));
            edits.push(bad.edit(&format!("initial_std.{key}"), 0.3 * stiffness));
            edits.push(bad.edit(&format!("process_std.{key}"), 0.0));
        }
        let key = Channel::STOREY_DAMPING.key();
        edits.push(bad.edit(&format!("initial_mean.{key}"), 0.1 * frequency));
        edits.push(bad.edit(&format!("initial_std.{key}"), 0.1 * frequency));
        edits.push(bad.edit(&format!("process_std.{key}"), 0.0));
        for (first, second) in
            [(Channel::DISPLACEMENT, Channel::displacement(1)), (Channel::VELOCITY, Channel::velocity(1))]
        {
            edits.push(bad.edit(&format!("initial_std.{}", second.key()), bad.filter.initial_std[first]));
            edits.push(bad.edit(&format!("process_std.{}", second.key()), bad.filter.process_std[first]));
        }
        let likely = LikelyCause::new(cause, weight, 1.0, edits, format!("the model lacks a mode{when}"));
        found.push(LikelyCause { renews_guess: true, ..likely });
    }
}
