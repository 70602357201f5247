//! The input.

use egui::{ComboBox, Ui};
use kalmanscope_core::{Force, Hold, InputKind, Scenario};

use super::number::Number;

/// The name of each kind, with its initial settings.
const KINDS: [(&str, Force); 6] = [
    ("white noise", Force::WhiteNoise { std: 10.0 }),
    ("sine", Force::Sine { amplitude: 5.0, frequency: 6.0 }),
    ("chirp", Force::Chirp { amplitude: 8.0, from: 1.0, to: 20.0, sweep: 20.0 }),
    ("hammer blows", Force::ImpulseTrain { impulse: 1.0, period: 5.0 }),
    ("step", Force::Step { amplitude: 5.0, at: 1.0 }),
    ("none", Force::None),
];

pub(super) fn force_ui(ui: &mut Ui, scenario: &mut Scenario) {
    let Scenario { force, input, hold, .. } = scenario;
    let inputs = [(InputKind::Force, "force over mass"), (InputKind::GroundAcceleration, "ground acceleration")];
    let hint = "The input that is recorded: a force over mass, or the acceleration of the ground under the oscillator";
    choice_ui(ui, "the input is a", "Kind of input", hint, &inputs, input);
    let holds = [(Hold::Zero, "held"), (Hold::First, "linear")];
    let hint = "Between samples the input keeps its value (zero-order hold) or is linear (first-order hold)";
    choice_ui(ui, "between samples it is", "Input between samples", hint, &holds, hold);
    let same_kind = |other: &Force| std::mem::discriminant(other) == std::mem::discriminant(force);
    let current = KINDS.iter().position(|(_, kind)| same_kind(kind)).unwrap_or(0);
    let mut chosen = current;
    ui.horizontal(|ui| {
        ui.label("over time");
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let combo = ComboBox::from_id_salt("force").selected_text(KINDS[chosen].0).width(116.0).show_ui(ui, |ui| {
                for (i, (name, _)) in KINDS.iter().enumerate() {
                    ui.selectable_value(&mut chosen, i, *name);
                }
            });
            ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label("Force over time"));
        });
    });
    if chosen != current {
        *force = KINDS[chosen].1;
    }

    let number = |ui: &mut Ui, label: &str, unit, range, least, value: &mut f64| {
        let name = format!("Force, {label}");
        let hint = "The filters are told the force exactly";
        Number { label, name: (&name).into(), unit, range, least, logarithmic: false, hint }.show(ui, value);
    };
    let any = f64::NEG_INFINITY;
    match force {
        Force::None => {}
        Force::WhiteNoise { std } => number(ui, "± σ", "m/s²", (0.0, 50.0), 0.0, std),
        Force::Sine { amplitude, frequency } => {
            number(ui, "amplitude", "m/s²", (0.0, 50.0), any, amplitude);
            number(ui, "frequency", "rad/s", (0.1, 30.0), 0.0, frequency);
        }
        Force::Chirp { amplitude, from, to, sweep } => {
            number(ui, "amplitude", "m/s²", (0.0, 50.0), any, amplitude);
            number(ui, "from", "rad/s", (0.1, 30.0), 0.0, from);
            number(ui, "to", "rad/s", (0.1, 30.0), 0.0, to);
            number(ui, "sweep time", "s", (1.0, 60.0), 0.1, sweep);
        }
        Force::ImpulseTrain { impulse, period } => {
            number(ui, "impulse", "m/s", (0.0, 5.0), any, impulse);
            number(ui, "every", "s", (0.5, 30.0), 0.05, period);
        }
        Force::Step { amplitude, at } => {
            number(ui, "amplitude", "m/s²", (-50.0, 50.0), any, amplitude);
            number(ui, "at", "s", (0.0, 60.0), 0.0, at);
        }
    }
}

/// A row with a choice of names.
fn choice_ui<T: Copy + PartialEq>(
    ui: &mut Ui,
    label: &str,
    name: &str,
    hint: &str,
    choices: &[(T, &str)],
    value: &mut T,
) {
    let text = choices.iter().find(|(choice, _)| choice == value).map_or("", |(_, text)| text);
    ui.horizontal(|ui| {
        ui.label(label).on_hover_text(hint);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let combo = ComboBox::from_id_salt(name).selected_text(text).width(140.0).show_ui(ui, |ui| {
                for (choice, text) in choices {
                    ui.selectable_value(value, *choice, *text);
                }
            });
            ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label(name.to_owned()));
        });
    });
}
