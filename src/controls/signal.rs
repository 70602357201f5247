//! A parameter of the truth over time.

use egui::{ComboBox, Ui};
use kalmanscope_core::Signal;
use kalmanscope_core::signal::{Ramp, Sine, Step};

use super::number::Number;

pub(super) struct Parameter<'a> {
    pub(super) label: &'a str,
    pub(super) name: &'a str,
    pub(super) unit: &'a str,
    pub(super) range: (f64, f64),
    pub(super) least: f64,
}

const SHAPES: [&str; 4] = ["constant", "step", "ramp", "sine"];

pub(super) fn signal_ui(ui: &mut Ui, parameter: &Parameter<'_>, signal: &mut Signal) {
    let Parameter { label, name, unit, range, least } = *parameter;
    let mut shape = shape_of(signal);
    ui.horizontal(|ui| {
        ui.label(label);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let combo = ComboBox::from_id_salt(name).selected_text(SHAPES[shape]).width(96.0).show_ui(ui, |ui| {
                for (i, text) in SHAPES.into_iter().enumerate() {
                    ui.selectable_value(&mut shape, i, text);
                }
            });
            ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label(format!("{name} over time")));
        });
    });
    if shape != shape_of(signal) {
        *signal = reshaped(signal, shape);
    }

    let value = |ui: &mut Ui, label: &str, value: &mut f64| {
        let name = format!("{name}, {label}");
        let hint = "True value, which no filter is told";
        Number { label, name: (&name).into(), unit, range, least, logarithmic: false, hint }.show(ui, value);
    };
    let time = |ui: &mut Ui, label: &str, value: &mut f64, least: f64| {
        let name = format!("{name}, {label}");
        let hint = "Time after the start of the record";
        Number { label, name: (&name).into(), unit: "s", range: (least, 60.0), least, logarithmic: false, hint }
            .show(ui, value);
    };
    match signal {
        Signal::Constant(constant) => value(ui, "value", constant),
        Signal::Step(Step { from, to, at }) => {
            value(ui, "before", from);
            value(ui, "after", to);
            time(ui, "changes at", at, 0.0);
        }
        Signal::Ramp(Ramp { from, to, start, end }) => {
            value(ui, "before", from);
            value(ui, "after", to);
            time(ui, "begins at", start, 0.0);
            *end = end.max(*start);
            time(ui, "ends at", end, *start);
        }
        Signal::Sine(Sine { mean, amplitude, period }) => {
            value(ui, "mean", mean);
            // The lowest value must stay allowed.
            let room = *mean - least;
            let name = format!("{name}, amplitude");
            let hint = "Largest distance from the mean";
            let shown = (0.0, if room.is_finite() { room } else { range.1 - range.0 });
            Number {
                label: "amplitude",
                name: (&name).into(),
                unit,
                range: shown,
                least: 0.0,
                logarithmic: false,
                hint,
            }
            .show(ui, amplitude);
            *amplitude = amplitude.min(room);
            time(ui, "period", period, 0.1);
        }
    }
}

fn shape_of(signal: &Signal) -> usize {
    match signal {
        Signal::Constant(_) => 0,
        Signal::Step(_) => 1,
        Signal::Ramp(_) => 2,
        Signal::Sine(_) => 3,
    }
}

fn reshaped(signal: &Signal, shape: usize) -> Signal {
    let (from, to, start) = match *signal {
        Signal::Constant(value) => (value, 0.8 * value, 30.0),
        Signal::Step(Step { from, to, at }) => (from, to, at),
        Signal::Ramp(Ramp { from, to, start, .. }) => (from, to, start),
        Signal::Sine(Sine { mean, amplitude, .. }) => (mean, mean - amplitude, 30.0),
    };
    match shape {
        0 => Signal::Constant(from),
        1 => Signal::Step(Step { from, to, at: start }),
        2 => Signal::Ramp(Ramp { from, to, start: start.min(10.0), end: start + 20.0 }),
        _ => Signal::Sine(Sine { mean: from, amplitude: (from - to).abs(), period: 20.0 }),
    }
}
