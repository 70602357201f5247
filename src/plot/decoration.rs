//! Missing readings, bad parts and jumps, painted under a chart's curves.

use egui::{Rect, Shape, Stroke, pos2};
use egui_plot::PlotTransform;

use super::time_axis::PlotInput;
use crate::theme::Palette;
use crate::trouble::Gap;

/// The height of a mark, and its width at least \[points\].
const MARK: (f32, f32) = (5.0, 2.0);

const GROUND: f32 = 0.45;

pub(super) fn gap_shapes(gaps: &[Gap], transform: &PlotTransform, palette: &Palette, shapes: &mut Vec<Shape>) {
    let frame = *transform.frame();
    for gap in gaps {
        let [left, right] = [gap.times.0, gap.times.1].map(|time| transform.position_from_point_x(time));
        // One missing reading in a long record is narrower than a pixel, and must be seen.
        let whole = Rect::from_x_y_ranges(left..=right.max(left + MARK.1), frame.y_range()).intersect(frame);
        if whole.is_positive() {
            shapes.push(Shape::rect_filled(whole, 0.0, palette.faint.gamma_multiply(GROUND)));
            shapes.push(Shape::rect_filled(whole.with_min_y(frame.bottom() - MARK.0), 0.0, palette.weak));
        }
    }
}

const HEIGHT: f32 = 4.0;

const OPACITY: f32 = 0.5;

const JUMP: f32 = 4.5;

pub(super) fn strip_shapes(input: &PlotInput<'_>, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
    let PlotInput { session, visible, palette, .. } = *input;
    let (record, frame) = (session.run().record(), *transform.frame());
    let all = session.run().estimates().iter().enumerate();
    let mut jumps = Vec::new();
    for (row, (place, estimates)) in all.filter(|(_, estimates)| visible.filter(estimates.id())).enumerate() {
        let color = palette.shade(estimates.color());
        for sample in estimates.jumps() {
            let x = transform.position_from_point_x(record.time_of(sample));
            if frame.x_range().contains(x) {
                let corners = [(-1.0, 0.0), (0.0, -1.8), (1.0, 0.0)];
                let corners = corners.map(|(across, up)| pos2(x + across * JUMP, frame.bottom() + up * JUMP));
                jumps.push(Shape::convex_polygon(corners.to_vec(), color, Stroke::NONE));
            }
        }
        let diagnosis = session.diagnosis(place).filter(|_| visible.verdicts);
        for part in diagnosis.map_or(&[][..], |diagnosis| &diagnosis.bad_parts) {
            let [left, right] =
                [part.start, part.end].map(|sample| transform.position_from_point_x(record.time(sample)));
            let bottom = frame.bottom() - row as f32 * HEIGHT;
            let strip = Rect::from_min_max(pos2(left, bottom - HEIGHT), pos2(right, bottom)).intersect(frame);
            if strip.is_positive() {
                shapes.push(Shape::rect_filled(strip, 0.0, color.gamma_multiply(OPACITY)));
            }
        }
    }
    shapes.extend(jumps);
}
