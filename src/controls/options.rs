//! The less common settings of a filter: its plant, what else it estimates, its propagation, and those with rows.

use egui::{ComboBox, Response, Ui};
use kalmanscope_core::channel::augment;
use kalmanscope_core::setting::{GUESSES, OPTIONS, SMOOTHER};
use kalmanscope_core::{Channel, FilterSettings, PlantKind, Propagation, Robust, Sensor};

use super::lit::lit;
use super::row::filter_row_ui;

/// The less common settings of a filter.
pub(super) fn options_ui(ui: &mut Ui, filter: &mut FilterSettings, truth: PlantKind, sensors: &[Sensor]) {
    egui::CollapsingHeader::new("Options").id_salt(("options", filter.id)).show_unindented(ui, |ui| {
        plant_ui(ui, filter);
        augment_ui(ui, filter, filter.plant.unwrap_or(truth), sensors);
        consider_ui(ui, filter, truth);
        if filter.kind.info().has_propagation {
            lit(ui, &filter.address("propagation"), |ui| propagation_ui(ui, filter));
        }
        if filter.can_weigh() {
            lit(ui, &filter.address("robust"), |ui| robust_ui(ui, filter));
        } else {
            filter.robust = Robust::NONE;
        }
        if !(GUESSES.serves)(filter, truth) {
            filter.guesses = 1;
        }
        filter.smoother &= (SMOOTHER.serves)(filter, truth);
        for info in OPTIONS {
            if (info.serves)(filter, truth) {
                filter_row_ui(ui, info, filter, truth);
            }
        }
    });
}

/// The augmentations that the filter estimates.
fn augment_ui(ui: &mut Ui, filter: &mut FilterSettings, plant: PlantKind, sensors: &[Sensor]) {
    let FilterSettings { id, name, augment, .. } = filter;
    let biases = sensors.iter().map(|sensor| sensor.measures.bias());
    let offered: Vec<Channel> = augment::OF_INPUT.into_iter().chain(biases).collect();
    let summary = if augment.is_empty() { "nothing".to_owned() } else { symbols(augment, "") };
    let hint = "Properties of the input and the sensors that the filter estimates too: gain, offset, a force that \
         changes slowly (u) or is another one at each sample (w: wind, traffic), bias";
    let combo = choose_ui(ui, ("estimates also", hint), summary, ("augment", *id), &mut |ui| {
        for &channel in &offered {
            let mut on = augment.contains(&channel);
            let text = format!("{} {}", channel.symbol(), channel.name());
            if ui.checkbox(&mut on, text).changed() {
                augment.retain(|c| *c != channel);
                augment.extend(on.then_some(channel));
            }
        }
    });
    ui.ctx().accesskit_node_builder(combo.id, |node| node.set_label(format!("{name} augmentations")));
    // A removed sensor's bias goes too, and so does that of a quantity that the plant lacks.
    augment.retain(|channel| augment::of(plant).any(|c| c == *channel));
}

/// The channels that the filter counts and does not estimate.
fn consider_ui(ui: &mut Ui, filter: &mut FilterSettings, truth: PlantKind) {
    let offered: Vec<Channel> = if filter.can_consider() { filter.considerable(truth).collect() } else { Vec::new() };
    let FilterSettings { id, name, consider, .. } = filter;
    // A filter that cannot consider a channel, or no longer has it, estimates it again or leaves it out.
    consider.retain(|channel| offered.contains(channel));
    if offered.is_empty() {
        return;
    }
    let summary = if consider.is_empty() { "all of it".to_owned() } else { symbols(consider, "all but ") };
    let hint = "What is left out keeps its mean and its σ: the filter does not estimate it, but counts what is not known of it in all \
         other bands (Schmidt 1966)";
    let combo = choose_ui(ui, ("learns", hint), summary, ("consider", *id), &mut |ui| {
        for channel in &offered {
            let mut on = !consider.contains(channel);
            if ui.checkbox(&mut on, format!("{} {}", channel.symbol(), channel.name())).changed() {
                consider.retain(|other| other != channel);
                consider.extend((!on).then_some(*channel));
            }
        }
    });
    ui.ctx().accesskit_node_builder(combo.id, |node| node.set_label(format!("{name} learns")));
}

/// The symbols of some channels in a row.
fn symbols(channels: &[Channel], before: &str) -> String {
    before.to_owned() + &channels.iter().map(|channel| channel.symbol()).collect::<Vec<_>>().join(", ")
}

/// A label with a hint, and a box that opens on a list of choices.
fn choose_ui(
    ui: &mut Ui,
    (label, hint): (&str, &str),
    summary: String,
    salt: (&str, u32),
    list: &mut dyn FnMut(&mut Ui),
) -> Response {
    ui.horizontal(|ui| {
        ui.label(label).on_hover_text(hint);
        ComboBox::from_id_salt(salt).selected_text(summary).show_ui(ui, |ui| list(ui)).response
    })
    .inner
}

fn plant_ui(ui: &mut Ui, filter: &mut FilterSettings) {
    let FilterSettings { id, name, plant, .. } = filter;
    let text = |plant: Option<PlantKind>| plant.map_or("as the truth", PlantKind::name);
    ui.horizontal(|ui| {
        ui.label("its plant").on_hover_text("What the filter takes the truth for");
        let combo = ComboBox::from_id_salt(("plant", *id)).selected_text(text(*plant)).show_ui(ui, |ui| {
            for kind in std::iter::once(None).chain(PlantKind::ALL.map(Some)) {
                ui.selectable_value(plant, kind, text(kind));
            }
        });
        ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label(format!("{name} plant")));
    });
}

fn robust_ui(ui: &mut Ui, filter: &mut FilterSettings) {
    let FilterSettings { id, name, robust, .. } = filter;
    ui.horizontal(|ui| {
        ui.label("outliers").on_hover_text("How readings that do not fit are weighed");
        let combo = ComboBox::from_id_salt(("robust", *id)).selected_text(robust.info().name).show_ui(ui, |ui| {
            for rule in Robust::ALL {
                ui.selectable_value(robust, rule, rule.info().name).on_hover_text(rule.info().description);
            }
        });
        ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label(format!("{name} outliers")));
    });
}

fn propagation_ui(ui: &mut Ui, filter: &mut FilterSettings) {
    let FilterSettings { id, name, propagation, .. } = filter;
    let text = |propagation: Propagation| match propagation {
        Propagation::LocalLinearisation => "local linearisation",
        Propagation::RungeKutta => "Runge-Kutta",
        Propagation::Euler => "Euler",
    };
    ui.horizontal(|ui| {
        ui.label("its steps").on_hover_text("How the mean moves from sample to sample");
        let combo = ComboBox::from_id_salt(("steps", *id)).selected_text(text(*propagation)).show_ui(ui, |ui| {
            for way in Propagation::ALL {
                ui.selectable_value(propagation, way, text(way));
            }
        });
        ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label(format!("{name} steps")));
    });
}
