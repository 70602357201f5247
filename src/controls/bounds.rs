//! The bounds of what a filter estimates.

use egui::{Checkbox, DragValue, Ui};
use kalmanscope_core::import::Length;
use kalmanscope_core::scenario::Between;
use kalmanscope_core::{Channel, FilterSettings, PlantKind};

use super::row::choices_ui;
use crate::text::significant;

/// The distance of a new end from the initial mean, in standard deviations of the initial belief.
const FAR: f64 = 4.0;

pub(super) fn bounds_ui(ui: &mut Ui, filter: &mut FilterSettings, truth: PlantKind, length: Length) {
    let offered: Vec<Channel> = if filter.can_be_bounded() { filter.considerable(truth).collect() } else { Vec::new() };
    // A filter that can have no bounds, or no longer has the channel, loses them.
    filter.bounds.retain(|channel| offered.contains(&channel));
    if offered.is_empty() {
        return;
    }
    let hint = "What a parameter cannot be: estimate and band are those of the belief between the ends (truncation; Simon 2010). The filter \
         itself goes on as without them";
    let summary = summary(filter);
    let name = filter.name.clone();
    choices_ui(ui, ("tells within", hint), &summary, &format!("{name} bounds"), &mut |ui| {
        for &channel in &offered {
            let (mean, std) = (filter.initial_mean[channel], filter.initial_std[channel]);
            let mut between = filter.bounds.of(channel);
            ui.horizontal(|ui| {
                let [lower, upper] = usual(channel, mean, std);
                end_ui(
                    ui,
                    &format!("{} at least", channel.symbol()),
                    &name,
                    &mut between.least,
                    (f64::NEG_INFINITY, mean, lower),
                );
                end_ui(
                    ui,
                    "at most",
                    &format!("{name} {}", channel.symbol()),
                    &mut between.most,
                    (mean, f64::INFINITY, upper),
                );
                ui.weak(length.in_place_of(channel.unit()));
            });
            if between != filter.bounds.of(channel) {
                filter.bounds.set(channel, between);
            }
        }
    });
    // The mean of the initial belief is never beyond an end.
    for &channel in &offered {
        let (mean, Between { least, most }) = (filter.initial_mean[channel], filter.bounds.of(channel));
        let within = Between { least: least.map(|least| least.min(mean)), most: most.map(|most| most.max(mean)) };
        if within != (Between { least, most }) {
            filter.bounds.set(channel, within);
        }
    }
}

fn usual(channel: Channel, mean: f64, std: f64) -> [f64; 2] {
    let far = FAR * if std > 0.0 { std } else { mean.abs().max(1.0) };
    let lower = if mean >= 0.0 && channel.is_parameter() && !channel.is_augmentation() { 0.0 } else { mean - far };
    [lower, mean + far]
}

/// An optional end, with its limits and its first value.
fn end_ui(ui: &mut Ui, label: &str, name: &str, end: &mut Option<f64>, (least, most, offered): (f64, f64, f64)) {
    let mut is_on = end.is_some();
    if ui.add(Checkbox::new(&mut is_on, label)).changed() {
        *end = is_on.then_some(offered);
    }
    if let Some(end) = end {
        let speed = 0.01 * end.abs().max(0.1);
        let drag = ui.add(DragValue::new(end).range(least..=most).speed(speed).max_decimals(6));
        ui.ctx().accesskit_node_builder(drag.id, |node| node.set_label(format!("{name} {label}")));
    }
}

fn summary(filter: &FilterSettings) -> String {
    let short = |end: f64| significant(end, 3);
    let each = filter.bounds.iter().map(|(channel, Between { least, most })| {
        let symbol = channel.symbol();
        match (least, most) {
            (Some(least), Some(most)) => format!("{symbol} {}…{}", short(least), short(most)),
            (Some(least), None) => format!("{symbol} ≥ {}", short(least)),
            (None, Some(most)) => format!("{symbol} ≤ {}", short(most)),
            (None, None) => symbol.to_owned(),
        }
    });
    let all: Vec<String> = each.collect();
    if all.is_empty() { "no bounds".to_owned() } else { all.join(", ") }
}
