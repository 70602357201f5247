//! The last estimates of a filter, and the settings that one tunes first.

use egui::{DragValue, Grid, RichText, Ui};
use kalmanscope_core::setting::{Address, PROCESS_STD, SENSOR_STD};
use kalmanscope_core::{Estimates, FilterSettings, Scenario};

use crate::request::Request;
use crate::text::{fixed, significant};
use crate::view::ViewContext;

pub(super) fn estimates_ui(ui: &mut Ui, context: &ViewContext<'_>, place: usize, estimates: &Estimates) {
    let Some(last) = estimates.len().checked_sub(1) else { return };
    let diagnostics = context.session.diagnostics().get(place);
    Grid::new(("numbers", estimates.id())).num_columns(3).spacing([10.0, 2.0]).show(ui, |ui| {
        for (at, &channel) in estimates.channels().iter().enumerate() {
            let std = estimates.std(last, at);
            if !channel.is_parameter() || (std == 0.0 && estimates.initial_std(at) == 0.0) {
                continue;
            }
            let decimals = channel.usual().decimals;
            ui.label(channel.symbol()).on_hover_text(channel.name());
            let mean = fixed(estimates.canonical_mean(last, at), decimals);
            let unit = context.unit(channel.unit());
            ui.label(format!("{mean} ± {} {unit}", significant(2.0 * std, 2)).trim_end());
            let error = diagnostics.and_then(|diagnostics| diagnostics.error(channel));
            ui.weak(error.map_or(String::new(), |error| format!("off by {}", significant(error, 2))));
            ui.end_row();
        }
    });
}

pub(super) fn settings_ui(ui: &mut Ui, context: &ViewContext<'_>, id: u32, requests: &mut Vec<Request>) {
    let scenario = context.session.scenario();
    let Some(filter) = scenario.filters.iter().find(|filter| filter.id == id) else { return };
    Grid::new(("edits", id)).num_columns(4).spacing([8.0, 4.0]).show(ui, |ui| {
        for (place, key) in keys(filter, scenario).into_iter().enumerate() {
            if place > 0 && place.is_multiple_of(2) {
                ui.end_row();
            }
            let Ok(address) = Address::parse(scenario, &filter.address(&key)) else { continue };
            let label = if key == "fading" { "λ".to_owned() } else { address.name() };
            ui.label(RichText::new(&label).weak());
            let mut value = address.get(scenario);
            let step = if key == "fading" { 0.001 } else { 0.02 * value.abs().max(1e-9) };
            let number = DragValue::new(&mut value).speed(step).range(0.0..=f64::MAX).clamp_existing_to_range(false);
            let number = ui.add(number.custom_formatter(|value, _| significant(value, 4)));
            let name = format!("{label} of {}, in the diagnosis", filter.name);
            number.ctx.accesskit_node_builder(number.id, |node| node.set_label(name));
            if number.changed() {
                let mut edited = scenario.clone();
                address.set(&mut edited, value);
                requests.extend(Request::edit(scenario, &edited));
            }
        }
    });
}

fn keys(filter: &FilterSettings, scenario: &Scenario) -> Vec<String> {
    let model = filter.model(scenario.plant.kind, scenario.input);
    let parameters = model.channels().iter().filter(|channel| channel.is_parameter() && !filter.knows(**channel));
    let entries = parameters.map(|channel| format!("{}.{}", PROCESS_STD.key, channel.key()));
    let sensors = scenario.sensors.iter().map(|sensor| format!("{}.{}", SENSOR_STD.key, sensor.measures.key()));
    std::iter::once("fading".to_owned()).chain(entries).chain(sensors).collect()
}
