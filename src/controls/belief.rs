//! A filter's initial belief and assumed noise: initial mean and std, Q and R.

use egui::{Grid, Response, RichText, Ui, Vec2};
use kalmanscope_core::import::Length;
use kalmanscope_core::setting::{Entry, INITIAL_MEAN, INITIAL_STD, PROCESS_STD, SENSOR_STD, TableInfo};
use kalmanscope_core::{Channel, FilterSettings, InputKind, PlantKind, Sensor};

use super::lit::lit;
use super::number::{Named, field, std_field, tell_hertz};

/// Width of the column of symbols \[points\].
const SYMBOL_WIDTH: f32 = 22.0;
/// Width of the column of units \[points\].
const UNIT_WIDTH: f32 = 36.0;

pub(super) fn belief_ui(
    ui: &mut Ui,
    filter: &mut FilterSettings,
    sensors: &[Sensor],
    truth: PlantKind,
    length: Length,
) {
    let channels = filter.model(truth, InputKind::Force).channels().to_vec();
    let spacing = ui.spacing().item_spacing.x;
    let column = ((ui.available_width() - SYMBOL_WIDTH - UNIT_WIDTH - 4.0 * spacing) / 3.0).max(36.0);
    let cell = |ui: &mut Ui, enabled: bool, add: &mut dyn FnMut(&mut Ui)| {
        ui.allocate_ui(Vec2::new(column, ui.spacing().interact_size.y), |ui| {
            ui.set_width(column);
            ui.add_enabled_ui(enabled, |ui| add(ui));
        });
    };
    let heading = |ui: &mut Ui, text: &str, hint: &str| {
        ui.label(RichText::new(text).small().weak()).on_hover_text(hint);
    };

    Grid::new(("belief", filter.id)).num_columns(5).min_col_width(0.0).spacing(Vec2::new(spacing, 4.0)).show(
        ui,
        |ui| {
            ui.label("");
            heading(ui, "initial guess", "Mean of the initial belief");
            heading(
                ui,
                "± σ of guess",
                "Standard deviation of the initial belief: how sure the filter is of its guess",
            );
            heading(ui, "√Q per step", "Standard deviation of the model's error in one step");
            ui.end_row();
            for &channel in &channels {
                // The parameters of a KF are known and have no uncertainty to set.
                let is_known = filter.knows(channel);
                ui.label(channel.symbol()).on_hover_text(channel.name());
                for (table, scale) in [(&INITIAL_MEAN, 1.0), (&INITIAL_STD, 10.0), (&PROCESS_STD, 1.0)] {
                    let scale = scale * self::scale(channel);
                    cell(ui, !is_known || *table == INITIAL_MEAN, &mut |ui| {
                        entry_ui(ui, filter, table, Entry::Channel(channel), sensors, scale);
                    });
                }
                let unit = unit_ui(ui, length.in_place_of(channel.unit()));
                tell_hertz(unit, filter.initial_mean[channel], channel.unit(), "The guess is");
                ui.end_row();
            }
            for quantity in sensors.iter().map(|sensor| sensor.measures) {
                ui.label(quantity.symbol()).on_hover_text(format!("{} sensor", quantity.key()));
                ui.label("");
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    let symbol = RichText::new(SENSOR_STD.symbol).small().weak();
                    ui.label(symbol).on_hover_text("What the filter takes the noise to be");
                });
                cell(ui, true, &mut |ui| entry_ui(ui, filter, &SENSOR_STD, Entry::Sensor(quantity), sensors, 10.0));
                unit_ui(ui, length.in_place_of(quantity.unit()));
                ui.end_row();
            }
        },
    );
}

fn entry_ui(ui: &mut Ui, filter: &mut FilterSettings, table: &TableInfo, entry: Entry, sensors: &[Sensor], scale: f64) {
    let text = format!("{} {} of {}", filter.name, table.name, entry.name());
    let key = filter.address(&format!("{}.{}", table.key, entry.key()));
    let name = Named { text: &text, key: &key };
    let Some(number) = table.get_mut(filter, entry, sensors) else { return };
    lit(ui, &key, |ui| {
        if table.factor.is_some() {
            std_field(ui, number, table.allowed.least(), scale, name, table.hint);
        } else {
            field(ui, number, table.allowed.least(), scale, name, table.hint);
        }
    });
}

/// A unit, cut where it is too long: a row that is wider than the panel would make the panel grow.
fn unit_ui(ui: &mut Ui, unit: &str) -> Response {
    ui.allocate_ui(Vec2::new(UNIT_WIDTH, ui.spacing().interact_size.y), |ui| {
        ui.set_width(UNIT_WIDTH);
        ui.add(egui::Label::new(RichText::new(unit).weak()).truncate())
    })
    .inner
}

fn scale(channel: Channel) -> f64 {
    let usual = channel.usual();
    if usual.std > 0.0 { usual.std } else { usual.mean.abs() }
}
