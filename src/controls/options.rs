//! The less common settings of a filter: its plant, what else it estimates, its propagation, and those with rows.

use egui::Ui;
use kalmanscope_core::channel::augment;
use kalmanscope_core::import::Length;
use kalmanscope_core::setting::{CHOICES_OF_FILTER, GUESSES, OPTIONS, PROCESS_SCALES, ROBUST, SMOOTHER};
use kalmanscope_core::{Channel, FilterSettings, PlantKind, Robust, Sensor};

use super::bounds::bounds_ui;
use super::delays::delays_ui;
use super::lit::lit;
use super::plucks::plucks_ui;
use super::row::{choice_row_ui, choices_ui, chooser_ui, filter_row_ui};

pub(super) fn options_ui(
    ui: &mut Ui,
    filter: &mut FilterSettings,
    truth: PlantKind,
    sensors: &[Sensor],
    length: Length,
) {
    egui::CollapsingHeader::new("Options").id_salt(("options", filter.id)).show_unindented(ui, |ui| {
        plant_ui(ui, filter);
        augment_ui(ui, filter, filter.plant.unwrap_or(truth), sensors);
        consider_ui(ui, filter, truth);
        bounds_ui(ui, filter, truth, length);
        delays_ui(ui, filter, sensors);
        plucks_ui(ui, filter);
        for info in CHOICES_OF_FILTER {
            if (info.serves)(filter) {
                let name = format!("{} {}", filter.name, info.name);
                lit(ui, &filter.address(info.key), |ui| choice_row_ui(ui, info, filter, &name));
            }
        }
        if !(ROBUST.serves)(filter) {
            filter.robust = Robust::NONE;
        }
        if !(GUESSES.serves)(filter, truth) {
            filter.guesses = 1;
        }
        if !(PROCESS_SCALES.serves)(filter, truth) {
            filter.process_scales = 1;
        }
        filter.smoother &= (SMOOTHER.serves)(filter, truth);
        for info in OPTIONS {
            if (info.serves)(filter, truth) {
                filter_row_ui(ui, info, filter, truth);
            }
        }
    });
}

fn augment_ui(ui: &mut Ui, filter: &mut FilterSettings, plant: PlantKind, sensors: &[Sensor]) {
    let FilterSettings { name, augment, .. } = filter;
    let offered: Vec<Channel> = augment::of_all(sensors.iter().map(|sensor| sensor.measures)).collect();
    let summary = if augment.is_empty() { "nothing".to_owned() } else { symbols(augment, "") };
    let hint = "Properties of the input and the sensors that the filter estimates too: gain, offset, a force that \
         changes slowly (u) or is another one at each sample (w: wind, traffic), bias and gain of a sensor";
    choices_ui(ui, ("estimates also", hint), &summary, &format!("{name} augmentations"), &mut |ui| {
        for &channel in &offered {
            let mut on = augment.contains(&channel);
            let text = format!("{} {}", channel.symbol(), channel.name());
            if ui.checkbox(&mut on, text).changed() {
                augment.retain(|c| *c != channel);
                augment.extend(on.then_some(channel));
            }
        }
    });
    // Bias and gain of a removed sensor go too, and so do those of a quantity that the plant lacks.
    augment.retain(|channel| augment::of(plant).any(|c| c == *channel));
}

fn consider_ui(ui: &mut Ui, filter: &mut FilterSettings, truth: PlantKind) {
    let offered: Vec<Channel> = if filter.can_consider() { filter.considerable(truth).collect() } else { Vec::new() };
    let FilterSettings { name, consider, .. } = filter;
    // A filter that cannot consider a channel, or no longer has it, estimates it again or leaves it out.
    consider.retain(|channel| offered.contains(channel));
    if offered.is_empty() {
        return;
    }
    let summary = if consider.is_empty() { "all of it".to_owned() } else { symbols(consider, "all but ") };
    let hint = "What is left out keeps its mean and its σ: the filter does not estimate it, but counts what is not known of it in all \
         other bands (Schmidt 1966)";
    choices_ui(ui, ("learns", hint), &summary, &format!("{name} learns"), &mut |ui| {
        for channel in &offered {
            let mut on = !consider.contains(channel);
            if ui.checkbox(&mut on, format!("{} {}", channel.symbol(), channel.name())).changed() {
                consider.retain(|other| other != channel);
                consider.extend((!on).then_some(*channel));
            }
        }
    });
}

fn symbols(channels: &[Channel], before: &str) -> String {
    before.to_owned() + &channels.iter().map(|channel| channel.symbol()).collect::<Vec<_>>().join(", ")
}

fn plant_ui(ui: &mut Ui, filter: &mut FilterSettings) {
    let FilterSettings { name, plant, .. } = filter;
    let text = |plant: Option<PlantKind>| plant.map_or("as the truth", PlantKind::name);
    let (label, now) = (("its plant", "What the filter takes the truth for"), text(*plant));
    chooser_ui(ui, label, now, &format!("{name} plant"), &mut |ui| {
        for kind in std::iter::once(None).chain(PlantKind::ALL.map(Some)) {
            ui.selectable_value(plant, kind, text(kind));
        }
    });
}
