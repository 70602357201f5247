//! The true oscillator.

use egui::Ui;
use kalmanscope_core::Plant;

use super::number::Number;
use super::signal::{Parameter, signal_ui};

pub(super) fn plant_ui(ui: &mut Ui, plant: &mut Plant) {
    let Plant { kind: _, natural_frequency, damping_ratio, initial, disturbance_std } = plant;
    let frequency = Parameter {
        label: "ωₙ natural frequency",
        name: "Natural frequency",
        unit: "rad/s",
        range: (0.5, 20.0),
        least: 0.01,
    };
    signal_ui(ui, &frequency, natural_frequency);
    ui.add_space(4.0);
    let damping =
        Parameter { label: "ζ damping ratio", name: "Damping ratio", unit: "", range: (0.0, 0.5), least: 0.0 };
    signal_ui(ui, &damping, damping_ratio);
    ui.add_space(4.0);
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
