//! The choices: filter, goal, settings and their ranges.

use egui::{ComboBox, Grid, Ui, vec2};
use kalmanscope_core::setting::Address;
use kalmanscope_core::{Axis, Scenario};
use kalmanscope_lab::tune::Goal;

use crate::controls::number::field;
use crate::laboratory::{TuneChoice, of_filters, part_of, setting_label, setting_name};
use crate::request::Request;
use crate::text::significant;
use crate::view::ViewContext;

pub(super) fn head_ui(
    ui: &mut Ui,
    context: &ViewContext<'_>,
    choice: &TuneChoice,
    is_working: bool,
    requests: &mut Vec<Request>,
) {
    let scenario = context.session.run().scenario();
    let mut next = choice.clone();
    ui.horizontal_wrapped(|ui| {
        filter_ui(ui, &mut next, scenario);
        goal_ui(ui, &mut next, scenario);
        let text = if is_working { "Stop tuning" } else { "Tune" };
        if ui.button(text).clicked() {
            requests.push(Request::Tune(!is_working));
        }
    });
    if next != *choice {
        requests.push(Request::ChooseTuning(Box::new(next)));
    }
}

pub(super) fn settings_ui(ui: &mut Ui, context: &ViewContext<'_>, choice: &TuneChoice, requests: &mut Vec<Request>) {
    let mut next = choice.clone();
    let part = part_of(context.session.run().scenario(), &[choice.filter]);
    Grid::new("settings to tune").spacing(vec2(6.0, 3.0)).show(ui, |ui| {
        for text in ["setting", "now", "from", "to"] {
            ui.weak(text);
        }
        ui.end_row();
        for key in of_filters(&part) {
            setting_ui(ui, &mut next, &key, &part);
            ui.end_row();
        }
    });
    if next != *choice {
        requests.push(Request::ChooseTuning(Box::new(next)));
    }
}

fn filter_ui(ui: &mut Ui, choice: &mut TuneChoice, scenario: &Scenario) {
    let name = |id: u32| scenario.filters.iter().find(|filter| filter.id == id).map_or("", |filter| &filter.name);
    let combo = ComboBox::from_id_salt("filter to tune").selected_text(name(choice.filter)).width(70.0);
    let combo = combo.show_ui(ui, |ui| {
        for filter in &scenario.filters {
            if ui.selectable_label(filter.id == choice.filter, &filter.name).clicked() {
                let goal = choice.goal;
                if let Some(usual) = TuneChoice::usual(scenario, Some(filter.id)) {
                    *choice = TuneChoice { goal, ..usual };
                }
            }
        }
    });
    ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label("Filter to tune"));
}

fn goal_ui(ui: &mut Ui, choice: &mut TuneChoice, scenario: &Scenario) {
    let combo = ComboBox::from_id_salt("goal of the tuning").selected_text(goal_name(choice.goal)).width(190.0);
    let combo = combo.show_ui(ui, |ui| {
        let free_runs = scenario.sensors.iter().map(|sensor| Goal::FreeRun(sensor.measures));
        for goal in [Goal::Likelihood, Goal::Consistency].into_iter().chain(free_runs) {
            ui.selectable_value(&mut choice.goal, goal, goal_name(goal));
        }
    });
    ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label("Goal of the tuning"));
}

pub(super) fn goal_name(goal: Goal) -> String {
    match goal {
        Goal::Likelihood => "the highest likelihood".to_owned(),
        Goal::Consistency => "a mean NIS as expected".to_owned(),
        Goal::FreeRun(sensor) => format!("the best free run of {}", sensor.symbol()),
    }
}

fn setting_ui(ui: &mut Ui, choice: &mut TuneChoice, key: &str, part: &Scenario) {
    let Ok(setting) = Address::parse(part, key) else { return };
    let mut is_ticked = choice.axes.iter().any(|axis| axis.key == key);
    if ui.checkbox(&mut is_ticked, setting_name(key, part)).on_hover_text(setting_label(key, part)).changed() {
        choice.toggle(key, part);
    }
    ui.weak(significant(setting.get(part), 4));
    let Some(axis) = choice.axes.iter_mut().find(|axis| axis.key == key) else { return };
    let before: Axis = axis.clone();
    let size = vec2(64.0, ui.spacing().interact_size.y);
    for (value, end) in [(&mut axis.from, "least"), (&mut axis.to, "largest")] {
        let name = format!("{end} {}", setting_name(key, part));
        let scale = value.abs().max(1e-9);
        ui.allocate_ui(size, |ui| field(ui, value, f64::NEG_INFINITY, scale, name.as_str(), &name));
    }
    // Ignores half-typed, impossible ranges.
    if axis.check().is_err() || axis.from >= axis.to {
        *axis = before;
    }
}
