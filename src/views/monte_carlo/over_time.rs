//! The charts: NEES, NIS and the error of the parameter over time, and the histogram of the last estimates.

use std::ops::RangeInclusive;

use egui::{
    Color32, Mesh, Painter, Pos2, Rect, Response, RichText, Role, Sense, Shape, Stroke, Tooltip, Ui, WidgetInfo, pos2,
};
use kalmanscope_core::Channel;

use super::curves::{Curves, FilterCurves};
use crate::plot::axes::{Graph, Scale};
use crate::session::Bound;
use crate::text::{fixed, significant};
use crate::view::ViewContext;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Chart {
    Nees,
    Nis,
    Error,
}

const FILL: f32 = 0.16;
const GREY: f32 = 0.32;

/// Limits the axis of NEES and NIS.
const RATIOS: RangeInclusive<f64> = 1e-3..=1e6;

impl Chart {
    pub(super) const ALL: [Self; 3] = [Self::Nees, Self::Nis, Self::Error];

    pub(super) fn is_in(self, curves: &Curves) -> bool {
        let has = |values: &[f64]| values.iter().any(|value| value.is_finite());
        match self {
            Self::Nees => curves.filters.iter().any(|filter| has(&filter.nees)),
            Self::Nis => curves.filters.iter().any(|filter| has(&filter.nis)),
            Self::Error => curves.parameter.is_some(),
        }
    }

    pub(super) fn ui(self, ui: &mut Ui, room: Rect, curves: &Curves, context: &ViewContext<'_>, is_last: bool) {
        let x = Scale::new(0.0, curves.duration.max(f64::MIN_POSITIVE), false);
        let y = self.scale(curves);
        let graph = if is_last { Graph::new(room, x, y) } else { Graph::above(room, x, y) };
        let name = self.name(curves, context);
        graph.axes_ui(ui, ["time [s]", &name], context.palette, true);
        let painter = ui.painter_at(graph.rect.expand(1.0));
        match self {
            Self::Nees | Self::Nis => self.paint_ratios(&painter, &graph, curves, context),
            Self::Error => paint_errors(&painter, &graph, curves, context),
        }
        let response = ui.interact(graph.rect, ui.scope_id().with("chart"), Sense::hover());
        let label = match self {
            Self::Nees => "Mean NEES over time".to_owned(),
            Self::Nis => "Mean NIS over time".to_owned(),
            Self::Error => format!("Errors over time, {name}"),
        };
        response.widget_info(|| WidgetInfo::labeled(Role::Image, true, label.clone()));
        self.point_ui(&response, &graph, curves, context);
    }

    fn name(self, curves: &Curves, context: &ViewContext<'_>) -> String {
        match (self, curves.parameter) {
            (Self::Nees, _) => "mean NEES".to_owned(),
            (Self::Nis, _) => "mean NIS".to_owned(),
            (Self::Error, None) => String::new(),
            (Self::Error, Some(channel)) => named("error of ", channel, context),
        }
    }

    fn ratios(self, filter: &FilterCurves) -> (&[f64], &[Option<RangeInclusive<f64>>]) {
        match self {
            Self::Nees => (&filter.nees, &filter.nees_band),
            Self::Nis | Self::Error => (&filter.nis, &filter.nis_band),
        }
    }

    fn scale(self, curves: &Curves) -> Scale {
        if self == Self::Error {
            let reach = reach(curves);
            return Scale::new(-reach, reach, false);
        }
        let (mut low, mut high) = (0.5_f64, 2.0_f64);
        for filter in &curves.filters {
            let (values, bands) = self.ratios(filter);
            let ends = bands.iter().flatten().flat_map(|band| [*band.start(), *band.end()]);
            for value in values.iter().copied().chain(ends).filter(|value| *value > 0.0 && value.is_finite()) {
                (low, high) = (low.min(value / 1.15), high.max(value * 1.15));
            }
        }
        Scale::new(low.max(*RATIOS.start()), high.min(*RATIOS.end()), true)
    }

    fn paint_ratios(self, painter: &Painter, graph: &Graph, curves: &Curves, context: &ViewContext<'_>) {
        let palette = context.palette;
        let mut drawn: Vec<&[Option<RangeInclusive<f64>>]> = Vec::new();
        for filter in &curves.filters {
            let (_, bands) = self.ratios(filter);
            // Filters with equal degrees of freedom share one band.
            if drawn.contains(&bands) {
                continue;
            }
            drawn.push(bands);
            let ends = |band: &Option<RangeInclusive<f64>>| {
                band.as_ref().map_or([f64::NAN; 2], |band| [*band.start(), *band.end()])
            };
            let rungs = curves.times.iter().copied().zip(bands.iter().map(ends));
            band(painter, graph, rungs, palette.grid.gamma_multiply(GREY));
        }
        let ends = [[0.0, 1.0], [curves.duration, 1.0]];
        line(painter, graph, ends.into_iter(), Stroke::new(1.0, palette.truth), false);
        for (at, filter) in curves.filters.iter().enumerate() {
            let (values, _) = self.ratios(filter);
            let points = curves.times.iter().zip(values).map(|(time, value)| [*time, *value]);
            line(painter, graph, points, Stroke::new(width(at), color(context, filter.id)), false);
        }
    }

