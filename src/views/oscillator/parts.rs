//! The parts of the picture: the masses and each filter's belief, springs and dampers, wall and ground, force.

use std::f32::consts::TAU;

use egui::{Align2, Color32, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, pos2, vec2};
use kalmanscope_core::Channel;

use super::stage::SceneFrame;
use crate::plot::axes::{tick, ticks};
use crate::theme::Palette;

pub(super) fn body(stage: &SceneFrame, painter: &Painter, body: Rect, palette: &Palette) {
    let Palette { truth, ground, .. } = *palette;
    let wheel = stage.wheel();
    for share in [0.22, 0.78] {
        let hub = pos2(body.left() + share * body.width(), stage.floor - wheel);
        painter.circle(hub, wheel, ground.lerp_to_gamma(truth, 0.3), Stroke::new(1.2 * stage.unit, truth));
    }
    let radius = 0.1 * body.height();
    painter.rect(
        body,
        radius,
        ground.lerp_to_gamma(truth, 0.14),
        Stroke::new(1.8 * stage.unit, truth),
        StrokeKind::Middle,
    );
}

#[derive(Clone, Copy)]
pub(super) struct MassBelief {
    pub(super) mean: f64,
    pub(super) std: f64,
    pub(super) color: Color32,
}

pub(super) fn slice(stage: &SceneFrame, mass: usize, (place, count): (usize, usize), mean: f64) -> Rect {
    let height = stage.body.y / count.max(1) as f32;
    let whole = stage.body(mass, mean);
    let top = whole.top() + place as f32 * height;
    Rect::from_x_y_ranges(whole.x_range(), top..=(top + height)).expand2(vec2(1.6 * stage.unit, 0.0))
}

