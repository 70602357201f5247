//! The record: its length and its force, or the file of a measured one.

use egui::{DragValue, PopupCloseBehavior, Ui};
use kalmanscope_core::import::Mapping;
use kalmanscope_core::setting::{CHOICES_OF_SCENARIO, DT, DURATION, FORCE, SEED};
use kalmanscope_core::{Force, ForcedMass, Hold};

use super::highlight::highlight_ui;
use super::number::{Named, NumberField, REMARK, limit_ui};
use super::plant::equation_ui;
use super::row::{choice_row_ui, list_ui, scenario_number_ui, scenario_row_ui};
use super::{Edits, PanelRequest};
use crate::session::{Library, name_of};
use crate::text::sentence;
use crate::widgets::named;

pub(super) fn record_ui(ui: &mut Ui, edits: &mut Edits<'_>, library: &Library, asked: &mut Vec<PanelRequest>) {
    let Some(mapping) = &edits.scenario.record else { return };
    equation_ui(ui, edits.scenario, asked);
    let name = name_of(mapping).to_owned();
    ui.label(format!("“{name}”"));
    for line in lines(mapping) {
        ui.weak(line);
    }
    if library.file(mapping).is_none() {
        ui.label("The file is not here: drop it on the window.");
    }
    ui.horizontal(|ui| {
        ui.label("input").on_hover_text("A measured input is not held between its samples");
        let mut hold = edits.scenario.hold;
        ui.selectable_value(&mut hold, Hold::First, "linear between samples");
        ui.selectable_value(&mut hold, Hold::Zero, "held");
        edits.put_other("hold", &edits.scenario.hold, &hold);
    });
    ui.horizontal_wrapped(|ui| {
        if ui.button("Columns…").on_hover_text("Choose other columns, another part, band or rate").clicked() {
            asked.push(PanelRequest::Columns);
        }
        if ui.button("Simulate instead").on_hover_text("Leave the record and simulate the truth").clicked() {
            edits.change.put("record", &None::<Mapping>);
        }
    });
    if let Some(problem) = library.problem.as_deref() {
        ui.colored_label(ui.visuals().warn_fg_color, problem);
    }
    for reason in &library.reasons {
        ui.weak(format!("• {reason}"));
    }
    ui.weak("With a record, only the kind of plant counts: truth, force and duration have no effect.");
}

fn lines(mapping: &Mapping) -> Vec<String> {
    let Mapping { input, forces, sensors, from, to, band, every, interpolate, .. } = mapping;
    let input = input.iter().map(|input| format!("input: {} × {}", input.column, input.gain));
    let forces = forces.iter().map(|(mass, column)| format!("{}: {} × {}", mass.name(), column.column, column.gain));
    let sensors = sensors.iter().map(|(quantity, column)| format!("{}: {}", quantity.name(), column.column));
    let part = (from.is_some() || to.is_some()).then(|| {
        let text = |time: &Option<f64>| time.map_or_else(String::new, |time| format!(" {time} s"));
        format!("part:{} to{}", text(from), text(to))
    });
    let band = band.map(|[low, high]| format!("band: {low} to {high} Hz"));
    let rate = (*every > 1).then(|| format!("one sample of {every}"));
    let finer = (*interpolate > 1).then(|| format!("{interpolate} steps in place of one"));
    input.chain(forces).chain(sensors).chain([part, band, rate, finer].into_iter().flatten()).collect()
}

/// Limits the length of a record: a day \[s\].
const LONGEST: f64 = 86_400.0;

const LENGTHS: [(&str, f64); 3] = [("1 min", 60.0), ("1 h", 3600.0), ("1 day", LONGEST)];

pub(super) fn general_ui(ui: &mut Ui, edits: &mut Edits<'_>) {
    let scenario = edits.scenario;
    let mut duration = scenario_number_ui(ui, &DURATION, scenario, 1.0);
    ui.horizontal(|ui| {
        ui.add_space(REMARK);
        for (name, length) in LENGTHS {
            if ui.small_button(name).on_hover_text(DURATION.hint).clicked() {
                duration = length;
            }
        }
    });
    let mut dt = scenario_number_ui(ui, &DT, scenario, DT.slider.0);
    limit_ui(ui, &mut dt, 0.0, duration, "Sampling time, most", "s");
    limit_ui(ui, &mut duration, 0.0, LONGEST, "Duration, most", "s");
    edits.set_other(DT.key, scenario.dt, dt);
    edits.set_other(DURATION.key, scenario.duration, duration);
    let mut seed = scenario.seed;
    highlight_ui(ui, SEED.key, |ui| seed_ui(ui, &mut seed));
    edits.put_other(SEED.key, &scenario.seed, &seed);
}

fn seed_ui(ui: &mut Ui, seed: &mut u64) {
    ui.horizontal(|ui| {
        ui.label("seed").on_hover_text(SEED.hint);
        // TOML has no larger integer, and a scenario is saved as TOML.
        named(ui.add(DragValue::new(seed).range(0..=i64::MAX as u64).speed(0.1)), "Seed");
        if ui.button("New noise").clicked() {
            *seed = (*seed + 1) % i64::MAX as u64;
        }
    });
}

pub(super) fn force_ui(ui: &mut Ui, edits: &mut Edits<'_>) {
    let scenario = edits.scenario;
    for info in CHOICES_OF_SCENARIO {
        choice_row_ui(ui, info, (&**scenario, info.key), &sentence(info.name), edits);
    }
    for info in &FORCE {
        if (info.serves)(scenario, &scenario.plant.kind) {
            scenario_row_ui(ui, info, edits);
        }
    }
    forces_ui(ui, edits);
}

fn forces_ui(ui: &mut Ui, edits: &mut Edits<'_>) {
    let scenario = edits.scenario;
    let masses = scenario.plant.kind.masses();
    if masses < 2 && scenario.forces.is_empty() {
        return;
    }
    let address = |mass: ForcedMass| format!("forces.{}", mass.key());
    let hint = "Forces that act on one mass each, besides the input that acts on all; the filters know them exactly";
    let (name, summary) = ("on single masses", if scenario.forces.is_empty() { "none" } else { "some" });
    list_ui(ui, (name, hint), summary, name, PopupCloseBehavior::CloseOnClickOutside, &mut |ui| {
        for mass in (0..masses).filter_map(ForcedMass::new) {
            let mut is_on = scenario.forces.contains_key(&mass);
            if ui.checkbox(&mut is_on, mass.name()).changed() {
                edits.change.put(address(mass), &is_on.then(Force::default));
            }
        }
    });
    for &mass in scenario.forces.keys() {
        let Some(own) = scenario.with_force_of(mass) else { continue };
        ui.label(sentence(&mass.name()));
        if let Some(shape) = CHOICES_OF_SCENARIO.into_iter().find(|info| info.key == "force") {
            choice_row_ui(ui, shape, (&own, &address(mass)), &mass.name(), edits);
        }
        for info in FORCE.iter().filter(|info| (info.serves)(&own, &scenario.plant.kind)) {
            let (label, mut value) = ((info.label)(&own).unwrap_or(info.name), (info.get)(&own));
            let (text, key) = (format!("{}, {}", mass.name(), info.name), address(mass));
            let before = value;
            NumberField::of(info, label, Named { text: &text, key: &key }).ui(ui, &mut value);
            if value != before {
                let mut changed = own.clone();
                (info.set)(&mut changed, value);
                edits.change.put(key, &changed.force);
            }
        }
    }
}