    fn point_ui(self, response: &Response, graph: &Graph, curves: &Curves, context: &ViewContext<'_>) {
        let Some(pointer) = response.hover_pos().filter(|_| response.hovered()) else { return };
        let time = graph.shares(pointer)[0] * curves.duration;
        let nearest =
            curves.times.iter().enumerate().min_by(|(_, a), (_, b)| (*a - time).abs().total_cmp(&(*b - time).abs()));
        let Some((at, time)) = nearest else { return };
        let x = graph.at([*time, f64::NAN]).x;
        let ends = [pos2(x, graph.rect.top()), pos2(x, graph.rect.bottom())];
        response.ctx.layer_painter(response.layer_id).line_segment(ends, Stroke::new(1.0, context.palette.weak));
        Tooltip::for_widget(response).at_pointer().gap(12.0).show(|ui| {
            ui.weak(format!("{} s, {} seeds", significant(*time, 4), curves.seeds));
            for filter in &curves.filters {
                ui.label(RichText::new(self.said(filter, at, curves)).color(color(context, filter.id)));
            }
        });
    }

    fn said(self, filter: &FilterCurves, at: usize, curves: &Curves) -> String {
        let name = &filter.name;
        if self != Self::Error {
            let (values, bands) = self.ratios(filter);
            let value = values.get(at).copied().unwrap_or(f64::NAN);
            let band = bands.get(at).cloned().flatten();
            let band = band.map_or(String::new(), |band| format!(", 95 % in {:.3} to {:.3}", band.start(), band.end()));
            return format!("{name}: {}{band}", significant(value, 3));
        }
        let decimals = curves.parameter.map_or(3, crate::text::decimals) + 1;
        let Some([low, middle, high]) = filter.quantiles.get(at) else { return format!("{name}: –") };
        let std = filter.std.get(at).copied().unwrap_or(f64::NAN);
        let [low, middle, high, reach] = [*low, *middle, *high, 2.0 * std].map(|value| fixed(value, decimals));
        format!("{name}: {low}, median {middle}, {high}; ±2σ = {reach}")
    }
}

pub(super) fn named(what: &str, channel: Channel, context: &ViewContext<'_>) -> String {
    let unit = context.unit(channel.unit());
    let symbol = channel.symbol();
    if unit.is_empty() { format!("{what}{symbol}") } else { format!("{what}{symbol} [{unit}]") }
}

pub(super) fn color(context: &ViewContext<'_>, id: u32) -> Color32 {
    let own = context.session.scenario().filters.iter().find(|filter| filter.id == id);
    own.map_or(context.palette.text, |filter| context.palette.shade(crate::controls::filter::color_of(filter)))
}

/// The width of the line of the filter at a place. Later lines are thinner, so that they do not hide earlier ones.
fn width(at: usize) -> f32 {
    (3.4 - 1.4 * at as f32).max(1.4)
}

/// The largest error on the axis. The first tenth of the times, with their wide beliefs, may go beyond it.
fn reach(curves: &Curves) -> f64 {
    let mut reach = 0.0_f64;
    for filter in &curves.filters {
        let begin = filter.quantiles.len() / 10;
        for ([low, _, high], std) in filter.quantiles.iter().zip(&filter.std).skip(begin) {
            for value in [low.abs(), high.abs(), 2.0 * std] {
                reach = if value.is_finite() { reach.max(value) } else { reach };
            }
        }
    }
    if reach > 0.0 { 1.15 * reach } else { 1.0 }
}

fn paint_errors(painter: &Painter, graph: &Graph, curves: &Curves, context: &ViewContext<'_>) {
    let times = || curves.times.iter().copied();
    for filter in &curves.filters {
        let rungs = times().zip(filter.std.iter().map(|std| [-2.0 * std, 2.0 * std]));
        band(painter, graph, rungs, color(context, filter.id).gamma_multiply(FILL));
    }
    let zero = [[0.0, 0.0], [curves.duration, 0.0]];
    line(painter, graph, zero.into_iter(), Stroke::new(1.0, context.palette.truth), false);
    for (at, filter) in curves.filters.iter().enumerate() {
        for (quantile, width) in [(0, 1.0), (1, width(at)), (2, 1.0)] {
            let points = times().zip(&filter.quantiles).map(|(time, all)| [time, all[quantile]]);
            line(painter, graph, points, Stroke::new(width, color(context, filter.id)), false);
        }
    }
    for (id, reach) in bounds(curves, context) {
        for sign in [-2.0, 2.0] {
            let points = times().zip(&reach).map(|(time, std)| [time, sign * std]);
            line(painter, graph, points, Stroke::new(1.2, color(context, id)), true);
        }
    }
}

