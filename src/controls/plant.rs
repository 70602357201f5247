//! The true oscillator.

use egui::{Button, ComboBox, Ui};
use kalmanscope_core::channel::augment;
use kalmanscope_core::channel::{Role, Sign};
use kalmanscope_core::setting::MOTION;
use kalmanscope_core::{Channel, Plant, PlantKind, Scenario};

use super::Asked;
use super::equation::equation_ui;
use super::lit::lit;
use super::row::scenario_row_ui;
use super::signal::{Parameter, signal_ui};
use crate::equation;
use crate::text::sentence;

/// Limits the natural frequency from below \[rad/s\].
const LEAST_POSITIVE: f64 = 0.01;

pub(super) fn plant_ui(ui: &mut Ui, scenario: &mut Scenario, asked: &mut Vec<Asked>) {
    lit(ui, "plant.kind", |ui| kind_ui(ui, scenario, asked));
    let plant = &mut scenario.plant;
    for channel in plant.parameters().collect::<Vec<_>>() {
        lit(ui, &format!("plant.{}", channel.key()), |ui| parameter_ui(ui, plant, channel));
        ui.add_space(4.0);
    }
    augmentation_ui(ui, plant);
    for info in MOTION {
        scenario_row_ui(ui, info, scenario, info.allowed.least());
    }
}

fn kind_ui(ui: &mut Ui, scenario: &mut Scenario, asked: &mut Vec<Asked>) {
    let mut kind = scenario.plant.kind;
    let combo =
        ComboBox::from_id_salt("plant").selected_text(kind.name()).width(ui.available_width()).show_ui(ui, |ui| {
            let is_own = kind.own_equation().is_some();
            if ui.selectable_label(is_own, equation::NAME).clicked() && !is_own {
                kind = equation::first().unwrap_or(kind);
                asked.push(Asked::Equation);
            }
            for other in PlantKind::ALL {
                ui.selectable_value(&mut kind, other, other.name());
            }
        });
    ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label("Kind of plant"));
    if kind != scenario.plant.kind {
        scenario.set_plant(kind);
    }
    equation_ui(ui, scenario, asked);
    ui.add_space(4.0);
}

fn parameter_ui(ui: &mut Ui, plant: &mut Plant, channel: Channel) {
    let name = sentence(channel.name());
    let label = format!("{} {}", channel.symbol(), channel.name());
    let least = match channel.role() {
        Role::Parameter(Sign::Positive) => LEAST_POSITIVE,
        Role::Parameter(Sign::NotNegative) => 0.0,
        Role::Parameter(Sign::Any) | Role::Augmentation | Role::Motion => f64::NEG_INFINITY,
    };
    let range = channel.usual().slider;
    if let Some(signal) = plant.parameter_mut(channel) {
        signal_ui(ui, &Parameter { label: &label, name: &name, unit: channel.unit(), range, least }, signal);
    }
    if channel.is_augmentation() {
        let button = ui.add(Button::new("Remove").small()).on_hover_text("Take this property away from the truth");
        ui.ctx().accesskit_node_builder(button.id, |node| node.set_label(format!("Remove {}", channel.name())));
        if button.clicked() {
            plant.remove(channel);
        }
    }
}

/// Adds a property of the input or of a sensor to the truth; filters do not know of it unless their settings say so.
fn augmentation_ui(ui: &mut Ui, plant: &mut Plant) {
    let has: Vec<Channel> = plant.parameters().collect();
    let mut chosen = None;
    let combo = ComboBox::from_id_salt("augmentation").selected_text("Add gain, offset, bias …").show_ui(ui, |ui| {
        // A white force of the truth is its disturbance.
        let is_offered = |channel: &Channel| !has.contains(channel) && *channel != Channel::WHITE_FORCE;
        for channel in augment::of(plant.kind).filter(is_offered) {
            ui.selectable_value(&mut chosen, Some(channel), format!("{} {}", channel.symbol(), channel.name()));
        }
    });
    let hint = "The recorded input may be wrong by a gain or an offset, a sensor by a bias or a gain: the filters are not told";
    combo.response.clone().on_hover_text(hint);
    ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label("Add a property to the truth"));
    if let Some(channel) = chosen {
        plant.set(channel, channel.usual_truth());
    }
    ui.add_space(4.0);
}
