//! Bands and lines in a frame.

use egui::{Color32, Mesh, Painter, Pos2, Shape, Stroke};

use crate::plot::graph::Graph;

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
