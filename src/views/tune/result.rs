//! The result: each setting before and after, the scores, the verdict and the remarks.

use egui::{Grid, Ui, vec2};
use kalmanscope_core::Scenario;
use kalmanscope_lab::tune::{Goal, Remark};

use super::settings::goal_name;
use crate::laboratory::{TuneResult, setting_label, setting_name};
use crate::request::Request;
use crate::text::{significant, unit_in};
use crate::verdict;
use crate::view::ViewContext;

pub(super) fn result_ui(ui: &mut Ui, result: &TuneResult, context: &ViewContext<'_>, requests: &mut Vec<Request>) {
    let tuned = &result.tuned;
    let [first, .., last] = &tuned.path[..] else {
        ui.label(Remark::NoBetter.to_string());
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
    } else if let Some(applied) = result.applied(scenario) {
        if ui.button("Use these values").clicked() {
            requests.extend(Request::edit(scenario, &applied));
        }
    } else {
        ui.weak("The settings have changed since: tune again.");
    }
}

const BAND: &str = "How far the record tells it: where the log likelihood falls by 2, by its curvature at the best values, with the \
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

fn said(remark: &Remark, scenario: &Scenario) -> String {
    match remark {
        Remark::Flat(key) => Remark::Flat(setting_name(key, scenario)).to_string(),
        Remark::Edge(key) => Remark::Edge(setting_name(key, scenario)).to_string(),
        other => other.to_string(),
    }
}