pub(super) fn ghosts(stage: &SceneFrame, painter: &Painter, mass: usize, beliefs: &[MassBelief], bands: bool) {
    let unit = stage.unit;
    let height = stage.body.y / beliefs.len().max(1) as f32;
    let stroke = (1.7 * unit).min(0.2 * height);
    let thick = (0.5 * height).min(10.0 * unit);
    for (place, belief) in beliefs.iter().enumerate() {
        let MassBelief { mean, std, color } = *belief;
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

pub(super) fn ground(stage: &SceneFrame, painter: &Painter, length: &str, palette: &Palette) {
    let SceneFrame { unit, floor, wall, rect, body, .. } = *stage;
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
    for mass in 0..stage.masses {
        let x = stage.rest(mass);
        let rest = Stroke::new(1.0, palette.weak.gamma_multiply(0.4));
        painter.extend(Shape::dashed_line(&[pos2(x, floor - body.y - 8.0 * unit), pos2(x, floor)], rest, 3.0, 4.0));
    }
    if stage.masses == 1 { ruler(stage, painter, length, palette) } else { bar(stage, painter, length, palette) }
}

fn ruler(stage: &SceneFrame, painter: &Painter, length: &str, palette: &Palette) {
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

fn bar(stage: &SceneFrame, painter: &Painter, length: &str, palette: &Palette) {
    for mass in 0..stage.masses {
        mark_at(stage, painter, stage.rest(mass), palette.weak);
        // The symbol of a displacement has the number of its mass.
        let number = Channel::displacement(mass).symbol().trim_start_matches('x');
        label(stage, painter, stage.rest(mass), &format!("m{}", if mass == 0 { "₁" } else { number }), palette);
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

fn mark_at(stage: &SceneFrame, painter: &Painter, x: f32, color: Color32) {
    let stroke = Stroke::new(1.3 * stage.unit, color);
    painter.line_segment([pos2(x, stage.floor), pos2(x, stage.floor + 5.0 * stage.unit)], stroke);
}

fn label(stage: &SceneFrame, painter: &Painter, x: f32, text: &str, palette: &Palette) {
    let mut font = stage.font();
    font.size = (0.92 * font.size).max(10.0);
    let at = pos2(x, stage.floor + 4.0 * stage.unit);
    painter.text(at + vec2(0.0, -1.0), Align2::CENTER_TOP, text, font, palette.weak);
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Link {
    Linear,
    Hardening,
    /// A spring and a damper, parallel to a spring in series with a slider, which has slipped by this much \[m\].
    Slipping(f64),
}

#[derive(Clone, Copy)]
pub(super) struct Ink {
    pub(super) line: Color32,
    pub(super) back: Color32,
    pub(super) fill: Color32,
}

pub(super) fn link(stage: &SceneFrame, painter: &Painter, kind: Link, start: f32, body: Rect, stretch: f64, ink: Ink) {
    let end = body.left();
    let row = |share: f32| body.top() + share * body.height();
    let radius = body.height() * if matches!(kind, Link::Slipping(_)) { 0.125 } else { 0.2 };
    let coils = (stage.gap / (1.6 * radius)).round().clamp(4.0, 45.0) as usize;
    let rows = match kind {
        Link::Slipping(_) => [row(0.16), row(0.83)],
        Link::Linear | Link::Hardening => [row(0.27), row(0.76)],
    };
    let widens = kind == Link::Hardening;
    helix(stage, painter, Helix { from: start, to: end, y: rows[0], radius, coils, widens }, ink);
    damper(stage, painter, start, pos2(end, rows[1]), 0.75 * radius, stretch, ink);
    if let Link::Slipping(slip) = kind {
        let (left, right) = stage.cylinder(start);
        let width = (0.05 * stage.gap).max(4.0);
        let way = (0.5 * (right - left - width)).max(0.0);
        let middle = 0.5 * (left + right) + stage.length(slip).clamp(-way, way);
        let slider = Rect::from_center_size(pos2(middle, row(0.5)), vec2(width, 1.5 * radius));
        friction(stage, painter, start, slider, ink);
        let beside = Helix {
            from: slider.right(),
            to: end,
            y: row(0.5),
            radius: 0.8 * radius,
            coils: (3 * coils).div_ceil(4),
            widens: false,
        };
        helix(stage, painter, beside, ink);
    }
}

#[derive(Clone, Copy)]
struct Helix {
    from: f32,
    to: f32,
    y: f32,
    radius: f32,
    coils: usize,
    widens: bool,
}

fn helix(stage: &SceneFrame, painter: &Painter, helix: Helix, ink: Ink) {
    const POINTS: usize = 10;
    let Helix { from, to, y, radius, coils, widens } = helix;
    let stroke = Stroke::new(1.4 * stage.unit, ink.line);
    let lead = (0.07 * (to - from)).clamp(2.0, 14.0 * stage.unit);
    let (first, length) = (from + lead, to - from - 2.0 * lead);
    let tilt = (0.45 * radius).min(0.8 * length / coils as f32);
    let at = |point: usize| -> Pos2 {
        let (sin, cos) = (TAU * point as f32 / POINTS as f32).sin_cos();
        let share = point as f32 / (POINTS * coils) as f32;
        // The coils of a stiffening spring close one after the other, the narrow ones at the wall first.
        let (along, wide) = if widens { (share.powf(1.6), 0.45 + 0.75 * share) } else { (share, 1.0) };
        pos2(first + along * length + tilt * wide * (cos - 1.0), y - wide * radius * sin)
    };
    let coil = (0..=POINTS * coils).map(at);
    painter.line(std::iter::once(pos2(from, y)).chain(coil).chain([pos2(to, y)]).collect(), stroke);
}

fn damper(stage: &SceneFrame, painter: &Painter, start: f32, end: Pos2, half: f32, stretch: f64, ink: Ink) {
    let stroke = Stroke::new(1.6 * stage.unit, ink.line);
    let (left, right) = stage.cylinder(start);
    let middle = 0.5 * (left + right);
    let piston = (middle + stage.length(stretch)).clamp(middle - stage.travel, middle + stage.travel);
    let y = end.y;
    let inside = Rect::from_x_y_ranges(left..=right, (y - half)..=(y + half));
    painter.rect_filled(inside, 0.0, ink.fill);
    painter.line_segment([pos2(start, y), pos2(left, y)], stroke);
    let open = vec![inside.right_top(), inside.left_top(), inside.left_bottom(), inside.right_bottom()];
    painter.add(Shape::line(open, stroke));
    painter.line_segment([pos2(piston, y), end], stroke);
    let head = Rect::from_center_size(pos2(piston, y), vec2(3.5 * stage.unit, 2.0 * half - 2.0 * stage.unit));
    painter.rect_filled(head, 1.0, ink.line);
}

fn friction(stage: &SceneFrame, painter: &Painter, start: f32, slider: Rect, ink: Ink) {
    let stroke = Stroke::new(1.6 * stage.unit, ink.line);
    let (left, right) = stage.cylinder(start);
    painter.line_segment([pos2(start, slider.center().y), pos2(left, slider.center().y)], stroke);
    let gap = 1.2 * stage.unit;
    painter.line_segment([pos2(left, slider.top() - gap), pos2(left, slider.bottom() + gap)], stroke);
    for y in [slider.top() - gap, slider.bottom() + gap] {
        painter.line_segment([pos2(left, y), pos2(right, y)], Stroke::new(stage.unit, ink.line));
    }
    painter.rect(slider, 1.5, ink.back, stroke, StrokeKind::Inside);
}

pub(super) fn arrow(stage: &SceneFrame, painter: &Painter, x: f32, share: f64, color: Color32) {
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
