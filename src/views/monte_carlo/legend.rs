//! The lines above the charts: the seeds, each filter's share of lost runs, and the marks.

use egui::{RichText, Ui};
use kalmanscope_core::Channel;

use super::curves::{Curves, FilterCurves};
use super::over_time::color;
use crate::view::ViewContext;

pub(super) fn legend_ui(ui: &mut Ui, curves: &Curves, context: &ViewContext<'_>, is_old: bool, is_column: bool) {
    let lines = |ui: &mut Ui| {
        let of = if is_old { ", of the settings before" } else { "" };
        ui.small(format!("{} seeds{of}", curves.seeds));
        if curves.impossible > 0 {
            ui.small(format!("{} of them are impossible and left out", curves.impossible));
        }
        if let Some(drawn) = &curves.drawn {
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
    };
    if is_column {
        lines(ui);
    } else {
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = 12.0;
            lines(ui);
        });
    }
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
