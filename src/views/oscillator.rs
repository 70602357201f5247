//! The moving mass, spring and damper: the truth solid, each filter's estimate a ghost with its ±2σ.

use egui::{
    Align2, Color32, FontId, Painter, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, Ui, Vec2, WidgetInfo, pos2, vec2,
};
use kalmanscope_core::Channel;

use super::{View, ViewContext};
use crate::command::Command;

/// The moving mass.
pub(super) struct Oscillator;

impl View for Oscillator {
    fn name(&self) -> &'static str {
        "Oscillator"
    }

    fn help(&self) -> [&'static str; 3] {
        [
            "The mass on its spring and damper, with the force as an arrow; each filter's estimate is an outline with its ±2σ.",
            "Where an outline leaves the mass, the filter is wrong about the displacement.",
            "Of a chain of masses the lowest is shown.",
        ]
    }

    fn ui(&self, ui: &mut Ui, context: &ViewContext<'_>, _: &mut Vec<Command>) -> Option<f64> {
        let available = ui.available_height();
        let height = available.min(0.3 * ui.available_width());
        if height > 40.0 {
            ui.add_space(0.5 * (available - height));
            oscillator_ui(ui, context, height);
        }
        None
    }
}

/// Draws the oscillator where playback stands, as wide as `ui` and `height` high \[points\].
fn oscillator_ui(ui: &mut Ui, context: &ViewContext<'_>, height: f32) {
    let ViewContext { session, palette, shown, .. } = *context;
    let size = vec2(ui.available_width().max(1.0), height);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let label = "The oscillator: spring, damper and mass, with each filter's estimate of the displacement";
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, label));
    if !ui.is_rect_visible(rect) || rect.width() < 60.0 {
        return;
    }
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 6.0, palette.plot);

    let record = session.run().record();
    let k = session.index();
    let truth = record.truth(Channel::Displacement);
    let stage = Stage::new(rect, truth.map_or(0.0, |x| reach(&x[..x.len().min(k + 1)])));
    stage.ground(&painter, palette.weak);

    for (place, estimates) in session.run().estimates().iter().enumerate() {
        let Some(at) = estimates.place(Channel::Displacement).filter(|_| shown.filter(place) && k < estimates.len())
        else {
            continue;
        };
        let (mean, std) = (estimates.mean(k)[at], estimates.std(k, at));
        let color = palette.filter(place);
        if shown.bands {
            stage.spread(&painter, mean, 2.0 * std, color.gamma_multiply(0.25));
        }
        stage.ghost(&painter, mean, place, color);
    }
    if let Some(truth) = truth.filter(|_| shown.truth).and_then(|x| x.get(k)) {
        stage.link(&painter, *truth, palette.truth);
        stage.mass(&painter, *truth, palette.truth, palette.plot);
        let force = record.force()[k];
        stage.force(&painter, *truth, force / force_scale(record.force()), palette.force);
    }
    let font = FontId::proportional(11.5);
    let corner = rect.right_top() + vec2(-10.0, 6.0);
    let equation = session.scenario().plant.kind.equation();
    painter.text(corner, Align2::RIGHT_TOP, equation, font, palette.weak);
}

/// The largest displacement so far, of what is kept.
fn reach(displacement: &[f64]) -> f64 {
    displacement.iter().fold(0.0, |reach: f64, x| reach.max(x.abs()))
}

/// A force that is drawn as a long arrow: the largest so far, seen over the first samples and so cheap.
fn force_scale(force: &[f64]) -> f64 {
    force.iter().take(2000).fold(1e-9, |scale: f64, f| scale.max(f.abs()))
}

/// Where things stand on screen.
struct Stage {
    rect: Rect,
    floor: f32,
    wall: f32,
    centre: f32,
    /// How far the mass goes to either side \[points\].
    travel: f32,
    /// Points per metre.
    scale: f32,
    mass: Vec2,
}

/// Room between the damper's piston and the ends of its cylinder, and between the cylinder and the mass \[points\].
const CLEARANCE: f32 = 6.0;

impl Stage {
    fn new(rect: Rect, reach: f64) -> Self {
        let height = rect.height();
        let mass = vec2((0.46 * height).min(0.16 * rect.width()), 0.46 * height);
        let wall = rect.left() + 0.03 * rect.width() + 8.0;
        let centre = rect.left() + 0.56 * rect.width();
        // The cylinder is as long as the piston's way there and back, and the mass never reaches it.
        let length = centre - 0.5 * mass.x - wall;
        let travel = ((0.95 * length - 3.0 * CLEARANCE) / 3.0).max(1.0);
        // Powers of √2, so that the scale does not creep while the motion grows.
        let reach = 2_f64.powf((reach.max(1e-6).log2() * 2.0).ceil() / 2.0);
        let floor = rect.bottom() - 0.16 * height;
        Self { rect, floor, wall, centre, travel, scale: travel / reach as f32, mass }
    }

    /// The damper's cylinder, from left to right.
    fn cylinder(&self) -> (f32, f32) {
        let start = self.wall + 0.05 * (self.centre - 0.5 * self.mass.x - self.wall);
        (start, start + 2.0 * (self.travel + CLEARANCE))
    }

