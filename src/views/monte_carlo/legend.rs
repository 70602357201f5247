//! The lines above the charts: the seeds, each filter's share of lost runs, and the marks.

use egui::{RichText, Ui};

use super::curves::{Curves, FilterCurves};
use super::over_time::color;
use crate::view::ViewContext;

/// Shows the seeds so far, and for each filter in its colour its number of lost or stopped runs; one below the other in
/// a column.
pub(super) fn legend_ui(ui: &mut Ui, curves: &Curves, context: &ViewContext<'_>, is_old: bool, is_column: bool) {
    let lines = |ui: &mut Ui| {
        let of = if is_old { ", of the settings before" } else { "" };
        ui.small(format!("{} seeds{of}", curves.seeds));
        for filter in &curves.filters {
            ui.label(RichText::new(lost(filter)).small().color(color(context, filter.id)));
        }
        let has_bounds = !context.session.bounds().is_empty() && curves.parameter.is_some();
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

fn lost(filter: &FilterCurves) -> String {
    let FilterCurves { name, diverged: [diverged, stopped], .. } = filter;
    let percent = |share: f64| match 100.0 * share {
        0.0 => "0 %".to_owned(),
        small if small < 1.0 => format!("{small:.1} %"),
        share => format!("{share:.0} %"),
    };
    let stopped = if *stopped > 0.0 { format!(", {} stopped", percent(*stopped)) } else { String::new() };
    format!("{name}: {} lost the truth{stopped}", percent(*diverged))
}
