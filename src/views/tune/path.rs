//! The path of the search: the score of each try that was better than all before.

use egui::{Pos2, Role, Sense, Shape, Stroke, Ui, WidgetInfo, vec2};

use crate::laboratory::Tuning;
use crate::plot::graph::{Graph, Scale};
use crate::view::ViewContext;

/// The height of the picture \[points\].
const HEIGHT: f32 = 190.0;

/// Draws the path, if there is one.
pub(super) fn path_ui(ui: &mut Ui, tuning: &Tuning, context: &ViewContext<'_>) {
    let scores: Vec<f64> = tuning.path().iter().map(|tried| tried.score).collect();
    let finite = || scores.iter().copied().filter(|score| score.is_finite() && score.abs() < 1e99);
    let Some(high) = finite().reduce(f64::max) else { return };
    let low = finite().fold(high, f64::min);
    let margin = 0.06 * (high - low).max(1e-3 * high.abs()).max(1e-9);
    let (room, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
    let x = Scale::new(-0.3, scores.len().max(2) as f64 - 0.7, false);
    let graph = Graph::new(room, x, Scale::new(low - margin, high + margin, false));
    graph.axes_ui(ui, ["better tries, one after the other", "score, more is better"], context.palette, true);
    let points: Vec<Pos2> = scores
        .iter()
        .enumerate()
        .filter(|(_, score)| score.is_finite() && score.abs() < 1e99)
        .map(|(at, score)| graph.at([at as f64, *score]))
        .collect();
    let painter = ui.painter_at(graph.rect.expand(4.0));
    painter.extend(points.iter().map(|point| Shape::circle_filled(*point, 2.5, context.palette.accent)));
    painter.add(Shape::line(points, Stroke::new(1.6, context.palette.accent)));
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, "Path of the search"));
}
