//! Pictures of plants that are no masses: a pendulum and a circuit.

use egui::{Align2, Rect, Shape, Stroke, StrokeKind, Vec2, pos2, vec2};
use kalmanscope_core::{Estimates, PlantKind, Scenario};

use super::parts::MassBelief;
use super::scene::Scene;
use super::stage::rounded;
use crate::text::unit_in;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PlantFigure {
    Masses,
    Pendulum,
    Circuit,
    /// The equation alone: no picture fits.
    Nothing,
}

/// The reach of a pendulum that needs room above its pivot \[rad\].
const WIDE: f64 = 1.2;

impl PlantFigure {
    pub(super) fn of(scenario: &Scenario, masses: usize) -> Self {
        let own = scenario.plant.kind.own_equation();
        let stated = own.and_then(|own| own.settings().parameter("x")).map(|x| x.unit.as_str());
        match stated.unwrap_or(unit_in(scenario, "m")) {
            _ if masses > 1 => Self::Masses,
            "rad" => Self::Pendulum,
            "V" | "A" | "C" => Self::Circuit,
            "m" if own.is_some() && turns(&scenario.plant.kind) => Self::Pendulum,
            "m" => Self::Masses,
            _ => Self::Nothing,
        }
    }

    pub(super) fn draw<'a>(self, scene: &Scene<'a>, last: usize) -> Vec<(Rect, u32, &'a str)> {
        let beliefs = scene.beliefs();
        let places = match self {
            Self::Masses => return scene.slices(),
            Self::Pendulum => pendulum(scene, &beliefs, scene.reach(last)),
            Self::Circuit => circuit(scene, &beliefs, scene.reach(last)),
            Self::Nothing => Vec::new(),
        };
        let named = places.into_iter().zip(beliefs);
        named.map(|(place, (_, estimates))| (place, estimates.id(), estimates.name())).collect()
    }
}

/// Whether the motion is the same after a whole turn of the state, but not after a part of one.
fn turns(plant: &PlantKind) -> bool {
    let size = plant.channels().len();
    let rate = |x: f64| {
        let (mut state, mut rate) = (vec![1.0; size], vec![0.0; size]);
        state[0] = x;
        plant.motion_rate(&state, 0.0, &mut rate);
        rate[1]
    };
    (rate(0.3 + std::f64::consts::TAU) - rate(0.3)).abs() < 1e-9 && (rate(1.3) - rate(0.3)).abs() > 1e-9
}

type Beliefs<'a> = [(MassBelief, &'a Estimates)];

fn pendulum(scene: &Scene<'_>, beliefs: &Beliefs<'_>, reach: f64) -> Vec<Rect> {
    let (rect, unit, painter, palette) = (scene.stage.rect, scene.stage.unit, scene.painter, scene.context.palette);
    let high = rect.height();
    let (hangs, length) = if reach > WIDE { (0.5, 0.38 * high) } else { (0.1, 0.74 * high) };
    let pivot = pos2(rect.center().x, rect.top() + hangs * high);
    let at = |angle: f64, length: f32| pivot + length * vec2((angle as f32).sin(), (angle as f32).cos());
    let weak = Stroke::new(1.3 * unit, palette.weak);
    painter.line_segment([pivot - vec2(22.0 * unit, 0.0), pivot + vec2(22.0 * unit, 0.0)], weak);
    let rest = Stroke::new(1.0, palette.weak.gamma_multiply(0.4));
    painter.extend(Shape::dashed_line(&[pivot, at(0.0, 1.15 * length)], rest, 3.0, 4.0));
    let radius = (0.09 * high).clamp(5.0, 16.0);
    if let Some(angle) = scene.truth_now() {
        let bob = at(angle, length);
        painter.line_segment([pivot, bob], Stroke::new(2.2 * unit, palette.truth));
        let fill = palette.ground.lerp_to_gamma(palette.truth, 0.2);
        painter.circle(bob, radius, fill, Stroke::new(1.8 * unit, palette.truth));
    }
    let ghost = |(place, (belief, _)): (usize, &(MassBelief, &Estimates))| {
        let (bob, around) = (at(belief.mean, length), length - radius * (1.6 + 0.7 * place as f32));
        painter.line_segment([pivot, bob], Stroke::new(1.2 * unit, belief.color));
        painter.circle(
            bob,
            radius + 1.5 * unit,
            belief.color.gamma_multiply(0.1),
            Stroke::new(1.7 * unit, belief.color),
        );
        if scene.context.visible.bands && belief.std.is_finite() {
            let half = (2.0 * belief.std).min(std::f64::consts::PI);
            let arc = (0..=32).map(|i| at(belief.mean + half * (f64::from(i) / 16.0 - 1.0), around)).collect();
            painter.line(arc, Stroke::new(4.0 * unit, belief.color.gamma_multiply(0.5)));
        }
        Rect::from_center_size(bob, Vec2::splat(2.0 * radius + 3.0))
    };
    beliefs.iter().enumerate().map(ghost).collect()
}

