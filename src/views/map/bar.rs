//! The bar of colours beside a panel, with its numbers.

use egui::{Align2, Rect, Stroke, StrokeKind, TextStyle, Ui, pos2, vec2};

use super::scale::Colors;
use crate::text::significant;
use crate::theme::Palette;

/// Room for a bar with its numbers, and for one with the names of kinds \[points\].
const NUMBERS: f32 = 46.0;
const NAMES: f32 = 104.0;

/// The width of the bar, and its distance from the panel \[points\].
const WIDTH: f32 = 11.0;
const APART: f32 = 6.0;

const STEPS: usize = 64;

pub(super) fn room(colors: &Colors) -> f32 {
    if matches!(colors, Colors::Kinds(names) if names.len() > 2) { NAMES } else { NUMBERS }
}

pub(super) fn bar_ui(ui: &Ui, frame: Rect, colors: &Colors, palette: &Palette) {
    if let Colors::Kinds(names) = colors {
        return kinds_ui(ui, frame, colors, names, palette);
    }
    let painter = ui.painter();
    let left = frame.right() + APART;
    let rect = Rect::from_min_max(pos2(left, frame.top()), pos2(left + WIDTH, frame.bottom()));
    let y = |share: f64| rect.bottom() - share as f32 * rect.height();
    for step in 0..STEPS {
        let [low, high] = [step, step + 1].map(|step| step as f64 / STEPS as f64);
        let part =
            Rect::from_min_max(pos2(rect.left(), y(high)), pos2(rect.right(), (y(low) + 0.5).min(rect.bottom())));
        painter.rect_filled(part, 0.0, colors.at(0.5 * (low + high), palette));
    }
    painter.rect_stroke(rect, 0.0, Stroke::new(0.7, palette.grid), StrokeKind::Middle);
    let font = TextStyle::Small.resolve(ui.style());
    for (share, text) in colors.ticks(rect.height()) {
        let at = pos2(rect.right(), y(share));
        painter.line_segment([at, at + vec2(3.0, 0.0)], Stroke::new(1.0, palette.grid));
        painter.text(at + vec2(5.0, 0.0), Align2::LEFT_CENTER, text, font.clone(), palette.weak);
    }
}

fn kinds_ui(ui: &Ui, frame: Rect, colors: &Colors, names: &[&str], palette: &Palette) {
    let painter = ui.painter();
    let font = TextStyle::Small.resolve(ui.style());
    let line = (frame.height() / names.len().max(1) as f32).min(font.size + 6.0);
    for (place, name) in names.iter().enumerate() {
        let at = pos2(frame.right() + APART, frame.top() + line * place as f32);
        let rect = Rect::from_min_size(at + vec2(0.0, 1.0), vec2(WIDTH, line - 2.0));
        painter.rect_filled(rect, 0.0, colors.kind(place));
        let at = rect.right_center() + vec2(4.0, 0.0);
        painter.text(at, Align2::LEFT_CENTER, *name, font.clone(), palette.weak);
    }
}

impl Colors {
    pub(super) fn ticks(&self, length: f32) -> Vec<(f64, String)> {
        match self {
            Self::Distance(most) => {
                let steps = [0.0, 2.6, 10.0, 100.0, 1e3, 1e4, 1e5].into_iter().filter(|step| *step <= *most);
                let both = steps.flat_map(|step| if step == 0.0 { vec![0.0] } else { vec![-step, step] });
                both.map(|value| (self.share(value), significant(value, 2))).collect()
            }
            other => other.scale().map_or(Vec::new(), |scale| scale.ticks(length, 30.0)),
        }
    }
}
