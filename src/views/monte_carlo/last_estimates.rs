//! The chart of the last estimates.

use egui::{Rect, RichText, Role, Sense, Stroke, Tooltip, Ui, WidgetInfo, pos2};

use super::bands::{band, line};
use super::curves::Curves;
use super::over_time::{color, named};
use crate::plot::graph::{Graph, Scale};
use crate::text::significant;
use crate::view::ViewContext;

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
