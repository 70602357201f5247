//! The path of a search through the map, from a ring to a square.

use egui::{Color32, Pos2, Rect, Shape, Stroke, StrokeKind, Ui, Vec2};

use crate::plot::graph::Graph;

/// The radius of a point on the path, and of its ends \[points\].
const POINT: f32 = 1.8;
const END: f32 = 4.0;

pub(super) struct Path {
    pub(super) filter: usize,
    pub(super) points: Vec<[f64; 2]>,
}

pub(super) fn path_ui(ui: &Ui, graph: &Graph, path: &Path) {
    let points: Vec<Pos2> =
        path.points.iter().map(|point| graph.at(*point)).filter(|at| at.x.is_finite() && at.y.is_finite()).collect();
    let [first, .., last] = points[..] else { return };
    let painter = ui.painter_at(graph.rect.expand(END));
    painter.add(Shape::line(points.clone(), Stroke::new(3.2, Color32::from_black_alpha(200))));
    painter.add(Shape::line(points.clone(), Stroke::new(1.4, Color32::WHITE)));
    for point in &points {
        painter.circle_filled(*point, POINT, Color32::WHITE);
    }
    start(&painter, first, END);
    end(&painter, last, END);
}

fn start(painter: &egui::Painter, at: Pos2, size: f32) {
    painter.circle(at, size, Color32::BLACK, Stroke::new(1.6, Color32::WHITE));
}

fn end(painter: &egui::Painter, at: Pos2, size: f32) {
    let square = Rect::from_center_size(at, Vec2::splat(1.8 * size));
    painter.rect(square, 0.0, Color32::WHITE, Stroke::new(1.4, Color32::BLACK), StrokeKind::Middle);
}

pub(super) fn sample(painter: &egui::Painter, rect: Rect) {
    const SMALL: f32 = 2.6;
    let ends = [rect.left_center() + Vec2::new(SMALL, 0.0), rect.right_center() - Vec2::new(SMALL, 0.0)];
    painter.line_segment(ends, Stroke::new(1.4, Color32::GRAY));
    start(painter, ends[0], SMALL);
    end(painter, ends[1], SMALL);
}