    /// The mass at the displacement `x` \[m\], kept on the stage.
    fn body(&self, x: f64) -> Rect {
        let middle = (self.centre + x as f32 * self.scale).clamp(self.wall, self.rect.right());
        Rect::from_center_size(pos2(middle, self.floor - 0.5 * self.mass.y), self.mass)
    }

    fn ground(&self, painter: &Painter, color: Color32) {
        let stroke = Stroke::new(1.2, color);
        let top = self.floor - self.mass.y - 8.0;
        let right = self.rect.right() - 14.0;
        painter.line_segment([pos2(self.wall, self.floor), pos2(right, self.floor)], stroke);
        painter.line_segment([pos2(self.wall, self.floor), pos2(self.wall, top)], stroke);
        let hatch = Stroke::new(1.0, color.gamma_multiply(0.5));
        let mut x = self.wall;
        while x < right - 6.0 {
            painter.line_segment([pos2(x + 6.0, self.floor), pos2(x, self.floor + 6.0)], hatch);
            x += 9.0;
        }
        let mut y = top;
        while y < self.floor - 4.0 {
            painter.line_segment([pos2(self.wall, y), pos2(self.wall - 6.0, y + 6.0)], hatch);
            y += 9.0;
        }
        let zero = Stroke::new(1.0, color.gamma_multiply(0.35));
        painter.extend(Shape::dashed_line(&[pos2(self.centre, top), pos2(self.centre, self.floor)], zero, 3.0, 4.0));
    }

    /// Spring above, damper below, from the wall to the mass.
    fn link(&self, painter: &Painter, x: f64, color: Color32) {
        let stroke = Stroke::new(1.6, color);
        let body = self.body(x);
        let end = body.left();
        let spring = body.top() + 0.28 * body.height();
        painter.add(Shape::line(zigzag(self.wall, end, spring, 0.13 * body.height()), stroke));

        let damper = body.top() + 0.74 * body.height();
        let half = 0.12 * body.height();
        let (start, stop) = self.cylinder();
        let middle = 0.5 * (start + stop);
        let piston = (middle + x as f32 * self.scale).clamp(middle - self.travel, middle + self.travel);
        painter.line_segment([pos2(self.wall, damper), pos2(start, damper)], stroke);
        painter.add(Shape::line(
            vec![
                pos2(stop, damper - half),
                pos2(start, damper - half),
                pos2(start, damper + half),
                pos2(stop, damper + half),
            ],
            stroke,
        ));
        let head = [pos2(piston, damper - 0.8 * half), pos2(piston, damper + 0.8 * half)];
        painter.line_segment(head, Stroke::new(2.4, color));
        painter.line_segment([pos2(piston, damper), pos2(end, damper)], stroke);
    }

    fn mass(&self, painter: &Painter, x: f64, color: Color32, ink: Color32) {
        let body = self.body(x);
        painter.rect_filled(body, 4.0, color);
        painter.text(body.center(), Align2::CENTER_CENTER, "m", FontId::proportional(14.0), ink);
    }

    fn force(&self, painter: &Painter, x: f64, share: f64, color: Color32) {
        let length = (share.clamp(-1.0, 1.0) as f32) * 90.0;
        if length.abs() > 3.0 {
            let body = self.body(x);
            let start = pos2(body.center().x, body.top() - 9.0);
            painter.arrow(start, vec2(length, 0.0), Stroke::new(2.0, color));
        }
    }

    fn ghost(&self, painter: &Painter, mean: f64, place: usize, color: Color32) {
        let body = self.body(mean).expand(1.5 + 2.5 * place as f32);
        painter.rect_stroke(body, 5.0, Stroke::new(2.0, color), StrokeKind::Middle);
    }

    /// A bar under the mass as wide as the estimate is uncertain.
    fn spread(&self, painter: &Painter, mean: f64, half: f64, color: Color32) {
        let (low, high) = (self.body(mean - half), self.body(mean + half));
        painter.rect_filled(low.union(high), 5.0, color);
    }
}

fn zigzag(from: f32, to: f32, y: f32, amplitude: f32) -> Vec<Pos2> {
    const COILS: usize = 9;
    let lead = 0.08 * (to - from);
    let mut points = vec![pos2(from, y), pos2(from + lead, y)];
    let pitch = (to - from - 2.0 * lead) / (2 * COILS) as f32;
    points.extend((0..2 * COILS).map(|i| {
        let side = if i % 2 == 0 { -amplitude } else { amplitude };
        pos2(from + lead + (i as f32 + 0.5) * pitch, y + side)
    }));
    points.extend([pos2(to - lead, y), pos2(to, y)]);
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mass_stays_between_the_damper_and_the_end_of_the_stage() {
        for size in [vec2(930.0, 120.0), vec2(370.0, 116.0), vec2(1580.0, 120.0)] {
            let rect = Rect::from_min_size(Pos2::ZERO, size);
            for reach in [1e-3, 0.2, 0.2167, 7.0] {
                let stage = Stage::new(rect, reach);
                let (_, cylinder) = stage.cylinder();
                let (left, right) = (stage.body(-reach), stage.body(reach));
                assert!(left.left() >= cylinder, "{size} {reach}: {} is in the cylinder, {cylinder}", left.left());
                assert!(right.right() < rect.right());
                assert!(right.left() - left.left() > 0.12 * size.x, "the motion can hardly be seen");
            }
        }
    }
}
