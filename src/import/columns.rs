//! The columns of a file with their meaning, and time, part, band, and the distance of the samples.

use std::sync::Arc;

use egui::{ComboBox, DragValue, Grid, RichText, ScrollArea, TextEdit, Ui};
use kalmanscope_core::import::{MappedColumn, Offset, Table, Time};
use kalmanscope_core::{ForcedMass, InputKind, PlantKind, Quantity};

use super::draft::{ColumnRole, Draft};
use crate::equation;
use crate::theme::Palette;
use crate::widgets::named;

const MOST: usize = 60;

pub(super) fn columns_ui(ui: &mut Ui, draft: &mut Draft, palette: &Palette) {
    let count = draft.file.table.columns.len();
    ScrollArea::horizontal().id_salt("columns").show(ui, |ui| {
        Grid::new("columns").num_columns(8).spacing([12.0, 6.0]).striped(true).show(ui, |ui| {
            for title in ["column", "is", "", "unit", "gain", "offset", "late by", "missing is"] {
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
    let file = Arc::clone(&draft.file);
    let table = &file.table;
    let column = &table.columns[place];
    let name = column.name.clone();
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
    let color = if role == ColumnRole::Unused { palette.weak } else { palette.truth };
    draft.sparks[place].ui(ui, color);
    match role {
        ColumnRole::Time => unit_ui(ui, &name, &mut draft.mapping.time.unit),
        ColumnRole::Input => {
            if let Some(mapped) = &mut draft.mapping.input {
                mapped_ui(ui, &name, mapped, table);
            }
        }
        ColumnRole::ForceOn(mass) => {
            if let Some(mapped) = draft.mapping.forces.get_mut(&mass) {
                mapped_ui(ui, &name, mapped, table);
            }
        }
        ColumnRole::Sensor(quantity) => {
            if let Some(mapped) = draft.mapping.sensors.get_mut(&quantity) {
                mapped_ui(ui, &name, mapped, table);
            }
        }
        ColumnRole::Unused if draft.guesses[place].is_own_clock() => {
            ui.weak("times of the next columns");
        }
        ColumnRole::Unused => {}
    }
}

fn roles(draft: &Draft) -> Vec<(ColumnRole, String)> {
    let input = match draft.input {
        InputKind::Force => "the force",
        InputKind::GroundAcceleration => "the ground's acceleration",
    };
    let quantities = draft.plant.quantities().map(|quantity: Quantity| (ColumnRole::Sensor(quantity), quantity.name()));
    let forces = (0..draft.plant.masses()).filter_map(ForcedMass::new);
    let forces = forces.map(|mass| (ColumnRole::ForceOn(mass), mass.name()));
    let first = [(ColumnRole::Unused, "left out"), (ColumnRole::Time, "the time"), (ColumnRole::Input, input)];
    first.map(|(role, words)| (role, words.to_owned())).into_iter().chain(quantities).chain(forces).collect()
}

fn unit_ui(ui: &mut Ui, name: &str, unit: &mut String) {
    named(ui.add(TextEdit::singleline(unit).desired_width(44.0).hint_text("unit")), format!("Unit of {name}"));
}

fn mapped_ui(ui: &mut Ui, name: &str, mapped: &mut MappedColumn, table: &Table) {
    let MappedColumn { column, unit, gain, offset, delay, missing } = mapped;
    unit_ui(ui, name, unit);
    let speed = 0.01 * gain.abs().max(1e-6);
    number_ui(ui, &format!("Gain of {name}"), gain, speed);
    ui.horizontal(|ui| {
        let mut is_mean = *offset == Offset::MEAN;
        let hint = "Subtract the mean: a constant part is no motion";
        if ui.checkbox(&mut is_mean, "its mean").on_hover_text(hint).changed() {
            *offset = if is_mean { Offset::MEAN } else { Offset::default() };
        }
        if let Offset::Number(number) = offset {
            number_ui(ui, &format!("Offset of {name}"), number, 0.001);
        }
    });
    named(ui.add(egui::DragValue::new(delay).suffix(" samples").range(-1000..=1000)), format!("Delay of {name}"));
    ui.horizontal(|ui| {
        let mut on = missing.is_some();
        let check = ui.checkbox(&mut on, "a number").on_hover_text("Cells with this number have no reading");
        let check = named(check, format!("Missing number in {name}"));
        if check.changed() {
            let found = || table.place(column).and_then(|place| table.sentinel(place));
            *missing = on.then(|| found().map_or(-9999.0, |found| found.value));
        }
        if let Some(missing) = missing {
            number_ui(ui, &format!("Number for a missing reading in {name}"), missing, 1.0);
        }
    });
}

pub(super) fn meaning_ui(ui: &mut Ui, draft: &mut Draft) {
    ui.horizontal_wrapped(|ui| {
        if draft.mapping.time.column.is_none() {
            let mut rate = draft.mapping.time.rate.unwrap_or(0.0);
            ui.label("samples in a second");
            number_ui(ui, "Sample rate", &mut rate, 0.5);
            ui.label("Hz");
            draft.mapping.time = Time { rate: (rate > 0.0).then_some(rate), ..Time::default() };
            ui.separator();
        }
        ui.label("the input is");
        let kinds = [
            (Some(InputKind::Force), "a force".to_owned()),
            (Some(InputKind::GroundAcceleration), "the ground's acceleration".to_owned()),
            (None, "nothing: it was not recorded".to_owned()),
        ];
        let mut kind = Some(draft.input).filter(|_| !draft.mapping.no_input);
        if choice_ui(ui, "Kind of input", &mut kind, &kinds) {
            draft.set_input(kind);
        }
        ui.separator();
        ui.label("the filters assume");
        let own = if draft.plant.own_equation().is_some() { Some(draft.plant.clone()) } else { equation::first() };
        let plants = PlantKind::ALL.into_iter().chain(own).map(|kind| (kind.clone(), kind.name().to_owned()));
        let plants: Vec<_> = plants.collect();
        choice_ui(ui, "Plant of the record", &mut draft.plant, &plants);
    });
}

const SHORTEST: f64 = 1e-6;

pub(super) fn conditioning_ui(ui: &mut Ui, draft: &mut Draft) {
    let made = draft.outcome().and_then(Result::ok);
    let end = made.map_or(10.0, |imported| imported.record.time(imported.record.len().saturating_sub(1)));
    let dt = made.map_or(0.01, |imported| imported.record.dt());
    let has_clocks = made.is_some_and(|imported| imported.record.clocks().is_some());
    egui::CollapsingHeader::new("Part, band and rate").id_salt("conditioning").show(ui, |ui| {
        let mapping = &mut draft.mapping;
        if has_clocks || mapping.time.even {
            let hint = "The samples are equally spaced, and only their times are not";
            ui.checkbox(&mut mapping.time.even, "at even steps").on_hover_text(hint);
        }
        // It stays while the steps are too short for a record.
        if has_clocks || mapping.time.dt.is_some() {
            ui.horizontal_wrapped(|ui| optional_ui(ui, "steps of", &mut mapping.time.dt, (dt, 0.01 * dt), "s"));
            mapping.time.dt.iter_mut().for_each(|dt| *dt = dt.max(SHORTEST));
        }
        ui.horizontal_wrapped(|ui| {
            optional_ui(ui, "from", &mut mapping.from, (0.0, 0.1), "s");
            optional_ui(ui, "to", &mut mapping.to, (end, 0.1), "s");
        });
        ui.horizontal_wrapped(|ui| {
            let mut on = mapping.band.is_some();
            let hint = "Butterworth filters of the fourth order, run forward and backward over input and sensors: nothing is shifted";
            if ui.checkbox(&mut on, "band-pass").on_hover_text(hint).changed() {
                mapping.band = on.then_some([0.0, 0.25 / dt]);
            }
            if let Some([low, high]) = &mut mapping.band {
                number_ui(ui, "Band from [Hz]", low, 0.1);
                ui.label("to");
                number_ui(ui, "Band to [Hz]", high, 0.1);
                ui.label("Hz");
            }
        });
        ui.horizontal_wrapped(|ui| {
            ui.label("keep one of every").on_hover_text("After a low-pass below the new Nyquist frequency");
            whole_ui(ui, "Keep one of every", &mut mapping.every, 1..=1000);
            ui.label("samples");
        });
    });
}

pub(super) fn number_ui(ui: &mut Ui, name: &str, value: &mut f64, speed: f64) {
    named(ui.add(DragValue::new(value).speed(speed).max_decimals(12)), name.to_owned());
}

pub(super) fn whole_ui(ui: &mut Ui, name: &str, value: &mut usize, range: std::ops::RangeInclusive<usize>) {
    named(ui.add(DragValue::new(value).range(range)), name.to_owned());
}

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

pub(super) fn choice_ui<T: Clone + PartialEq>(ui: &mut Ui, name: &str, value: &mut T, all: &[(T, String)]) -> bool {
    let before = value.clone();
    let text = all.iter().find(|(one, _)| one == value).map_or("", |(_, text)| text);
    let combo = ComboBox::from_id_salt(name).selected_text(text).show_ui(ui, |ui| {
        for (one, text) in all {
            ui.selectable_value(value, one.clone(), text);
        }
    });
    named(combo.response, name.to_owned());
    *value != before
}
