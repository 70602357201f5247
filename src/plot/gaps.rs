//! Marks on the time axis where a sensor delivers nothing.

use egui::{Align2, Color32, Rect, Shape, TextStyle, Ui, pos2, vec2};
use egui_plot::PlotTransform;

use super::decoration::Paint;
use crate::gap::Gap;
use crate::theme::Palette;

/// The height of a mark, and its width at least \[points\].
const MARK: (f32, f32) = (5.0, 2.0);

const GROUND: f32 = 0.45;

/// The distance between a mark and its words, and of words from each other \[points\].
const APART: f32 = 5.0;

/// The least height of a plot with words \[points\].
const ENOUGH: f32 = 80.0;

pub(super) struct Gaps {
    gaps: Vec<Gap>,
    worded: bool,
    colors: [Color32; 3],
}

impl Gaps {
    pub(super) fn of(gaps: &[Gap], worded: bool, palette: &Palette) -> Self {
        let colors = [palette.faint.gamma_multiply(GROUND), palette.weak, palette.ground.gamma_multiply(0.8)];
        Self { gaps: gaps.to_vec(), worded, colors }
    }
}

impl Paint for Gaps {
    fn shapes(&self, ui: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
        let frame = *transform.frame();
        let [shade, color, behind] = self.colors;
        let mut written_to = f32::NEG_INFINITY;
        for gap in &self.gaps {
            let (from, to) = gap.times;
            let [left, right] = [from, to].map(|time| transform.position_from_point_x(time));
            let whole = Rect::from_x_y_ranges(left..=right.max(left + MARK.1), frame.y_range()).intersect(frame);
            if !whole.is_positive() {
                continue;
            }
            shapes.push(Shape::rect_filled(whole, 0.0, shade));
            shapes.push(Shape::rect_filled(whole.with_min_y(frame.bottom() - MARK.0), 0.0, color));
            if !self.worded || frame.height() < ENOUGH {
                continue;
            }
            let galley = ui.painter().layout_no_wrap(gap.words(), TextStyle::Small.resolve(ui.style()), color);
            // Above the tags of times.
            let middle = frame.bottom() - 1.6 * galley.size().y;
            let after = Align2::LEFT_CENTER.anchor_size(pos2(whole.right() + APART, middle), galley.size());
            let before = Align2::RIGHT_CENTER.anchor_size(pos2(whole.left() - APART, middle), galley.size());
            let is_free = |rect: &Rect| {
                rect.left() >= written_to && frame.x_range().contains(rect.left()) && rect.right() <= frame.right()
            };
            if let Some(rect) = [after, before].into_iter().find(is_free) {
                written_to = rect.right().max(whole.right()) + APART;
                shapes.push(Shape::rect_filled(rect.expand2(vec2(2.0, 0.0)), 2.0, behind));
                shapes.push(Shape::galley(rect.min, galley, color));
            }
        }
    }
}
