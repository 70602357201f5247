//! The bad parts of a record as thin strips at the foot of a plot, and the jumps of filters as small triangles there.

use egui::{Color32, Rect, Shape, Stroke, Ui, pos2};
use egui_plot::PlotTransform;

use super::decoration::Paint;
use crate::session::Session;
use crate::theme::Palette;
use crate::visibility::Visibility;

const HEIGHT: f32 = 4.0;

const OPACITY: f32 = 0.5;

/// Half the width of the triangle of a jump [points].
const JUMP: f32 = 4.5;

pub(super) struct Strips {
    /// The height of each strip in numbers of strips, its times \[s\] and its colour.
    strips: Vec<(f32, (f64, f64), Color32)>,
    /// The time of each jump \[s\] and its colour.
    jumps: Vec<(f64, Color32)>,
}

impl Strips {
    pub(super) fn of(session: &Session, visible: &Visibility, palette: &Palette) -> Self {
        let (mut strips, mut jumps) = (Vec::new(), Vec::new());
        let (run, record) = (session.run(), session.run().record());
        let shown = run.estimates().iter().enumerate().filter(|(_, estimates)| visible.filter(estimates.id()));
        for (_, estimates) in shown.clone() {
            let color = palette.shade(estimates.color());
            jumps.extend(estimates.jumps().map(|sample| (record.time_of(sample), color)));
        }
        for (row, (place, estimates)) in shown.enumerate().filter(|_| visible.verdicts) {
            let color = palette.shade(estimates.color()).gamma_multiply(OPACITY);
            let bad_parts = session.diagnosis(place).map_or(&[][..], |diagnosis| &diagnosis.bad_parts);
            strips.extend(
                bad_parts.iter().map(|part| (row as f32, (record.time(part.start), record.time(part.end)), color)),
            );
        }
        Self { strips, jumps }
    }
}

impl Paint for Strips {
    fn shapes(&self, _: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        let frame = transform.frame();
        for (row, (from, to), color) in &self.strips {
            let [left, right] = [from, to].map(|time| transform.position_from_point_x(*time));
            let bottom = frame.bottom() - row * HEIGHT;
            let strip = Rect::from_min_max(pos2(left, bottom - HEIGHT), pos2(right, bottom)).intersect(*frame);
            if strip.is_positive() {
                shapes.push(Shape::rect_filled(strip, 0.0, *color));
            }
        }
        for (time, color) in &self.jumps {
            let x = transform.position_from_point_x(*time);
            if frame.x_range().contains(x) {
                let [left, right, top] = [(-1.0, 0.0), (1.0, 0.0), (0.0, -1.8)]
                    .map(|(across, up)| pos2(x + across * JUMP, frame.bottom() + up * JUMP));
                shapes.push(Shape::convex_polygon(vec![left, top, right], *color, Stroke::NONE));
            }
        }
    }
}