/// The Cramér-Rao bounds of the run on screen at the times of the curves, each with the first filter that it is for.
fn bounds(curves: &Curves, context: &ViewContext<'_>) -> Vec<(u32, Vec<f64>)> {
    // The bound is that of one truth.
    let Some(channel) = curves.parameter.filter(|_| !curves.is_of_errors) else { return Vec::new() };
    let one = |Bound { bound, filters }: &Bound| {
        let first = curves.filters.iter().find(|filter| filters.contains(&filter.id))?;
        let at = bound.place(channel)?;
        let std = |sample: &usize| if *sample < bound.len() { bound.std(*sample, at) } else { f64::NAN };
        Some((first.id, curves.samples.iter().map(std).collect()))
    };
    context.session.bounds().iter().filter_map(one).collect()
}

/// Fills the area between pairs of values; it has a gap where one of them is NaN.
pub(super) fn band(painter: &Painter, graph: &Graph, rungs: impl Iterator<Item = (f64, [f64; 2])>, color: Color32) {
    let mut mesh = Mesh::default();
    let mut before: Option<u32> = None;
    for (x, [low, high]) in rungs {
        if !(low.is_finite() && high.is_finite()) {
            before = None;
            continue;
        }
        let at = mesh.vertices.len() as u32;
        for y in [low, high] {
            mesh.colored_vertex(within(graph, graph.at([x, y])), color);
        }
        if let Some(last) = before {
            mesh.add_triangle(last, last + 1, at);
            mesh.add_triangle(last + 1, at, at + 1);
        }
        before = Some(at);
    }
    painter.add(Shape::mesh(mesh));
}

pub(super) fn line(
    painter: &Painter,
    graph: &Graph,
    points: impl Iterator<Item = [f64; 2]>,
    stroke: Stroke,
    dashed: bool,
) {
    let points: Vec<Pos2> = points.map(|point| within(graph, graph.at(point))).collect();
    for part in points.split(|point| !point.y.is_finite()).filter(|part| part.len() > 1) {
        if dashed {
            painter.extend(Shape::dashed_line(part, stroke, 5.0, 3.0));
        } else {
            painter.add(Shape::line(part.to_vec(), stroke));
        }
    }
}

/// A point no further beyond the frame than half its height: edges far away would cost time and blur.
fn within(graph: &Graph, at: Pos2) -> Pos2 {
    let beyond = 0.5 * graph.rect.height();
    if at.y.is_nan() {
        return at;
    }
    egui::pos2(at.x, at.y.clamp(graph.rect.top() - beyond, graph.rect.bottom() + beyond))
}

pub(super) fn last_estimates_ui(ui: &mut Ui, room: Rect, curves: &Curves, context: &ViewContext<'_>) {
    let Some(channel) = curves.parameter else { return };
    let histogram = &curves.histogram;
    let palette = context.palette;
    let highest = histogram.counts.iter().flatten().copied().max().unwrap_or_default().max(1);
    let graph = Graph::new(
        room,
        Scale::new(histogram.from, histogram.to, false),
        Scale::new(0.0, 1.08 * highest as f64, false),
    );
    let what = if curves.is_of_errors { "last error of " } else { "last estimate of " };
    let name = named(what, channel, context);
    graph.axes_ui(ui, [&name, "seeds"], palette, true);
    let painter = ui.painter_at(graph.rect.expand(1.0));
    for (filter, counts) in curves.filters.iter().zip(&histogram.counts) {
        let color = color(context, filter.id);
        let steps: Vec<[f64; 2]> = counts
            .iter()
            .enumerate()
            .flat_map(|(bar, count)| histogram.ends(bar).map(|edge| [edge, *count as f64]))
            .collect();
        band(&painter, &graph, steps.iter().map(|[x, y]| (*x, [0.0, *y])), color.gamma_multiply(0.16));
        line(&painter, &graph, steps.into_iter(), Stroke::new(1.6, color), false);
    }
    if let Some(truth) = curves.truth.or(curves.is_of_errors.then_some(0.0)) {
        let x = graph.at([truth, f64::NAN]).x;
        painter
            .line_segment([pos2(x, graph.rect.top()), pos2(x, graph.rect.bottom())], Stroke::new(1.6, palette.truth));
    }
    let response = ui.interact(graph.rect, ui.scope_id().with("bars"), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, format!("Histogram, {name}")));
    let Some(pointer) = response.hover_pos().filter(|_| response.hovered() && histogram.bars() > 0) else { return };
    let bar = ((graph.shares(pointer)[0] * histogram.bars() as f64).max(0.0) as usize).min(histogram.bars() - 1);
    let [from, to] = histogram.ends(bar);
    Tooltip::for_widget(&response).at_pointer().gap(12.0).show(|ui| {
        ui.weak(format!("{} to {} {}", significant(from, 5), significant(to, 5), context.unit(channel.unit())));
        for ((filter, counts), beyond) in curves.filters.iter().zip(&histogram.counts).zip(&histogram.beyond) {
            let aside = if *beyond > 0 { format!(", and {beyond} beyond the ends") } else { String::new() };
            let text = format!("{}: {} of {} seeds{aside}", filter.name, counts[bar], curves.seeds);
            ui.label(RichText::new(text).color(color(context, filter.id)));
        }
    });
}
