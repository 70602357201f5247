//! Tuning: the settings that may be turned, the search, and its result.

use egui::{Button, ComboBox, Grid, ProgressBar, ScrollArea, Ui, UiBuilder, vec2};
use egui_plot::{Line, Points};
use kalmanscope_core::setting::Address;
use kalmanscope_core::{Axis, Scenario};
use kalmanscope_lab::tune::{Goal, TuneRemark};

use crate::controls::number::field_ui;
use crate::laboratory::{TuneChoice, TuneResult, Tuning, of_filters, part_of, setting_label, setting_name};
use crate::plot::medium::Medium;
use crate::plot::plane::Plane;
use crate::request::Request;
use crate::text::{significant, unit_in};
use crate::verdict;
use crate::view::{View, ViewContext};
use crate::widgets::primary;

/// The least width at which the result is beside the settings, and the width of these \[points\].
const WIDE: f32 = 675.0;
const SETTINGS: f32 = 360.0;

pub(super) static VIEW: View = View {
    name: "Tune for me",
    short: Some("Tune"),
    help: [
        "A search for the values of the ticked settings with the best score over the whole record.",
        "The likelihood of the innovations finds Q and R where the model is right; the free run, a model to simulate with.",
        "Read the remarks: the record does not determine a flat setting; one at an edge needs a wider range or another model.",
    ],
    ui: Some(view_ui),
    ..View::NONE
};

fn view_ui(ui: &mut Ui, context: &ViewContext<'_>, requests: &mut Vec<Request>) -> Option<f64> {
    let tuning = &context.laboratory?.tuning;
    let Some(choice) = tuning.choice(context.session.run().scenario()) else {
        ui.weak("There is no filter to tune.");
        return None;
    };
    let is_working = tuning.progress().is_some();
    let is_screen = Medium::of(ui.ctx()) == Medium::Screen;
    let result_ui = |ui: &mut Ui, requests: &mut Vec<Request>| {
        if let Some(problem) = tuning.problem.as_deref() {
            ui.weak(problem);
        }
        if let Some(share) = tuning.progress() {
            ui.add(ProgressBar::new(share as f32).desired_height(6.0));
        }
        path_ui(ui, tuning, context);
        if let Some(result) = &tuning.result {
            result_ui(ui, result, context, requests);
        }
    };
    if !is_screen {
        result_ui(ui, requests);
        return None;
    }
    let room = ui.available_rect_before_wrap();
    if room.width() < WIDE {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            head_ui(ui, context, &choice, is_working, requests);
            // Near the button, so that the user sees it.
            result_ui(ui, requests);
            settings_ui(ui, context, &choice, requests);
        });
        return None;
    }
    let (left, right) = room.split_left_right_at_x(room.left() + SETTINGS);
    let mut left = ui.new_child(UiBuilder::new().id_salt("settings").max_rect(left));
    ScrollArea::vertical().auto_shrink(false).show(&mut left, |ui| {
        head_ui(ui, context, &choice, is_working, requests);
        settings_ui(ui, context, &choice, requests);
    });
    let right = right.with_min_x(right.left() + 12.0);
    let mut right = ui.new_child(UiBuilder::new().id_salt("result").max_rect(right));
    ScrollArea::vertical().auto_shrink(false).show(&mut right, |ui| result_ui(ui, requests));
    None
}

const HEIGHT: f32 = 190.0;

pub(super) fn path_ui(ui: &mut Ui, tuning: &Tuning, context: &ViewContext<'_>) {
    let is_score = |score: &f64| score.is_finite() && score.abs() < 1e99;
    let scores = || tuning.path().iter().map(|tried| tried.score);
    // If the first tries stop the filter, the gain is relative to the first try that does not.
    let Some(start) = scores().find(is_score) else { return };
    let gains = || scores().enumerate().filter(|(_, score)| is_score(score)).map(|(at, score)| (at, score - start));
    let high = gains().map(|(_, gain)| gain).fold(0.0, f64::max);
    let margin = 0.06 * high.max(1e-3);
    let range = [(-0.3, tuning.path().len().max(2) as f64 - 0.7), (-margin, high + margin)];
    let points: Vec<[f64; 2]> = gains().map(|(at, gain)| [at as f64, gain]).collect();
    let labels = ["better tries, one after the other", "gain over the start"];
    ui.allocate_ui(vec2(ui.available_width(), HEIGHT), |ui| {
        Plane::linear("path of the search", labels).show(ui, context.palette, Some(range), |plot| {
            let color = context.palette.accent;
            plot.line(Line::new("path", points.clone()).color(color).width(1.6).allow_hover(false));
            plot.points(Points::new("tries", points).color(color).radius(2.5).allow_hover(false));
        });
    });
}

