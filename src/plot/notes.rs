//! Words on a chart where something happens, such as a change of the truth.

use egui::{Align2, Color32, Rect, Shape, TextStyle, Ui, vec2};
use egui_plot::PlotTransform;

use crate::theme::Palette;

pub(crate) struct Note {
    pub(crate) time: f64,
    pub(crate) value: f64,
    pub(crate) words: String,
    pub(crate) color: Color32,
    pub(crate) leftwards: bool,
}

const DOT: f32 = 3.0;
const APART: f32 = 6.0;

const ENOUGH: [f32; 2] = [260.0, 90.0];

pub(super) fn note_shapes(notes: &[Note], ui: &Ui, transform: &PlotTransform, shapes: &mut Vec<Shape>) {
    let frame = *transform.frame();
    let ground = Palette::of(ui.ctx().theme()).ground.gamma_multiply(0.8);
    let mut taken: Vec<Rect> = Vec::new();
    for Note { time, value, words, color, leftwards } in notes {
        let at = transform.position_from_point(&egui_plot::PlotPoint::new(*time, *value));
        if !frame.contains(at) || frame.width() < ENOUGH[0] || frame.height() < ENOUGH[1] {
            continue;
        }
        let galley = ui.painter().layout_no_wrap(words.clone(), TextStyle::Small.resolve(ui.style()), *color);
        let mut sides =
            [(Align2::LEFT_BOTTOM, [1.0, -1.0]), (Align2::RIGHT_TOP, [-1.0, 1.0]), (Align2::LEFT_TOP, [1.0; 2])];
        sides[..2].rotate_left(usize::from(*leftwards));
        let rects = sides.map(|(align, [x, y])| align.anchor_size(at + APART * vec2(x, y), galley.size()));
        let is_free = |rect: &Rect| frame.contains_rect(*rect) && !taken.iter().any(|other| other.intersects(*rect));
        shapes.push(Shape::circle_filled(at, DOT, *color));
        if let Some(rect) = rects.into_iter().find(is_free) {
            shapes.push(Shape::rect_filled(rect.expand2(vec2(2.0, 0.0)), 2.0, ground));
            shapes.push(Shape::galley(rect.min, galley, *color));
            taken.push(rect);
        }
    }
}
