//! The measured record: its file, its input between samples, and what of it is used.

use egui::Ui;
use kalmanscope_core::import::Mapping;
use kalmanscope_core::{Hold, Scenario};

use super::Asked;
use super::equation::equation_ui;
use crate::session::{Library, name_of};

pub(super) fn record_ui(ui: &mut Ui, scenario: &mut Scenario, library: &Library, asked: &mut Vec<Asked>) {
    equation_ui(ui, scenario, asked);
    let Scenario { record: Some(mapping), hold, .. } = scenario else { return };
    let name = name_of(mapping).to_owned();
    ui.label(format!("“{name}”"));
    for line in lines(mapping) {
        ui.weak(line);
    }
    if library.file(mapping).is_none() {
        ui.label("The file is not here: drop it on the window.");
    }
    ui.horizontal(|ui| {
        ui.label("input").on_hover_text("A measured input is not held between its samples; H compares");
        ui.selectable_value(hold, Hold::First, "linear between samples");
        ui.selectable_value(hold, Hold::Zero, "held");
    });
    ui.horizontal_wrapped(|ui| {
        if ui.button("Columns…").on_hover_text("Another meaning of the columns, another part, band or rate").clicked()
        {
            asked.push(Asked::Columns);
        }
        if ui.button("Simulate instead").on_hover_text("Leave the record and simulate the truth").clicked() {
            scenario.record = None;
        }
    });
    if let Some(problem) = library.problem() {
        ui.colored_label(ui.visuals().warn_fg_color, problem);
    }
    for reason in library.reasons() {
        ui.weak(format!("• {reason}"));
    }
    ui.weak("Truth, force and duration of the scenario have no effect here, but for the kind of plant.");
}

fn lines(mapping: &Mapping) -> Vec<String> {
    let Mapping { input, sensors, from, to, band, every, interpolate, .. } = mapping;
    let input = input.iter().map(|input| format!("input: {} × {}", input.column, input.gain));
    let sensors = sensors.iter().map(|(quantity, column)| format!("{}: {}", quantity.name(), column.column));
    let part = (from.is_some() || to.is_some()).then(|| {
        let text = |time: &Option<f64>| time.map_or_else(String::new, |time| format!(" {time} s"));
        format!("part:{} to{}", text(from), text(to))
    });
    let band = band.map(|[low, high]| format!("band: {low} to {high} Hz"));
    let rate = (*every > 1).then(|| format!("one sample of {every}"));
    let finer = (*interpolate > 1).then(|| format!("{interpolate} steps in place of one"));
    input.chain(sensors).chain([part, band, rate, finer].into_iter().flatten()).collect()
}
