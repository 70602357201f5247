//! The true oscillator, and its parameters over time.

use egui::{Button, ComboBox, TextStyle, Ui};
use kalmanscope_core::channel::{Role, Sign};
use kalmanscope_core::setting::MOTION;
use kalmanscope_core::signal::{Ramp, Sine, Step};
use kalmanscope_core::{Channel, PlantKind, Scenario, Signal};

use super::highlight::highlight_ui;
use super::number::NumberField;
use super::row::scenario_row_ui;
use super::{Edits, PanelRequest};
use crate::equation;
use crate::equation::job;
use crate::text::sentence;
use crate::widgets::named;

/// Limits the natural frequency from below \[rad/s\].
const LEAST_POSITIVE: f64 = 0.01;

pub(super) fn plant_ui(ui: &mut Ui, edits: &mut Edits<'_>, asked: &mut Vec<PanelRequest>) {
    highlight_ui(ui, "plant.kind", |ui| kind_ui(ui, edits, asked));
    for channel in edits.scenario.plant.parameters() {
        let key = format!("plant.{}", channel.key());
        highlight_ui(ui, &key, |ui| parameter_ui(ui, channel, &key, edits));
        ui.add_space(4.0);
    }
    augmentation_ui(ui, edits);
    for info in MOTION {
        scenario_row_ui(ui, info, edits);
    }
}

fn kind_ui(ui: &mut Ui, edits: &mut Edits<'_>, asked: &mut Vec<PanelRequest>) {
    let scenario = edits.scenario;
    let mut kind = scenario.plant.kind.clone();
    let combo =
        ComboBox::from_id_salt("plant").selected_text(kind.name()).width(ui.available_width()).show_ui(ui, |ui| {
            let is_own = kind.own_equation().is_some();
            if ui.selectable_label(is_own, equation::NAME).clicked() && !is_own {
                kind = equation::first().unwrap_or(kind.clone());
                asked.push(PanelRequest::Equation);
            }
            for other in PlantKind::ALL {
                let name = other.name().to_owned();
                ui.selectable_value(&mut kind, other, name);
            }
        });
    named(combo.response, "Kind of plant");
    if kind != scenario.plant.kind {
        edits.change.set_plant(kind);
    }
    equation_ui(ui, scenario, asked);
    ui.add_space(4.0);
}

fn parameter_ui(ui: &mut Ui, channel: Channel, key: &str, edits: &mut Edits<'_>) {
    let name = sentence(channel.name());
    let label = format!("{} {}", channel.symbol(), channel.name());
    let least = match channel.role() {
        Role::Parameter(Sign::Positive) => LEAST_POSITIVE,
        Role::Parameter(Sign::NotNegative) => 0.0,
        Role::Parameter(Sign::Any) | Role::Augmentation | Role::Motion => f64::NEG_INFINITY,
    };
    let range = channel.usual().slider;
    if let Some(before) = edits.scenario.plant.parameter(channel) {
        let mut signal = before;
        signal_ui(ui, &Parameter { label: &label, name: &name, unit: channel.unit(), range, least }, &mut signal);
        if shape_of(&signal) == shape_of(&before) {
            for ((number, now), (_, before)) in signal.numbers().into_iter().zip(before.numbers()) {
                edits.set_other(&format!("{key}{number}"), before, now);
            }
        } else {
            edits.change.put(key, &signal);
        }
    }
    if channel.is_augmentation() {
        let button = ui.add(Button::new("Remove").small()).on_hover_text("Remove this property from the truth");
        let button = named(button, format!("Remove {}", channel.name()));
        if button.clicked() {
            edits.change.put(key, &None::<Signal>);
        }
    }
}

fn augmentation_ui(ui: &mut Ui, edits: &mut Edits<'_>) {
    let plant = &edits.scenario.plant;
    let has: Vec<Channel> = plant.parameters().collect();
    let mut chosen = None;
    let combo = ComboBox::from_id_salt("augmentation").selected_text("Add gain, offset, bias …").show_ui(ui, |ui| {
        // A white force of the truth is its disturbance.
        let is_offered = |channel: &Channel| !has.contains(channel) && *channel != Channel::WHITE_FORCE;
        for channel in plant.kind.augmentations().filter(is_offered) {
            ui.selectable_value(&mut chosen, Some(channel), format!("{} {}", channel.symbol(), channel.name()));
        }
    });
    let hint = "The recorded input may be wrong by a gain or an offset, a sensor by a bias or a gain: the filters are not told";
    combo.response.clone().on_hover_text(hint);
    named(combo.response, "Add a property to the truth");
    if let Some(channel) = chosen {
        edits.change.put(format!("plant.{}", channel.key()), &Signal::Constant(channel.usual_truth()));
    }
    ui.add_space(4.0);
}

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
            named(combo.response, format!("{name} over time"));
        });
    });
    if shape != shape_of(signal) {
        *signal = reshaped(signal, shape);
    }

    let value = |ui: &mut Ui, label: &str, value: &mut f64| {
        let name = format!("{name}, {label}");
        let hint = "The true value; no filter knows it";
        NumberField { label, name: name.as_str().into(), unit, range, least, logarithmic: false, hint }.ui(ui, value);
    };
    let time = |ui: &mut Ui, label: &str, value: &mut f64, least: f64| {
        let name = format!("{name}, {label}");
        let hint = "Time after the start of the record";
        let name = name.as_str().into();
        NumberField { label, name, unit: "s", range: (least, 60.0), least, logarithmic: false, hint }.ui(ui, value);
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
            // A beginning that is dragged past the end takes the end along: a ramp cannot run backward.
            *end = end.max(*start);
            time(ui, "ends at", end, *start);
        }
        Signal::Sine(Sine { mean, amplitude, period }) => {
            value(ui, "mean", mean);
            // The lowest value must stay allowed.
            let room = *mean - least;
            let (name, hint) = (format!("{name}, amplitude"), "Largest distance from the mean");
            let range = (0.0, if room.is_finite() { room } else { range.1 - range.0 });
            let (label, name) = ("amplitude", name.as_str().into());
            NumberField { label, name, unit, range, least: 0.0, logarithmic: false, hint }.ui(ui, amplitude);
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

pub(super) fn equation_ui(ui: &mut Ui, scenario: &Scenario, asked: &mut Vec<PanelRequest>) {
    let Some(own) = scenario.plant.kind.own_equation() else { return };
    let font = TextStyle::Body.resolve(ui.style());
    let printed = job(&own.settings().equation, &font, ui.visuals().text_color());
    let button = Button::new(printed).wrap().min_size(egui::vec2(ui.available_width(), 0.0));
    let button = named(ui.add(button).on_hover_text("Edit the equation and its parameters"), "Edit the equation");
    if button.clicked() {
        asked.push(PanelRequest::Equation);
    }
}
