//! The force, as an arrow from the mast of each mass.

use egui::{Align2, Color32, Painter, Shape, Stroke, pos2, vec2};

use super::stage::Stage;

pub(super) fn arrow(stage: &Stage, painter: &Painter, x: f32, share: f64, color: Color32) {
    let unit = stage.unit;
    let length = share.clamp(-1.0, 1.0) as f32 * stage.longest_arrow();
    let tail = pos2(x, stage.arrow);
    let head = vec2(length.signum() * (9.0 * unit).min(length.abs()), 0.0);
    let tip = tail + vec2(length, 0.0);
    let side = vec2(0.0, 0.5 * head.x);
    painter.line_segment([tail, tip - 0.8 * head], Stroke::new(2.6 * unit, color));
    painter.add(Shape::convex_polygon(vec![tip, tip - head - side, tip - head + side], color, Stroke::NONE));
    painter.circle_filled(tail, 2.2 * unit, color);
    let room = tail.y - 3.0 * unit - stage.rect.top();
    if room < stage.font().size {
        return;
    }
    // The label is above the mast: at the tip it would jump at every change of sign.
    painter.text(tail - vec2(0.0, 3.0 * unit), Align2::CENTER_BOTTOM, "f", stage.font(), color);
}
