//! A frame with two scales, each linear or logarithmic, for one quantity over another.

use egui::epaint::TextShape;
use egui::{Align2, FontId, Painter, Pos2, Rect, Shape, Stroke, TextStyle, Ui, Vec2, pos2, vec2};

use super::medium::Medium;
use super::ticks::{log_tick, log_ticks, tick, ticks};
use crate::theme::Palette;

/// Room for the numbers and the name of the vertical axis at the left, and of the horizontal one below \[points\].
const LEFT: f32 = 58.0;
const BELOW: f32 = 34.0;
/// Room below a frame above another one \[points\].
const ABOVE: f32 = 6.0;
/// Room at the right and above, for half a number \[points\].
const MARGIN: Vec2 = vec2(12.0, 7.0);

/// The length of a tick \[points\].
const TICK: f32 = 3.0;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Scale {
    /// The ends; logarithms to the base of ten where the scale is logarithmic.
    ends: (f64, f64),
    is_logarithmic: bool,
}

impl Scale {
    /// A scale between two values; both must be positive for a logarithmic one.
    pub(crate) fn new(from: f64, to: f64, is_logarithmic: bool) -> Self {
        let ends = if is_logarithmic { (from.log10(), to.log10()) } else { (from, to) };
        Self { ends, is_logarithmic }
    }

    /// The scale of `count` cells in equal steps. `from` and `to` are the middles of the first and last; the scale
    /// reaches half a step beyond them.
    pub(crate) fn of_cells(from: f64, to: f64, count: usize, is_logarithmic: bool) -> Self {
        let Self { ends: (from, to), .. } = Self::new(from, to, is_logarithmic);
        let steps = count.saturating_sub(1).max(1) as f64;
        let step = if from == to { 1.0 } else { (to - from) / steps };
        let half = if count > 1 { 0.5 * step } else { 0.5 };
        Self { ends: (from - half, to + half), is_logarithmic }
    }

    /// The share of the scale at which a value lies, 0 and 1 at its ends; NaN where a logarithmic scale has no such value.
    pub(crate) fn share(&self, value: f64) -> f64 {
        let (from, to) = self.ends;
        ((if self.is_logarithmic { value.log10() } else { value }) - from) / (to - from)
    }

    pub(crate) fn ticks(&self, length: f32, apart: f32) -> Vec<(f64, String)> {
        let (from, to) = self.ends;
        let bounds = (from.min(to), from.max(to));
        let marks = if self.is_logarithmic {
            log_ticks(bounds, length, apart).into_iter().map(|mark| (mark.value, log_tick(mark))).collect::<Vec<_>>()
        } else {
            ticks(bounds, length / apart)
                .into_iter()
                .map(|mark| (mark.value, tick(mark.value, mark.step_size)))
                .collect()
        };
        marks.into_iter().map(|(value, text)| ((value - from) / (to - from), text)).collect()
    }
}

pub(crate) struct Graph {
    pub(crate) rect: Rect,
    pub(crate) x: Scale,
    pub(crate) y: Scale,
    has_x: bool,
}

impl Graph {
    pub(crate) fn new(room: Rect, x: Scale, y: Scale) -> Self {
        let min = pos2(room.left() + LEFT, room.top() + MARGIN.y);
        let max = pos2(room.right() - MARGIN.x, room.bottom() - BELOW).max(min + Vec2::splat(1.0));
        Self { rect: Rect::from_min_max(min, max), x, y, has_x: true }
    }

    /// The frame above another one with the same horizontal axis, which has the numbers.
    pub(crate) fn above(room: Rect, x: Scale, y: Scale) -> Self {
        let below = room.with_max_y(room.bottom() + BELOW - ABOVE);
        Self { has_x: false, ..Self::new(below, x, y) }
    }

    pub(crate) fn at(&self, [x, y]: [f64; 2]) -> Pos2 {
        self.at_shares([self.x.share(x), self.y.share(y)])
    }