pub(super) fn result_ui(ui: &mut Ui, result: &TuneResult, context: &ViewContext<'_>, requests: &mut Vec<Request>) {
    let tuned = &result.tuned;
    let [first, .., last] = &tuned.path[..] else {
        ui.label(TuneRemark::NoBetter.to_string());
        return;
    };
    let goal = result.choice.goal;
    Grid::new("result of the tuning").spacing(vec2(14.0, 3.0)).show(ui, |ui| {
        for text in ["", "before", "after"].into_iter().chain(tuned.bands.is_some().then_some("±2σ")) {
            ui.weak(text);
        }
        ui.end_row();
        let values = first.values.iter().zip(&last.values);
        for (place, (axis, (before, after))) in result.choice.axes.iter().zip(values).enumerate() {
            ui.label(setting_label(&axis.key, &tuned.scenario));
            ui.label(significant(*before, 4));
            ui.label(significant(*after, 4));
            if let Some([low, high]) = tuned.bands.as_ref().and_then(|bands| bands.get(place)) {
                ui.label(format!("{} to {}", significant(*low, 3), significant(*high, 3))).on_hover_text(BAND);
            }
            ui.end_row();
        }
        ui.label(score_name(goal));
        for score in [first.score, last.score] {
            ui.label(score_text(goal, score, &tuned.scenario));
        }
        ui.end_row();
    });
    if let Some(kind) = tuned.verdict {
        let name = tuned.scenario.filters.first().map_or("", |filter| &filter.name);
        let text = format!("{} {name} with these values: {}", verdict::symbol(kind), kind.name());
        ui.colored_label(verdict::text_color(kind, context.palette), text);
    }
    for remark in &tuned.remarks {
        ui.label(said(remark, &tuned.scenario));
    }
    ui.weak(format!("{} runs, for {}", tuned.runs, goal_name(goal)));
    let scenario = context.session.scenario();
    if result.is_applied(scenario) {
        ui.label("These values are in use.");
    } else if let Some(change) = result.change(scenario) {
        if ui.button("Use these values").clicked() {
            requests.push(Request::Edit(change));
        }
    } else {
        ui.weak("The settings have changed since: tune again.");
    }
}

const BAND: &str = "How well the record determines it: where the log likelihood falls by 2, by its curvature at the best values, with the \
                    other settings free";

fn score_name(goal: Goal) -> &'static str {
    match goal {
        Goal::Likelihood => "log likelihood",
        Goal::FreeRun(_) => "free-run error",
        Goal::Consistency => "mean NIS, factor from 1",
    }
}

fn score_text(goal: Goal, score: f64, scenario: &Scenario) -> String {
    match goal {
        _ if score.abs() > 1e99 => "none: the filter stops".to_owned(),
        Goal::Likelihood => format!("{score:.1}").replace('-', "−"),
        Goal::FreeRun(sensor) => format!("{} {}", significant((-score).exp(), 4), unit_in(scenario, sensor.unit())),
        Goal::Consistency => significant((-score).exp(), 4),
    }
}

fn said(remark: &TuneRemark, scenario: &Scenario) -> String {
    match remark {
        TuneRemark::Flat(key) => TuneRemark::Flat(setting_name(key, scenario)).to_string(),
        TuneRemark::Edge(key) => TuneRemark::Edge(setting_name(key, scenario)).to_string(),
        other => other.to_string(),
    }
}

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
        let button = if is_working { Button::new("Stop tuning") } else { primary("Tune", context.palette) };
        if ui.add(button).clicked() {
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
        ui.allocate_ui(size, |ui| field_ui(ui, value, f64::NEG_INFINITY, scale, name.as_str(), &name));
    }
    // Ignores half-typed, impossible ranges.
    if axis.check().is_err() || axis.from >= axis.to {
        *axis = before;
    }
}
