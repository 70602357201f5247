//! The columns of a file with their meaning, in rows.

use std::sync::Arc;

use egui::{Grid, RichText, ScrollArea, TextEdit, Ui};
use kalmanscope_core::import::{MappedColumn, Offset, Table};
use kalmanscope_core::{InputKind, Quantity};

use super::choices::{choice_ui, number_ui};
use super::draft::{Draft, Role};
use crate::text::significant;
use crate::theme::Palette;

const FIRST: usize = 3;
const MOST: usize = 60;

pub(super) fn columns_ui(ui: &mut Ui, draft: &mut Draft, palette: &Palette) {
    let count = draft.file().table.columns.len();
    ScrollArea::horizontal().id_salt("columns").show(ui, |ui| {
        Grid::new("columns").num_columns(10).spacing([12.0, 6.0]).striped(true).show(ui, |ui| {
            for title in ["column", "is", "", "begins with", "unit", "gain", "offset", "late by", "missing is"] {
                ui.weak(title);
            }
            ui.end_row();
            for place in 0..count.min(MOST) {
                column_ui(ui, draft, place, palette);
                ui.end_row();
            }
        });
        if count > MOST {
            ui.weak(format!("{} more columns are left out", count - MOST));
        }
    });
}

fn column_ui(ui: &mut Ui, draft: &mut Draft, place: usize, palette: &Palette) {
    let file = Arc::clone(draft.file());
    let table = &file.table;
    let column = &table.columns[place];
    let name = column.name.clone();
    let begins: Vec<String> = column.values.iter().take(FIRST).map(|value| significant(*value, 3)).collect();
    let text = column.text.as_ref().map(|text| format!("line {}: “{}” is not a number", text.line, text.text));
    let is_empty = table.is_without_numbers(place);
    let label = ui.label(RichText::new(&name).strong());
    if let Some(text) = text {
        label.on_hover_text(text);
    }
    let mut role = draft.role(place);
    let roles = roles(draft);
    if is_empty {
        ui.weak("no numbers");
    } else if choice_ui(ui, &format!("Meaning of {name}"), &mut role, &roles) {
        draft.set_role(place, role);
    }
    let color = if role == Role::Unused { palette.weak } else { palette.truth };
    draft.sparks[place].ui(ui, color);
    ui.weak(begins.join("  "));
    match role {
        Role::Time => unit_ui(ui, &name, &mut draft.mapping.time.unit),
        Role::Input => {
            if let Some(mapped) = &mut draft.mapping.input {
                mapped_ui(ui, &name, mapped, table);
            }
        }
        Role::Sensor(quantity) => {
            if let Some(mapped) = draft.mapping.sensors.get_mut(&quantity) {
                mapped_ui(ui, &name, mapped, table);
            }
        }
        Role::Unused if draft.is_own_clock[place] => {
            ui.weak("times of the next columns");
        }
        Role::Unused => {}
    }
}

fn roles(draft: &Draft) -> Vec<(Role, String)> {
    let input = match draft.input {
        InputKind::Force => "the force over mass",
        InputKind::GroundAcceleration => "the ground's acceleration",
    };
    let quantities = draft.plant.quantities().map(|quantity: Quantity| (Role::Sensor(quantity), quantity.name()));
    let first =
        [(Role::Unused, "left out".to_owned()), (Role::Time, "the time".to_owned()), (Role::Input, input.to_owned())];
    first.into_iter().chain(quantities).collect()
}

fn unit_ui(ui: &mut Ui, name: &str, unit: &mut String) {
    let field = ui.add(TextEdit::singleline(unit).desired_width(44.0).hint_text("unit"));
    field.ctx.accesskit_node_builder(field.id, |node| node.set_label(format!("Unit of {name}")));
}

fn mapped_ui(ui: &mut Ui, name: &str, mapped: &mut MappedColumn, table: &Table) {
    let MappedColumn { column, unit, gain, offset, delay, missing } = mapped;
    unit_ui(ui, name, unit);
    let speed = 0.01 * gain.abs().max(1e-6);
    number_ui(ui, &format!("Gain of {name}"), gain, speed);
    ui.horizontal(|ui| {
        let mut is_mean = *offset == Offset::MEAN;
        let hint = "Subtract the mean: a constant part is no motion";
        if ui.checkbox(&mut is_mean, "mean").on_hover_text(hint).changed() {
            *offset = if is_mean { Offset::MEAN } else { Offset::default() };
        }
        if let Offset::Number(number) = offset {
            number_ui(ui, &format!("Offset of {name}"), number, 0.001);
        }
    });
    let field = ui.add(egui::DragValue::new(delay).suffix(" samples").range(-1000..=1000));
    field.ctx.accesskit_node_builder(field.id, |node| node.set_label(format!("Delay of {name}")));
    ui.horizontal(|ui| {
        let mut on = missing.is_some();
        let check = ui.checkbox(&mut on, "").on_hover_text("Cells with this number have no reading");
        check.ctx.accesskit_node_builder(check.id, |node| node.set_label(format!("Missing number in {name}")));
        if check.changed() {
            let found = || table.place(column).and_then(|place| table.sentinel(place));
            *missing = on.then(|| found().map_or(-9999.0, |found| found.value));
        }
        if let Some(missing) = missing {
            number_ui(ui, &format!("Number for a missing reading in {name}"), missing, 1.0);
        }
    });
}
