//! The plant has a mode that the model lacks.

use super::{Cause, Matter, Suspect};
use crate::judgement::diagnosis::evidence::Subject;
use crate::judgement::diagnosis::periodogram::Periodogram;
use crate::judgement::diagnosis::words::short;
use crate::{Channel, PlantKind, Quantity};

/// The stiffness of both storeys over the square of the lower frequency of two equal storeys: `(1 + √5)² / 4`.
const STIFFNESS: f64 = 2.618;

pub(super) static CAUSE: Cause = Cause {
    key: "missing_mode",
    name: "a mode that the model lacks",
    hint: "A line in the spectrum of the innovations is a resonance that the model does not have. Take a plant with one mass more.",
    suspects,
};

fn suspects(matter: &Matter<'_>, cause: &'static Cause, found: &mut Vec<Suspect>) {
    let believed = matter.filter.plant.unwrap_or(matter.scenario.plant.kind);
    let Some(place) = matter.case.estimates.place(Channel::NATURAL_FREQUENCY) else { return };
    if believed.masses() != 1 {
        return;
    }
    let case = matter.case;
    let lines = case.sensors.iter().filter_map(|one| {
        let (power, turn) = one.periodogram.peak()?;
        Some((power / one.periodogram.mean(), turn / case.record.dt(), one.sensor))
    });
    let line = lines.max_by(|a, b| a.0.total_cmp(&b.0));
    let weight = 0.6 * matter.effect_of(|one| one.test.name.contains("spectrum") && one.subject != Subject::All);
    let when = line.map_or(String::new(), |(_, frequency, _)| format!(", near {} rad/s", short(frequency)));
    // The first mode, as far as the filter and the measurements know it.
    let mut frequencies = vec![case.estimates.initial_mean(place).abs()];
    frequencies.extend(measured_peak(matter));
    for frequency in frequencies {
        let stiffness = STIFFNESS * frequency * frequency;
        let mut knobs = vec![matter.knob("plant", PlantKind::SHEAR_2.key())];
        for mass in 0..2 {
            let key = Channel::stiffness(mass).key();
            knobs.push(matter.knob(&format!("initial_mean.{key}"), stiffness));
            knobs.push(matter.knob(&format!("initial_std.{key}"), 0.3 * stiffness));
            knobs.push(matter.knob(&format!("process_std.{key}"), 0.0));
        }
        let key = Channel::STOREY_DAMPING.key();
        knobs.push(matter.knob(&format!("initial_mean.{key}"), 0.1 * frequency));
        knobs.push(matter.knob(&format!("initial_std.{key}"), 0.1 * frequency));
        knobs.push(matter.knob(&format!("process_std.{key}"), 0.0));
        for (first, second) in
            [(Channel::DISPLACEMENT, Channel::displacement(1)), (Channel::VELOCITY, Channel::velocity(1))]
        {
            knobs.push(matter.knob(&format!("initial_std.{}", second.key()), matter.filter.initial_std[first]));
            knobs.push(matter.knob(&format!("process_std.{}", second.key()), matter.filter.process_std[first]));
        }
        found.push(Suspect::new(cause, weight, 1.0, knobs, format!("the model lacks a mode{when}")));
    }
}

/// The frequency with the most power in the measurements \[rad/s\].
fn measured_peak(matter: &Matter<'_>) -> Option<f64> {
    let record = matter.case.record;
    let quantity = matter
        .case
        .sensors
        .iter()
        .map(|one| one.sensor)
        .find(|&sensor| sensor == Quantity::DISPLACEMENT || sensor == Quantity::VELOCITY)?;
    let values: Vec<f64> =
        record.measured_quantity(quantity)?.iter().map(|x| if x.is_nan() { 0.0 } else { *x }).collect();
    let all = 0..values.len();
    let (_, turn) = Periodogram::of_all(&[&values], &[all]).first()?.peak()?;
    Some(turn / record.dt())
}
