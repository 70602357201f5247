//! The line above the charts: seeds, parameter, and the progress.

use egui::{ComboBox, DragValue, RichText, Ui};
use kalmanscope_core::scenario::Law;
use kalmanscope_core::{Channel, Scenario};

use super::curves::{self, FilterCurves, SeedCurves};
use super::over_time::color;
use crate::laboratory::{SEEDS, Seeds, setting_name};
use crate::request::Request;
use crate::text::significant;
use crate::view::ViewContext;

pub(super) fn head_ui(ui: &mut Ui, context: &ViewContext<'_>, seeds: &Seeds, requests: &mut Vec<Request>) {
    let mut next = seeds.choice;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 5.0;
        let speed = (0.02 * next.seeds as f64).max(0.2);
        let number = ui.add(DragValue::new(&mut next.seeds).range(SEEDS).speed(speed).update_while_editing(false));
        let hint = "Runs with the seeds 1 up to this number: other noise each time";
        let number = number.on_hover_text(hint);
        number.ctx.accesskit_node_builder(number.id, |node| node.set_label("Seeds"));
        ui.weak("seeds");
        if let Some(runs) = seeds.shown() {
            let curves = curves::of(ui.ctx(), seeds, runs, context);
            if let Some(shown) = curves.parameter {
                let combo = ComboBox::from_id_salt("parameter of the errors").selected_text(shown.symbol()).width(58.0);
                let combo = combo.show_ui(ui, |ui| {
                    for &channel in &curves.parameters {
                        if ui
                            .selectable_label(channel == shown, format!("{}, {}", channel.symbol(), channel.name()))
                            .clicked()
                        {
                            next.parameter = Some(channel);
                        }
                    }
                });
                ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label("Parameter of the errors"));
            }
        }
        let hint = "The verdict on each run too, which takes longer than the runs";
        let mut verdicts = next.verdicts || next.causes;
        if ui.checkbox(&mut verdicts, "verdicts").on_hover_text(hint).changed() {
            (next.verdicts, next.causes) = (verdicts, false);
        }
        let hint = "The first cause of each bad verdict too, which takes up to seconds a run";
        if ui.checkbox(&mut next.causes, "causes").on_hover_text(hint).changed() {
            next.verdicts |= next.causes;
        }
        if let Some([done, all]) = seeds.progress() {
            let is_stopped = seeds.state.is_stopped;
            if ui.button(if is_stopped { "Go on" } else { "Stop" }).clicked() {
                requests.push(Request::RunSeeds(is_stopped));
            }
            ui.weak(format!("{done} of {all}"));
        }
    });
    if next != seeds.choice {
        requests.push(Request::ChooseSeeds(next));
    }
}

pub(super) fn legend_ui(ui: &mut Ui, curves: &SeedCurves, context: &ViewContext<'_>, seeds: &Seeds) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 12.0;
        let of = if seeds.is_shown_old() { ", of the settings before" } else { "" };
        ui.small(format!("{} seeds{of}", curves.seeds));
        if curves.impossible > 0 {
            ui.small(format!("{} of them are impossible and left out", curves.impossible));
        }
        if let Some(drawn) = seeds.shown().and_then(|runs| drawn(runs.scenario())) {
            ui.small(drawn);
        }
        for filter in &curves.filters {
            let all = [Some(lost(filter)), near(filter, curves.parameter), verdicts(filter), causes(filter)];
            for text in all.into_iter().flatten() {
                ui.label(RichText::new(text).small().color(color(context, filter.id)));
            }
        }
        let has_bounds = !context.session.bounds().is_empty() && curves.parameter.is_some() && !curves.is_of_errors;
        let all = [
            (true, "grey: 95 % of the means of a consistent filter"),
            (curves.parameter.is_some(), "filled: ±2σ of the filter"),
            (curves.parameter.is_some(), "lines: median and 95 % of the errors"),
            (has_bounds, "dashed: ±2 × Cramér-Rao bound"),
        ];
        for (_, text) in all.into_iter().filter(|(is_there, _)| *is_there) {
            ui.label(RichText::new(text).small().weak());
        }
    });
}

fn drawn(scenario: &Scenario) -> Option<String> {
    let one = |(key, law): (&String, &Law)| {
        let [a, b] = law.numbers().map(|number| significant(number, 4));
        let of = scenario.filters_at(key).filter(|(places, _)| places.len() == 1 && scenario.filters.len() > 1);
        let of = of.and_then(|(places, _)| scenario.filters.get(*places.first()?));
        let of = of.map_or(String::new(), |filter| format!(", {}", filter.name));
        format!("{}{of} {} ({a}, {b})", setting_name(key, scenario), law.info().name)
    };
    let all: Vec<String> = scenario.draw.iter().map(one).collect();
    (!all.is_empty()).then(|| format!("drawn: {}", all.join("; ")))
}

fn near(filter: &FilterCurves, parameter: Option<Channel>) -> Option<String> {
    let ([within, inside], symbol) = (filter.shares?, parameter?.symbol());
    Some(format!("{symbol} within 1 %: {}, inside ±2σ: {}", percent(within), percent(inside)))
}

fn verdicts(filter: &FilterCurves) -> Option<String> {
    let all: Vec<String> =
        filter.verdicts.iter().map(|(kind, share)| format!("{} {}", percent(*share), kind.name())).collect();
    (!all.is_empty()).then(|| all.join(", "))
}

fn causes(filter: &FilterCurves) -> Option<String> {
    let one = |(name, share): &(Option<&str>, f64)| format!("{} {}", percent(*share), name.unwrap_or("none found"));
    let all: Vec<String> = filter.causes.iter().map(one).collect();
    (!all.is_empty()).then(|| format!("causes of bad verdicts: {}", all.join(", ")))
}

fn percent(share: f64) -> String {
    match 100.0 * share {
        none if none.is_nan() => "–".to_owned(),
        0.0 => "0 %".to_owned(),
        small if small < 1.0 => format!("{small:.1} %"),
        share => format!("{share:.0} %"),
    }
}

fn lost(filter: &FilterCurves) -> String {
    let FilterCurves { name, diverged: [diverged, stopped], .. } = filter;
    let stopped = if *stopped > 0.0 { format!(", {} stopped", percent(*stopped)) } else { String::new() };
    format!("{name}: {} lost the truth{stopped}", percent(*diverged))
}
