//! The score along the row and the column of the map through the dot, above and beside the cells.

use egui::{Align2, Pos2, Rect, Sense, Shape, Stroke, TextStyle, Ui, Vec2, pos2};
use kalmanscope_core::{Axis, Measure};

use super::picture::{Contents, Panel};
use crate::controls::filter::color_of;
use crate::laboratory::Survey;
use crate::plot::graph::Graph;
use crate::view::ViewContext;

/// The height of a curve, and its distance from the cells \[points\].
const HEIGHT: f32 = 40.0;
const APART: f32 = 6.0;

/// The least distance between numbers beside a curve, and below one \[points\].
const BETWEEN: [f64; 2] = [13.0, 24.0];

/// The least size of a panel that gives room to the curves \[points\].
const LEAST: Vec2 = Vec2::new(380.0, 190.0);

/// The room of a curve in a panel of some size \[points\]: zero if the cells need it, or if the score is no number.
pub(super) fn room(size: Vec2, measure: Measure) -> f32 {
    let has_room = size.x >= LEAST.x && size.y >= LEAST.y;
    if has_room && !measure.info().kind.is_of_kinds() { HEIGHT + APART } else { 0.0 }
}

/// Draws both curves over the scale of the colours, which leaves out values that would hide the differences of the others.
pub(super) fn profiles_ui(ui: &Ui, graph: &Graph, panel: &Panel, survey: &Survey, context: &ViewContext<'_>) {
    let palette = context.palette;
    let axes = survey.axes();
    let present = survey.present(context.session.scenario());
    let color = match panel.contents {
        Contents::Filter(at) => {
            let id = survey.filters[at];
            let own = context.session.scenario().filters.iter().find(|filter| filter.id == id);
            own.map_or(palette.text, |filter| palette.shade(color_of(filter)))
        }
        Contents::Comparison => palette.text,
    };
    let cells = graph.rect;
    let above = Rect::from_x_y_ranges(cells.x_range(), cells.top() - APART - HEIGHT..=cells.top() - APART);
    let beside = Rect::from_x_y_ranges(cells.right() + APART..=cells.right() + APART + HEIGHT, cells.y_range());
    let [across, up] = [0, 1].map(|at| nearest(axes[at], present[at]));
    let font = TextStyle::Small.resolve(ui.style());
    for (at, rect) in [above, beside].into_iter().enumerate() {
        let place = |along: f64, score: f64| match at {
            0 => pos2(graph.at_shares([along, 0.0]).x, rect.bottom() - score as f32 * HEIGHT),
            _ => pos2(rect.left() + score as f32 * HEIGHT, graph.at_shares([0.0, along]).y),
        };
        let painter = ui.painter();
        painter.line_segment([place(0.0, 0.0), place(1.0, 0.0)], Stroke::new(1.0, palette.grid));
        let mut numbers: Vec<f64> = Vec::new();
        for (share, text) in panel.colors.ticks(HEIGHT) {
            // The bar of colours has room for more, and the axis of the cells ends in a number.
            let is_beside_the_axis = at == 1 && share * f64::from(HEIGHT) < BETWEEN[at];
            if is_beside_the_axis || numbers.iter().any(|other| (share - other).abs() * f64::from(HEIGHT) < BETWEEN[at])
            {
                continue;
            }
            numbers.push(share);
            let end = place(0.0, share);
            let (end, align) = if at == 0 {
                (end - Vec2::new(5.0, 0.0), Align2::RIGHT_CENTER)
            } else {
                (end + Vec2::new(0.0, 4.0), Align2::CENTER_TOP)
            };
            painter.line_segment([place(0.0, share), place(1.0, share)], Stroke::new(0.5, palette.grid));
            painter.text(end, align, text, font.clone(), palette.weak);
        }
        let count = panel.counts[at];
        let point = |step: usize| {
            let cell = if at == 0 { step * panel.counts[1] + up } else { across * panel.counts[1] + step };
            let share = panel.colors.share(panel.cells[cell].value).clamp(0.0, 1.0);
            share.is_finite().then(|| place((step as f64 + 0.5) / count as f64, share))
        };
        let points: Vec<Option<Pos2>> = (0..count).map(point).collect();
        for part in points.split(Option::is_none) {
            let part: Vec<Pos2> = part.iter().flatten().copied().collect();
            match part[..] {
                [alone] => _ = painter.circle_filled(alone, 1.5, color),
                _ => _ = painter.add(Shape::line(part, Stroke::new(1.8, color))),
            }
        }
        let response = ui.interact(rect, ui.scope_id().with(("profile", at)), Sense::hover());
        let name = ["Score across", "Score up"][at];
        response.ctx.accesskit_node_builder(response.id, |node| {
            node.set_label(format!("{name}, through the dot"));
            let [x0, y0, x1, y1] = [rect.left(), rect.top(), rect.right(), rect.bottom()].map(f64::from);
            node.set_bounds(egui::accesskit::Rect { x0, y0, x1, y1 });
        });
    }
}

fn nearest(axis: &Axis, value: f64) -> usize {
    let last = axis.count.saturating_sub(1);
    ((axis.share_of(value).clamp(0.0, 1.0) * last as f64).round() as usize).min(last)
}