fn circuit(scene: &Scene<'_>, beliefs: &Beliefs<'_>, reach: f64) -> Vec<Rect> {
    let (rect, unit, painter, palette) = (scene.stage.rect, scene.stage.unit, scene.painter, scene.context.palette);
    let high = rect.height();
    let half = vec2((0.9 * high).min(0.2 * rect.width()), 0.3 * high);
    let wires = Rect::from_center_size(rect.center(), 2.0 * half);
    let (ink, y) = (Stroke::new(1.6 * unit, palette.truth), wires.center().y);
    let part = |x: f32, y: f32, size: Vec2| Rect::from_center_size(pos2(x, y), size);
    painter.rect_stroke(wires, 0.0, ink, StrokeKind::Middle);
    let size = vec2(0.6 * half.x, 0.14 * high);
    painter.rect(
        part(wires.center().x - 0.45 * half.x, wires.top(), size),
        0.0,
        palette.ground,
        ink,
        StrokeKind::Middle,
    );
    painter.rect_filled(part(wires.center().x + 0.45 * half.x, wires.top(), size), 0.0, palette.truth);
    let gap = part(wires.right(), y, vec2(0.5 * half.x, 0.12 * high));
    painter.rect_filled(gap, 0.0, palette.ground);
    painter.hline(gap.x_range(), gap.top(), ink);
    painter.hline(gap.x_range(), gap.bottom(), ink);
    painter.circle(pos2(wires.left(), y), 0.12 * high, palette.ground, ink);
    painter.text(pos2(wires.left(), y), Align2::CENTER_CENTER, "f", scene.stage.font(), palette.force);
    // The gauge has the height of the loop for the largest value, and a column for each filter.
    let scale = half.y / 2_f64.powf(rounded(reach.max(1e-9).log2())) as f32;
    let (left, width) = (wires.right() + 0.35 * half.x, 8.0 * unit);
    let place = |value: f64| y - (value as f32 * scale).clamp(-2.0 * half.y, 2.0 * half.y);
    let right = left + (1.5 * beliefs.len() as f32 + 2.0) * width;
    painter.line_segment([pos2(left, y), pos2(right, y)], Stroke::new(1.0, palette.weak));
    if let Some(value) = scene.truth_now() {
        let bar = Rect::from_two_pos(pos2(left, y), pos2(right, place(value)));
        painter.rect_filled(bar, 0.0, palette.truth.gamma_multiply(0.18));
        painter.line_segment([pos2(left, place(value)), pos2(right, place(value))], ink);
    }
    let column = |(number, (belief, _)): (usize, &(MassBelief, &Estimates))| {
        let x = left + (1.5 * number as f32 + 1.5) * width;
        let [low, high] = [-2.0, 2.0].map(|many| place(belief.mean + many * belief.std));
        let band = Rect::from_x_y_ranges((x - 0.5 * width)..=(x + 0.5 * width), high..=low);
        if scene.context.visible.bands && belief.std.is_finite() {
            painter.rect_filled(band, 1.5, belief.color.gamma_multiply(0.4));
        }
        let mean = place(belief.mean);
        painter
            .line_segment([pos2(band.left(), mean), pos2(band.right(), mean)], Stroke::new(2.0 * unit, belief.color));
        Rect::from_center_size(pos2(x, mean), Vec2::splat(1.5 * width))
    };
    beliefs.iter().enumerate().map(column).collect()
}
