//! The lines under the panels that say what their marks mean, and scores in words.

use std::sync::Arc;

use egui::{Color32, Galley, Pos2, Rect, Stroke, TextStyle, Ui, Vec2, vec2};
use kalmanscope_core::diagnosis::CAUSES;
use kalmanscope_core::{Measure, Scenario, ValueKind, VerdictKind};

use super::marks;
use super::picture::Panel;
use super::scale::End;
use crate::text::{significant, unit_in};
use crate::theme::Palette;

/// The height of a line \[points\].
const LINE: f32 = 16.0;

/// The size of a sample, the space after it, and that after an entry \[points\].
const SAMPLE: Vec2 = vec2(16.0, 9.0);
const SPACE: f32 = 4.0;
const GAP: f32 = 14.0;

#[derive(Clone, Copy)]
enum Mark {
    Line,
    Dashes,
    Path,
    Hatching,
    Grey,
    Dot,
}

struct Entry {
    mark: Mark,
    text: Arc<Galley>,
    at: Vec2,
}

pub(super) struct Legend {
    entries: Vec<Entry>,
    pub(super) height: f32,
}

impl Legend {
    pub(super) fn new(
        ui: &Ui,
        panels: &[Panel],
        (has_truth, has_path, measure): (bool, bool, Measure),
        width: f32,
        palette: &Palette,
    ) -> Self {
        let any = |end: End| panels.iter().any(|panel| panel.has(end));
        let has_contour = panels.iter().any(|panel| !panel.contour.is_empty());
        let is_never = measure.info().kind == ValueKind::Time;
        let all = [
            (true, Mark::Dot, "setting on screen"),
            (has_contour, Mark::Line, "consistent: mean NIS in its 99 % interval"),
            (has_truth, Mark::Dashes, "truth"),
            (has_path, Mark::Path, "path of Tune for me"),
            (any(End::Lost), Mark::Hatching, "lost the truth"),
            (any(End::Stopped), Mark::Grey, if is_never { "stopped, or never settled" } else { "stopped" }),
            (is_never && !any(End::Stopped), Mark::Grey, "never settled"),
        ];
        let font = TextStyle::Small.resolve(ui.style());
        let mut at = Vec2::ZERO;
        let mut entries = Vec::new();
        for (_, mark, text) in all.into_iter().filter(|(is_there, ..)| *is_there) {
            let text = ui.painter().layout_no_wrap(text.to_owned(), font.clone(), palette.weak);
            let end = SAMPLE.x + SPACE + text.size().x;
            if at.x > 0.0 && at.x + end > width {
                at = vec2(0.0, at.y + LINE);
            }
            entries.push(Entry { mark, text, at });
            at.x += end + GAP;
        }
        Self { entries, height: at.y + LINE }
    }

    pub(super) fn ui(&self, ui: &Ui, corner: Pos2, palette: &Palette) {
        let painter = ui.painter();
        for Entry { mark, text, at } in &self.entries {
            let left = corner + *at + vec2(0.0, 0.5 * LINE);
            mark.paint(painter, Rect::from_center_size(left + vec2(0.5 * SAMPLE.x, 0.0), SAMPLE), palette);
            let start = left + vec2(SAMPLE.x + SPACE, -0.5 * text.size().y);
            painter.galley(start, Arc::clone(text), palette.weak);
        }
    }
}

impl Mark {
    fn paint(self, painter: &egui::Painter, rect: Rect, palette: &Palette) {
        let line = Stroke::new(1.4, palette.text);
        let (left, right) = (rect.left_center(), rect.right_center());
        match self {
            Self::Line => {
                painter.line_segment([left, right], line);
                for x in [4.0, 12.0] {
                    painter.line_segment([left + vec2(x, 0.0), left + vec2(x, 4.0)], Stroke::new(1.0, palette.text));
                }
            }
            Self::Dashes => {
                painter.line_segment([left, left + vec2(6.0, 0.0)], line);
                painter.line_segment([right - vec2(6.0, 0.0), right], line);
            }
            Self::Hatching => {
                for i in 0..3 {
                    let from = rect.left_bottom() + vec2(5.0 * i as f32 - 1.0, 0.0);
                    painter.line_segment(
                        [from, from + vec2(rect.height(), -rect.height())],
                        Stroke::new(1.0, palette.text),
                    );
                }
            }
            Self::Path => marks::sample(painter, rect),
            Self::Grey => _ = painter.rect_filled(rect, 0.0, palette.grid),
            Self::Dot => {
                painter.circle(rect.center(), 4.0, palette.warning, Stroke::new(1.0, Color32::WHITE));
                painter.circle_stroke(rect.center(), 5.0, Stroke::new(0.8, Color32::BLACK));
            }
        }
    }
}

pub(super) fn score_text(measure: Measure, value: f64, scenario: &Scenario) -> String {
    match measure.info().kind {
        ValueKind::Flag if !value.is_nan() => if value == 0.0 { "no" } else { "yes" }.to_owned(),
        ValueKind::Verdict => {
            let kind = (value >= 0.0).then(|| VerdictKind::ALL.get(value as usize)).flatten();
            kind.map_or("not known", |kind| kind.name()).to_owned()
        }
        ValueKind::Cause => {
            let cause = (value >= 0.0).then(|| CAUSES.get(value as usize)).flatten();
            cause.map_or("none", |cause| cause.name).to_owned()
        }
        ValueKind::Time if value == f64::INFINITY => "never".to_owned(),
        _ => format!("{} {}", significant(value, 4), unit_in(scenario, measure.unit())).trim_end().to_owned(),
    }
}
