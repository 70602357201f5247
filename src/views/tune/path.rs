//! The path of the search: the gain of each try that was better than all before.

use egui::{Pos2, Role, Sense, Shape, Stroke, Ui, WidgetInfo, vec2};

use crate::laboratory::Tuning;
use crate::plot::graph::{Graph, Scale};
use crate::view::ViewContext;

/// The height of the picture \[points\].
const HEIGHT: f32 = 190.0;

pub(super) fn path_ui(ui: &mut Ui, tuning: &Tuning, context: &ViewContext<'_>) {
    let is_score = |score: &f64| score.is_finite() && score.abs() < 1e99;
    let scores = || tuning.path().iter().map(|tried| tried.score);
    // If the first tries stop the filter, the gain is relative to the first try that does not.
    let Some(start) = scores().find(is_score) else { return };
    let gains = || scores().enumerate().filter(|(_, score)| is_score(score)).map(|(at, score)| (at, score - start));
    let high = gains().map(|(_, gain)| gain).fold(0.0, f64::max);
    let margin = 0.06 * high.max(1e-3);
    let (room, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::hover());
    let x = Scale::new(-0.3, tuning.path().len().max(2) as f64 - 0.7, false);
    let graph = Graph::new(room, x, Scale::new(-margin, high + margin, false));
    graph.axes_ui(ui, ["better tries, one after the other", "gain over the start"], context.palette, true);
    let points: Vec<Pos2> = gains().map(|(at, gain)| graph.at([at as f64, gain])).collect();
    let painter = ui.painter_at(graph.rect.expand(4.0));
    painter.extend(points.iter().map(|point| Shape::circle_filled(*point, 2.5, context.palette.accent)));
    painter.add(Shape::line(points, Stroke::new(1.6, context.palette.accent)));
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, "Path of the search"));
}