    pub(crate) fn at_shares(&self, [x, y]: [f64; 2]) -> Pos2 {
        let Self { rect, .. } = self;
        pos2(rect.left() + x as f32 * rect.width(), rect.bottom() - y as f32 * rect.height())
    }

    pub(crate) fn shares(&self, at: Pos2) -> [f64; 2] {
        let Self { rect, .. } = self;
        let (x, y) = ((at.x - rect.left()) / rect.width(), (rect.bottom() - at.y) / rect.height());
        [f64::from(x), f64::from(y)]
    }

    pub(crate) fn axes_ui(&self, ui: &Ui, [x_name, y_name]: [&str; 2], palette: &Palette, has_lines: bool) {
        let Self { rect, x, y, has_x } = self;
        let painter = ui.painter();
        let [across, up] = Medium::of(ui.ctx()).between_ticks();
        let line = Stroke::new(1.0, palette.grid);
        let faint = Stroke::new(0.5, palette.grid.gamma_multiply(0.5));
        let font = TextStyle::Small.resolve(ui.style());
        for (share, text) in x.ticks(rect.width(), across) {
            let at = self.at_shares([share, 0.0]);
            if has_lines {
                painter.line_segment([at, pos2(at.x, rect.top())], faint);
            }
            painter.line_segment([at, at + vec2(0.0, TICK)], line);
            if *has_x {
                painter.text(at + vec2(0.0, TICK + 1.0), Align2::CENTER_TOP, text, font.clone(), palette.weak);
            }
        }
        for (share, text) in y.ticks(rect.height(), up) {
            let at = self.at_shares([0.0, share]);
            if has_lines {
                painter.line_segment([at, pos2(rect.right(), at.y)], faint);
            }
            painter.line_segment([at, at - vec2(TICK, 0.0)], line);
            painter.text(at - vec2(TICK + 2.0, 0.0), Align2::RIGHT_CENTER, text, font.clone(), palette.weak);
        }
        painter.add(Shape::line(vec![rect.left_top(), rect.left_bottom(), rect.right_bottom()], line));
        let below = pos2(rect.center().x, rect.bottom() + BELOW);
        if *has_x {
            painter.text(below, Align2::CENTER_BOTTOM, x_name, font.clone(), palette.text);
        }
        upright(painter, pos2(rect.left() - LEFT, rect.center().y), y_name, font, palette);
    }
}

fn upright(painter: &Painter, at: Pos2, text: &str, font: FontId, palette: &Palette) {
    let galley = painter.layout_no_wrap(text.to_owned(), font, palette.text);
    let start = pos2(at.x, at.y + 0.5 * galley.size().x);
    painter.add(TextShape::new(start, galley, palette.text).with_angle(-std::f32::consts::FRAC_PI_2));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_fill_the_scale() {
        for is_logarithmic in [false, true] {
            let scale = Scale::of_cells(1.0, 16.0, 4, is_logarithmic);
            assert!((scale.share(1.0) - 0.125).abs() < 1e-12 && (scale.share(16.0) - 0.875).abs() < 1e-12);
        }
        assert!((Scale::of_cells(5.0, 5.0, 1, false).share(5.0) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn positions_and_shares_are_inverse() {
        let room = Rect::from_min_size(pos2(10.0, 20.0), vec2(400.0, 300.0));
        let graph = Graph::new(room, Scale::new(30.0, 2.0, false), Scale::new(0.01, 100.0, true));
        let [x, y] = graph.shares(graph.at([9.0, 1.0]));
        assert!((x - 0.75).abs() < 1e-4 && (y - 0.5).abs() < 1e-4);
        assert!(room.contains_rect(graph.rect));
        let texts: Vec<String> = graph.y.ticks(200.0, 34.0).into_iter().map(|(_, text)| text).collect();
        assert!(texts.contains(&"0.01".to_owned()) && texts.contains(&"100".to_owned()), "{texts:?}");
    }
}
