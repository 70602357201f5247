//! Length, sampling and randomness of the record.

use egui::{DragValue, Ui};
use kalmanscope_core::Scenario;
use kalmanscope_core::setting::{DT, DURATION, SEED};

use super::lit::lit;
use super::number::{REMARK, limit};
use super::row::scenario_row_ui;

/// Limits the length of a record: a day \[s\].
const LONGEST: f64 = 86_400.0;

/// Lengths with a button \[s\].
const LENGTHS: [(&str, f64); 3] = [("1 min", 60.0), ("1 h", 3600.0), ("1 day", LONGEST)];

pub(super) fn general_ui(ui: &mut Ui, scenario: &mut Scenario) {
    scenario_row_ui(ui, &DURATION, scenario, 1.0);
    ui.horizontal(|ui| {
        ui.add_space(REMARK);
        for (name, length) in LENGTHS {
            if ui.small_button(name).on_hover_text(DURATION.hint).clicked() {
                scenario.duration = length;
            }
        }
    });
    scenario_row_ui(ui, &DT, scenario, DT.slider.0);
    let Scenario { seed, dt, duration, .. } = scenario;
    let longest_step = *duration;
    limit(ui, dt, 0.0, longest_step, "Sampling time, most", "s");
    limit(ui, duration, 0.0, LONGEST, "Duration, most", "s");
    lit(ui, SEED.key, |ui| seed_ui(ui, seed));
}

fn seed_ui(ui: &mut Ui, seed: &mut u64) {
    ui.horizontal(|ui| {
        ui.label("seed").on_hover_text(SEED.hint);
        let drag = ui.add(DragValue::new(seed).range(0..=i64::MAX as u64).speed(0.1));
        ui.ctx().accesskit_node_builder(drag.id, |node| node.set_label("Seed"));
        if ui.button("New noise").clicked() {
            *seed = (*seed + 1) % i64::MAX as u64;
        }
    });
}
