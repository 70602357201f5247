//! The true mass, and each filter's belief about it.

use egui::epaint::Mesh;
use egui::{Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, Vec2, pos2, vec2};

use super::stage::Stage;
use crate::theme::Palette;

pub(super) fn body(stage: &Stage, painter: &Painter, body: Rect, palette: &Palette) {
    let Palette { truth, ground, .. } = *palette;
    let wheel = stage.wheel();
    for share in [0.22, 0.78] {
        let hub = pos2(body.left() + share * body.width(), stage.floor - wheel);
        painter.circle(hub, wheel, ground.lerp_to_gamma(truth, 0.3), Stroke::new(1.2 * stage.unit, truth));
    }
    let radius = 0.1 * body.height();
    let (light, dark) = (ground.lerp_to_gamma(truth, 0.07), ground.lerp_to_gamma(truth, 0.24));
    painter.add(shaded(body, radius, light, dark));
    painter.rect_stroke(body, radius, Stroke::new(1.8 * stage.unit, truth), StrokeKind::Middle);
}

fn shaded(rect: Rect, radius: f32, top: Color32, bottom: Color32) -> Shape {
    const STEPS: usize = 5;
    let mut mesh = Mesh::default();
    let mut vertex = |at: Pos2| {
        mesh.colored_vertex(at, top.lerp_to_gamma(bottom, (at.y - rect.top()) / rect.height()));
    };
    vertex(rect.center());
    let inner = rect.shrink(radius);
    for (quarter, corner) in
        [inner.right_bottom(), inner.left_bottom(), inner.left_top(), inner.right_top()].into_iter().enumerate()
    {
        for i in 0..STEPS {
            let angle = (quarter as f32 + i as f32 / (STEPS - 1) as f32) * std::f32::consts::FRAC_PI_2;
            vertex(corner + radius * Vec2::angled(angle));
        }
    }
    let rim = 4 * STEPS as u32;
    for i in 0..rim {
        mesh.add_triangle(0, 1 + i, 1 + (i + 1) % rim);
    }
    Shape::mesh(mesh)
}

#[derive(Clone, Copy)]
pub(super) struct Belief {
    /// \[m\]
    pub(super) mean: f64,
    /// \[m\]
    pub(super) std: f64,
    pub(super) color: Color32,
}

/// The slice of a mass that shows the belief at a place among some: all of its width, and a part of its height.
pub(super) fn slice(stage: &Stage, mass: usize, (place, count): (usize, usize), mean: f64) -> Rect {
    let height = stage.body.y / count.max(1) as f32;
    let whole = stage.body(mass, mean);
    let top = whole.top() + place as f32 * height;
    Rect::from_x_y_ranges(whole.x_range(), top..=(top + height)).expand2(vec2(1.6 * stage.unit, 0.0))
}

pub(super) fn ghosts(stage: &Stage, painter: &Painter, mass: usize, beliefs: &[Belief], bands: bool) {
    let unit = stage.unit;
    let height = stage.body.y / beliefs.len().max(1) as f32;
    let stroke = (1.7 * unit).min(0.2 * height);
    let thick = (0.5 * height).min(10.0 * unit);
    for (place, belief) in beliefs.iter().enumerate() {
        let Belief { mean, std, color } = *belief;
        let whole = stage.body(mass, mean);
        let slice = slice(stage, mass, (place, beliefs.len()), mean);
        let outline = slice.shrink2(vec2(0.0, 0.6 * stroke));
        let radius = (0.1 * whole.height()).min(0.3 * height);
        painter.rect_filled(outline, radius, color.gamma_multiply(0.10));
        painter.rect_stroke(outline, radius, Stroke::new(stroke, color), StrokeKind::Middle);
        let middle = pos2(stage.place(mass, mean), slice.center().y);
        let line = |x: f32, half: f32, width: f32| {
            painter.line_segment([pos2(x, middle.y - half), pos2(x, middle.y + half)], Stroke::new(width, color));
        };
        if bands && std.is_finite() {
            let bar = Rect::from_center_size(middle, vec2(2.0 * stage.length(2.0 * std), thick));
            painter.rect_filled(bar, 1.5, color.gamma_multiply(0.4));
            line(bar.left(), 0.5 * thick, unit);
            line(bar.right(), 0.5 * thick, unit);
        }
        line(middle.x, (0.5 * thick + 2.0 * unit).min(0.5 * height - stroke), 1.5 * unit);
    }
}

pub(super) fn name(painter: &Painter, body: Rect, slices: usize, palette: &Palette) {
    let height = body.height() / slices.max(1) as f32;
    let size = (0.62 * height).min(0.24 * body.width()).min(22.0);
    if size >= 9.0 {
        let at = pos2(body.left() + 0.09 * body.width(), body.top() + 0.5 * height);
        let name = painter.layout_no_wrap("m".to_owned(), FontId::proportional(size), palette.truth);
        painter.galley(at - vec2(0.0, 0.5 * name.size().y), name, palette.truth);
    }
}
