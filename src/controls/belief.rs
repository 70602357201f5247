//! A filter's initial belief and assumed noise: initial mean and std, Q and R.

use egui::{Grid, Response, RichText, Ui, Vec2};
use kalmanscope_core::import::Length;
use kalmanscope_core::{Channel, FilterSettings, InputKind, PlantKind, Sensor};

use super::lit::lit;
use super::number::{Named, field, std_field, tell_hertz};

/// Width of the column of symbols \[points\].
const SYMBOL_WIDTH: f32 = 22.0;
/// Width of the column of units \[points\].
const UNIT_WIDTH: f32 = 36.0;

/// A table with one row per channel and one per sensor of a filter, for a truth of the given kind.
pub(super) fn belief_ui(
    ui: &mut Ui,
    filter: &mut FilterSettings,
    sensors: &[Sensor],
    truth: PlantKind,
    length: Length,
) {
    let channels = filter.model(truth, InputKind::Force).channels().to_vec();
    let known: Vec<Channel> = channels.iter().copied().filter(|channel| filter.knows(*channel)).collect();
    let FilterSettings { id, name, sensor_std, initial_mean, initial_std, process_std, .. } = filter;
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

    Grid::new(("belief", *id)).num_columns(5).min_col_width(0.0).spacing(Vec2::new(spacing, 4.0)).show(ui, |ui| {
        ui.label("");
        heading(ui, "initial guess", "Mean of the initial belief");
        heading(ui, "± σ of guess", "Standard deviation of the initial belief: how sure the filter is of its guess");
        heading(ui, "√Q per step", "Standard deviation of the model's error in one step");
        ui.end_row();
        for &channel in &channels {
            // The parameters of a KF are known and have no uncertainty to set.
            let uncertain = !known.contains(&channel);
            ui.label(channel.symbol()).on_hover_text(channel.name());
            let title = |what: &str| format!("{name} {what} of {}", channel.name());
            let path = |table: &str| format!("filters#{id}.{table}.{}", channel.key());
            let scale = scale(channel);
            let mean = &mut initial_mean[channel];
            let (text, key) = (title("initial guess"), path("initial_mean"));
            let name = Named { text: &text, key: &key };
            cell(ui, true, &mut |ui| {
                lit(ui, &key, |ui| field(ui, mean, f64::NEG_INFINITY, scale, name, "Mean of the initial belief"));
            });
            let std = &mut initial_std[channel];
            let (text, key) = (title("initial std"), path("initial_std"));
            let name = Named { text: &text, key: &key };
            cell(ui, uncertain, &mut |ui| {
                lit(ui, &key, |ui| {
                    std_field(ui, std, 0.0, 10.0 * scale, name, "How sure the filter is of its guess");
                });
            });
            let process = &mut process_std[channel];
            let (text, key) = (title("process std"), path("process_std"));
            let name = Named { text: &text, key: &key };
            cell(ui, uncertain, &mut |ui| {
                lit(ui, &key, |ui| std_field(ui, process, 0.0, scale, name, "0: the model is exact"));
            });
            let unit = unit_ui(ui, length.in_place_of(channel.unit()));
            tell_hertz(unit, *mean, channel.unit(), "The guess is");
            ui.end_row();
        }
        for (place, (std, sensor)) in sensor_std.iter_mut().zip(sensors).enumerate() {
            let quantity = sensor.measures;
            ui.label(quantity.symbol()).on_hover_text(format!("{} sensor", quantity.key()));
            ui.label("");
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.label(RichText::new("√R").small().weak()).on_hover_text("What the filter takes the noise to be");
            });
            let title = format!("{name} sensor std of {}", quantity.key());
            let (path, key) =
                (format!("filters#{id}.sensor_std.{place}"), format!("filters#{id}.sensor_std.{}", quantity.key()));
            let title = Named { text: &title, key: &key };
            cell(ui, true, &mut |ui| {
                lit(ui, &path, |ui| {
                    std_field(ui, std, 1e-9, 10.0, title, "Standard deviation that the filter ascribes to the sensor");
                });
            });
            unit_ui(ui, length.in_place_of(quantity.unit()));
            ui.end_row();
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

/// A usual size of the channel's values: the usual initial standard deviation.
fn scale(channel: Channel) -> f64 {
    let usual = channel.usual();
    if usual.std > 0.0 { usual.std } else { usual.mean.abs() }
}
