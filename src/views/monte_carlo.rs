//! The scenario over many seeds: consistency and errors over time, and the last estimates.

mod curves;
mod head;
mod over_time;
mod population;

use std::sync::Arc;

use egui::{Rect, ScrollArea, Sense, Ui, UiBuilder, Vec2, pos2, vec2};

use crate::plot::medium::Medium;
use crate::request::Request;
use crate::session::Wanted;
use crate::view::{View, ViewContext};
use curves::Curves;

/// The least width at which the histogram is beside the charts over time \[points\].
const WIDE: f32 = 620.0;

const SHARE: f32 = 0.62;

/// The least height of a chart; with less room the charts scroll \[points\].
const LEAST: f32 = 118.0;

/// The room for the axis below the last chart over time, and that between charts \[points\].
const AXIS: f32 = 28.0;
const GAP: f32 = 8.0;

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
    let is_old = seeds.is_shown_old();
    let has_corner = ui.available_width() >= WIDE && curves.parameter.is_some();
    if !has_corner {
        head::legend_ui(ui, &curves, context, is_old, false);
    }
    let charts = if curves.parameter.is_some() { 4 } else { 2 };
    medium.note_plots(ui.ctx(), charts);
    match medium {
        Medium::Screen => {
            _ = ScrollArea::vertical().auto_shrink(false).show(ui, |ui| charts_ui(ui, &curves, context, is_old));
        }
        Medium::Figure => charts_ui(ui, &curves, context, is_old),
    }
    None
}

fn charts_ui(ui: &mut Ui, curves: &Arc<Curves>, context: &ViewContext<'_>, is_old: bool) {
    let room = ui.available_size().max(Vec2::splat(1.0));
    let is_wide = room.x >= WIDE;
    let charts = over_time::Chart::ALL.into_iter().filter(|chart| chart.is_in(curves)).collect::<Vec<_>>();
    let count = charts.len() as f32;
    let has_histogram = curves.parameter.is_some();
    let is_below = has_histogram && !is_wide;
    let rows = count + f32::from(u8::from(is_below));
    // No run has ended yet.
    if rows == 0.0 {
        return;
    }
    let axes = AXIS * (1.0 + f32::from(u8::from(is_below)));
    let scrolls = Medium::of(ui.ctx()) == Medium::Screen;
    let least = if scrolls { LEAST } else { 1.0 };
    let height = ((room.y - axes - GAP * (rows - 1.0)) / rows).max(least);
    let all = rows * height + axes + GAP * (rows - 1.0);
    let (area, _) = ui.allocate_exact_size(vec2(room.x, all), Sense::hover());
    let width = if is_wide && has_histogram { SHARE * area.width() } else { area.width() };
    let mut top = area.top();
    let mut last = area;
    for (at, chart) in charts.iter().enumerate() {
        let is_last = at + 1 == charts.len();
        let size = vec2(width, height + if is_last { AXIS } else { 0.0 });
        last = Rect::from_min_size(pos2(area.left(), top), size);
        let mut child = ui.new_child(UiBuilder::new().id_salt(("over time", at)).max_rect(last));
        chart.ui(&mut child, last, curves, context, is_last);
        top = last.bottom() + GAP;
    }
    if !has_histogram {
        return;
    }
    let room = if is_wide {
        // As high as the two charts beside it, or as the room under the legend.
        let corner = pos2(area.left() + width + 2.0 * GAP, area.top());
        let bottom = last.top() - height - GAP;
        let legend = Rect::from_min_max(corner, pos2(area.right(), bottom));
        let mut child = ui.new_child(UiBuilder::new().id_salt("legend").max_rect(legend));
        head::legend_ui(&mut child, curves, context, is_old, true);
        let bottom = bottom.max(child.min_rect().bottom() + GAP);
        Rect::from_min_max(pos2(area.left() + width + GAP, bottom), area.max)
    } else {
        Rect::from_min_max(pos2(area.left(), top), area.max)
    };
    let mut child = ui.new_child(UiBuilder::new().id_salt("histogram").max_rect(room));
    over_time::last_estimates_ui(&mut child, room, curves, context);
}
