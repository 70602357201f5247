//! The true oscillator.

use egui::{ComboBox, Ui};
use kalmanscope_core::{Channel, Plant, PlantKind, Scenario};

use super::number::Number;
use super::signal::{Parameter, signal_ui};

pub(super) fn plant_ui(ui: &mut Ui, scenario: &mut Scenario) {
    kind_ui(ui, scenario);
    let plant = &mut scenario.plant;
    for channel in plant.kind.parameters() {
        let name = sentence_case(channel.name());
        let label = format!("{} {}", channel.symbol(), channel.name());
        let range = range(channel);
        let least = match channel {
            Channel::NATURAL_FREQUENCY => 0.01,
            _ if channel.is_positive() => 0.0,
            _ => f64::NEG_INFINITY,
        };
        if let Some(signal) = plant.parameter_mut(channel) {
            signal_ui(ui, &Parameter { label: &label, name: &name, unit: channel.unit(), range, least }, signal);
            ui.add_space(4.0);
        }
    }
    let Plant { initial, disturbance_std, .. } = plant;
    let number = |ui: &mut Ui, label, name, unit, range, least, hint, value: &mut f64| {
        Number { label, name, unit, range, least, logarithmic: false, hint }.show(ui, value);
    };
    let any = f64::NEG_INFINITY;
    let at_start = "At the start of the record";
    number(ui, "x at start", "Initial displacement", "m", (-1.0, 1.0), any, at_start, &mut initial.displacement);
    number(ui, "v at start", "Initial velocity", "m/s", (-5.0, 5.0), any, at_start, &mut initial.velocity);
    let hint = "Standard deviation of a force that nobody measures";
    number(ui, "disturbance", "Disturbance", "m/s²", (0.0, 10.0), 0.0, hint, disturbance_std);
}

fn kind_ui(ui: &mut Ui, scenario: &mut Scenario) {
    let mut kind = scenario.plant.kind;
    let combo =
        ComboBox::from_id_salt("plant").selected_text(kind.name()).width(ui.available_width()).show_ui(ui, |ui| {
            for other in PlantKind::ALL {
                ui.selectable_value(&mut kind, other, other.name());
            }
        });
    ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label("Kind of plant"));
    if kind != scenario.plant.kind {
        scenario.set_plant(kind);
    }
    ui.add_space(4.0);
}

/// Ends of a parameter's sliders.
fn range(channel: Channel) -> (f64, f64) {
    match channel {
        Channel::NATURAL_FREQUENCY => (0.5, 20.0),
        Channel::DAMPING_RATIO => (0.0, 0.5),
        Channel::CUBIC_STIFFNESS => (-50.0, 1000.0),
        Channel::POST_YIELD_RATIO => (0.0, 1.0),
        Channel::HYSTERESIS_BETA | Channel::HYSTERESIS_GAMMA => (-100.0, 200.0),
        Channel::STOREY_DAMPING => (0.0, 5.0),
        _ => (10.0, 500.0),
    }
}

fn sentence_case(name: &str) -> String {
    let mut chars = name.chars();
    chars.next().map_or(String::new(), |first| first.to_uppercase().chain(chars).collect())
}
