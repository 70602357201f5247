//! The link of a mass: spring, damper and, for a hysteretic spring, a slider.

use std::f32::consts::{FRAC_PI_2, PI};

use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, pos2, vec2};

use super::stage::Stage;
use crate::plot::strokes::Strokes;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Link {
    Linear,
    Hardening,
    /// A spring and a damper, parallel to a second spring in series with a slider, which has slipped by this much
    /// \[m\].
    Slipping(f64),
}

#[derive(Clone, Copy)]
pub(super) struct Ink {
    pub(super) line: Color32,
    pub(super) back: Color32,
    pub(super) fill: Color32,
}

/// Draws the link from `start` to the mass `body`, stretched by `stretch` \[m\].
pub(super) fn link(stage: &Stage, painter: &Painter, kind: Link, start: f32, body: Rect, stretch: f64, ink: Ink) {
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

fn helix(stage: &Stage, painter: &Painter, helix: Helix, ink: Ink) {
    let Helix { from, to, y, radius, coils, widens } = helix;
    // Steps of half a turn: an even number has a point on the spring's axis, its beginning and end.
    let steps = if radius < 7.0 { 4 } else { 6 };
    let width = 1.3 * stage.unit;
    let lead = (0.07 * (to - from)).clamp(2.0, 14.0 * stage.unit);
    let (first, length) = (from + lead, to - from - 2.0 * lead);
    let tilt = (0.45 * radius).min(0.8 * length / coils as f32);
    let at = |angle: f32, (sin, cos): (f32, f32)| -> Pos2 {
        let share = angle / (2.0 * PI * coils as f32);
        // The coils of a stiffening spring close one after the other, the narrow ones at the wall first.
        let (along, wide) = if widens { (share.powf(1.6), 0.45 + 0.75 * share) } else { (share, 1.0) };
        pos2(first + along * length + tilt * wide * (cos - 1.0), y - wide * radius * sin)
    };
    // Half a turn from an angle that is the same for every turn.
    let half = |begin: f32| {
        let angles = (0..=steps).map(|i| begin + PI * i as f32 / steps as f32);
        let arcs: Vec<_> = angles.map(|angle| (angle, angle.sin_cos())).collect();
        move |turn: usize| -> Vec<Pos2> {
            let before = 2.0 * PI * turn as f32;
            let within = 0.0..=2.0 * PI * coils as f32 + 1e-3;
            let turned = arcs.iter().map(|(angle, arc)| (before + angle, *arc));
            turned.filter(|(angle, _)| within.contains(angle)).map(|(angle, arc)| at(angle, arc)).collect()
        }
    };
    let (behind, before) = (half(-FRAC_PI_2), half(FRAC_PI_2));
    let back = Stroke::new(width, ink.back);
    let front = Stroke::new(1.15 * width, ink.line);
    let mut strokes = Strokes::new(painter.ctx());
    for turn in 0..=coils {
        strokes.line(&behind(turn), back);
    }
    for turn in 0..coils {
        strokes.line(&before(turn), front);
    }
    strokes.line(&[pos2(from, y), pos2(first, y)], front);
    strokes.line(&[pos2(first + length, y), pos2(to, y)], front);
    painter.add(strokes.into_shape());
}

fn damper(stage: &Stage, painter: &Painter, start: f32, end: Pos2, half: f32, stretch: f64, ink: Ink) {
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

fn friction(stage: &Stage, painter: &Painter, start: f32, slider: Rect, ink: Ink) {
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
