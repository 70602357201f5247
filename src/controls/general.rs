//! Length, sampling and randomness of the record.

use egui::{DragValue, Ui};
use kalmanscope_core::Scenario;

use super::lit::lit;
use super::number::{Number, REMARK, limit};

/// Limits the length of a record: a day \[s\].
const LONGEST: f64 = 86_400.0;

/// Lengths with a button \[s\].
const LENGTHS: [(&str, f64); 3] = [("1 min", 60.0), ("1 h", 3600.0), ("1 day", LONGEST)];

pub(super) fn general_ui(ui: &mut Ui, scenario: &mut Scenario) {
    let Scenario { seed, dt, duration, .. } = scenario;
    let hint = "Length of the record, up to a day; a long one is shown live only, and its beginning is forgotten";
    let length = Number {
        label: "duration",
        name: "Duration".into(),
        unit: "s",
        range: (5.0, 120.0),
        least: 1.0,
        logarithmic: false,
        hint,
    };
    lit(ui, "duration", |ui| length.show(ui, duration));
    ui.horizontal(|ui| {
        ui.add_space(REMARK);
        for (name, length) in LENGTHS {
            if ui.small_button(name).on_hover_text(hint).clicked() {
                *duration = length;
            }
        }
    });
    let hint = "Time between samples";
    let sampling = Number {
        label: "Δt sampling",
        name: "Sampling time".into(),
        unit: "s",
        range: (0.002, 0.1),
        least: 0.002,
        logarithmic: true,
        hint,
    };
    lit(ui, "dt", |ui| sampling.show(ui, dt));
    let longest_step = *duration;
    limit(ui, dt, 0.0, longest_step, "Sampling time, most", "s");
    limit(ui, duration, 0.0, LONGEST, "Duration, most", "s");
    lit(ui, "seed", |ui| seed_ui(ui, seed));
}

/// The seed of the random numbers, and a button for the next.
fn seed_ui(ui: &mut Ui, seed: &mut u64) {
    ui.horizontal(|ui| {
        ui.label("seed").on_hover_text("The same seed gives the same noise, on every machine");
        let drag = ui.add(DragValue::new(seed).range(0..=i64::MAX as u64).speed(0.1));
        ui.ctx().accesskit_node_builder(drag.id, |node| node.set_label("Seed"));
        if ui.button("New noise").clicked() {
            *seed = (*seed + 1) % i64::MAX as u64;
        }
    });
}
