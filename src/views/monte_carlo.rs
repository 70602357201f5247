//! The scenario over many seeds: consistency and errors over time, and the last estimates.

mod curves;
mod head;
mod over_time;

use egui::Ui;

use crate::plot::medium::{Medium, cells_ui};
use crate::request::Request;
use crate::session::Wanted;
use crate::view::{View, ViewContext};
use over_time::TimeChart;

pub(super) static VIEW: View = View {
    name: "Monte Carlo",
    help: [
        "The scenario with many seeds: other noise each time, and other numbers where some are drawn. NEES and NIS are means over the seeds, over their expectation.",
        "A consistent filter has both in the grey band, which 95 % of its means are in, and 95 % of its errors, between the thin lines, in its own ±2σ.",
        "Thin lines outside the filled band: the filter is overconfident. Dashed is ±2 times the Cramér-Rao bound, which no unbiased filter passes.",
    ],
    wanted: Wanted::BOUNDS,
    ui: Some(view_ui),
    ..View::NONE
};

fn view_ui(ui: &mut Ui, context: &ViewContext<'_>, requests: &mut Vec<Request>) -> Option<f64> {
    let seeds = &context.laboratory?.seeds;
    let medium = Medium::of(ui.ctx());
    if let Some(problem) = seeds.state.problem.as_deref() {
        ui.weak(problem);
        return None;
    }
    if medium == Medium::Screen {
        head::head_ui(ui, context, seeds, requests);
    }
    let Some(runs) = seeds.shown() else {
        ui.weak("The first seeds are being run.");
        return None;
    };
    let curves = curves::of(ui.ctx(), seeds, runs, context);
    head::legend_ui(ui, &curves, context, seeds);
    let charts: Vec<TimeChart> = TimeChart::ALL.into_iter().filter(|chart| chart.is_in(&curves)).collect();
    let count = charts.len() + usize::from(curves.parameter.is_some());
    cells_ui(ui, count, &mut |ui, at, _| match charts.get(at) {
        Some(chart) => chart.ui(ui, &curves, context),
        None => over_time::last_estimates_ui(ui, &curves, context),
    });
    None
}
