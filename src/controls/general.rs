//! Length, sampling and randomness of the record.

use egui::{DragValue, Ui};
use kalmanscope_core::Scenario;

use super::number::Number;

/// Samples of the longest record: what a browser recomputes in the blink of an eye, and keeps in 60 MB a filter.
const LONGEST: f64 = 200_000.0;

pub(super) fn general_ui(ui: &mut Ui, scenario: &mut Scenario) {
    let Scenario { seed, dt, duration, .. } = scenario;
    let hint = "Length of the record";
    Number {
        label: "duration",
        name: "Duration",
        unit: "s",
        range: (5.0, 120.0),
        least: 1.0,
        logarithmic: false,
        hint,
    }
    .show(ui, duration);
    let hint = "Time between samples";
    Number {
        label: "Δt sampling",
        name: "Sampling time",
        unit: "s",
        range: (0.002, 0.1),
        least: 0.002,
        logarithmic: true,
        hint,
    }
    .show(ui, dt);
    *dt = dt.min(*duration);
    *duration = duration.min(LONGEST * *dt);
    ui.horizontal(|ui| {
        ui.label("seed").on_hover_text("The same seed gives the same noise, on every machine");
        let drag = ui.add(DragValue::new(seed).range(0..=i64::MAX as u64).speed(0.1));
        ui.ctx().accesskit_node_builder(drag.id, |node| node.set_label("Seed"));
        if ui.button("New noise").clicked() {
            *seed = (*seed + 1) % i64::MAX as u64;
        }
    });
}
