//! Wall and ground, with a scale in metres, or in the unit of the record's motion.

use egui::{Align2, Color32, Painter, Rect, Shape, Stroke, pos2, vec2};

use super::masses::MAX_MASSES;
use super::stage::Stage;
use crate::plot::ticks::{tick, ticks};
use crate::theme::Palette;

pub(super) fn ground(stage: &Stage, painter: &Painter, length: &str, palette: &Palette) {
    let Stage { unit, floor, wall, rect, body, .. } = *stage;
    let right = rect.right() - 8.0;
    let top = stage.body(0, 0.0).top() - 6.0 * unit;
    let depth = 5.0 * unit;
    let earth = palette.weak.gamma_multiply(0.16);
    painter.rect_filled(Rect::from_min_max(pos2(wall - depth, floor), pos2(right, floor + depth)), 0.0, earth);
    painter.rect_filled(Rect::from_min_max(pos2(wall - depth, top), pos2(wall, floor)), 0.0, earth);
    let hatch = Stroke::new(0.8, palette.weak.gamma_multiply(0.55));
    let pitch = 2.0 * depth;
    let below = (0..((right - wall - depth) / pitch) as usize).map(|i| pos2(wall + i as f32 * pitch, floor));
    let beside = (0..((floor - top) / pitch) as usize).map(|i| pos2(wall - depth, top + i as f32 * pitch));
    let strokes = below.chain(beside).map(|at| [at + vec2(depth, 0.0), at + vec2(0.0, depth)]);
    painter.extend(strokes.map(|ends| Shape::line_segment(ends, hatch)));
    let edge = Stroke::new(1.3 * unit, palette.weak);
    painter.line_segment([pos2(wall, floor), pos2(right, floor)], edge);
    painter.line_segment([pos2(wall, floor), pos2(wall, top)], edge);
    for mass in 0..stage.masses() {
        let x = stage.rest(mass);
        let rest = Stroke::new(1.0, palette.weak.gamma_multiply(0.4));
        painter.extend(Shape::dashed_line(&[pos2(x, floor - body.y - 8.0 * unit), pos2(x, floor)], rest, 3.0, 4.0));
    }
    if stage.masses() == 1 { ruler(stage, painter, length, palette) } else { bar(stage, painter, length, palette) }
}

fn ruler(stage: &Stage, painter: &Painter, length: &str, palette: &Palette) {
    let reach = stage.metres(stage.travel + 0.25 * stage.body.x);
    let count = (stage.travel / (26.0 * stage.unit)).max(3.0);
    // At least one mark on either side of zero.
    let marks = [count, 4.0, 5.0, 6.0].map(|count| ticks((-reach, reach), count));
    for mark in marks.into_iter().find(|marks| marks.len() >= 3).unwrap_or_default() {
        let x = stage.place(0, mark.value);
        mark_at(stage, painter, x, palette.weak);
        let zero = mark.value.abs() < 0.5 * mark.step_size;
        let text = if zero { format!("0 {length}") } else { tick(mark.value, mark.step_size) };
        label(stage, painter, x, &text, palette);
    }
}

const NAMES: [&str; MAX_MASSES] = ["m₁", "m₂", "m₃", "m₄", "m₅", "m₆", "m₇", "m₈", "m₉", "m₁₀"];

/// A bar of known length, under its name, because each mass has its own zero.
fn bar(stage: &Stage, painter: &Painter, length: &str, palette: &Palette) {
    for (mass, name) in NAMES.into_iter().enumerate().take(stage.masses()) {
        mark_at(stage, painter, stage.rest(mass), palette.weak);
        label(stage, painter, stage.rest(mass), name, palette);
    }
    let longest = stage.metres(stage.body.x.max(0.5 * stage.gap));
    let Some(mark) = ticks((0.0, longest), 3.0).into_iter().nth(1) else { return };
    let x = stage.rest(0) - 0.5 * stage.body.x - 0.5 * stage.gap;
    let half = 0.5 * stage.length(mark.value);
    let y = stage.floor + 2.5 * stage.unit;
    painter.line_segment([pos2(x - half, y), pos2(x + half, y)], Stroke::new(2.0 * stage.unit, palette.text));
    for end in [x - half, x + half] {
        mark_at(stage, painter, end, palette.text);
    }
    label(stage, painter, x, &format!("{} {length}", tick(mark.value, mark.step_size)), palette);
}

fn mark_at(stage: &Stage, painter: &Painter, x: f32, color: Color32) {
    let stroke = Stroke::new(1.3 * stage.unit, color);
    painter.line_segment([pos2(x, stage.floor), pos2(x, stage.floor + 5.0 * stage.unit)], stroke);
}

fn label(stage: &Stage, painter: &Painter, x: f32, text: &str, palette: &Palette) {
    let mut font = stage.font();
    font.size = (0.92 * font.size).max(10.0);
    let at = pos2(x, stage.floor + 4.0 * stage.unit);
    painter.text(at + vec2(0.0, -1.0), Align2::CENTER_TOP, text, font, palette.weak);
}
