//! Fields for numbers that may be left out, and choices among a few words.

use egui::{ComboBox, DragValue, Ui};

pub(super) fn number_ui(ui: &mut Ui, name: &str, value: &mut f64, speed: f64) {
    let field = ui.add(DragValue::new(value).speed(speed).max_decimals(12));
    field.ctx.accesskit_node_builder(field.id, |node| node.set_label(name.to_owned()));
}

pub(super) fn whole_ui(ui: &mut Ui, name: &str, value: &mut usize, range: std::ops::RangeInclusive<usize>) {
    let field = ui.add(DragValue::new(value).range(range));
    field.ctx.accesskit_node_builder(field.id, |node| node.set_label(name.to_owned()));
}

/// A check box that gives a number its value, and a field while it has one, which moves by `speed` for each point.
pub(super) fn optional_ui(ui: &mut Ui, name: &str, value: &mut Option<f64>, (usual, speed): (f64, f64), unit: &str) {
    let mut on = value.is_some();
    if ui.checkbox(&mut on, name).changed() {
        *value = on.then_some(usual);
    }
    if let Some(value) = value {
        number_ui(ui, &format!("{name} [{unit}]"), value, speed);
        ui.label(unit);
    }
}

pub(super) fn choice_ui<T: Copy + PartialEq>(ui: &mut Ui, name: &str, value: &mut T, all: &[(T, String)]) -> bool {
    let before = *value;
    let text = all.iter().find(|(one, _)| one == value).map_or("", |(_, text)| text);
    let combo = ComboBox::from_id_salt(name).selected_text(text).show_ui(ui, |ui| {
        for (one, text) in all {
            ui.selectable_value(value, *one, text);
        }
    });
    ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label(name.to_owned()));
    *value != before
}
