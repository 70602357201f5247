//! The lines under the panels that say what their marks mean, and scores in words.

use egui::{Color32, Rect, Stroke, TextStyle, Ui, pos2, vec2};
use kalmanscope_core::VerdictKind;
use kalmanscope_lab::Measure;

use super::cells::End;
use super::picture::Panel;
use crate::text::significant;
use crate::theme::Palette;

/// The height of a line \[points\].
pub(super) const LINE: f32 = 16.0;

/// The size of a sample, and the space after an entry \[points\].
const SAMPLE: egui::Vec2 = vec2(16.0, 9.0);
const GAP: f32 = 14.0;

/// The sample of an entry.
#[derive(Clone, Copy)]
enum Mark {
    Line,
    Dashes,
    Hatching,
    Grey,
    Dot,
}

/// The marks of some panels.
fn entries(panels: &[Panel], has_truth: bool, measure: Measure) -> Vec<(Mark, &'static str)> {
    let any = |end: End| panels.iter().any(|panel| panel.has(end));
    let has_contour = panels.iter().any(|panel| !panel.contour.is_empty());
    let is_never = matches!(measure, Measure::Settled(_));
    let entries = [
        (true, Mark::Dot, "setting on screen"),
        (has_contour, Mark::Line, "consistent: mean NIS in its 99 % interval"),
        (has_truth, Mark::Dashes, "truth"),
        (any(End::Lost), Mark::Hatching, "lost the truth"),
        (any(End::Stopped), Mark::Grey, if is_never { "stopped, or never settled" } else { "stopped" }),
        (is_never && !any(End::Stopped), Mark::Grey, "never settled"),
    ];
    entries.into_iter().filter(|(is_there, ..)| *is_there).map(|(_, mark, text)| (mark, text)).collect()
}

/// The number of lines that a legend of any marks may need in a width.
pub(super) fn lines(width: f32) -> usize {
    if width > 560.0 { 1 } else { 2 }
}

/// Draws the legend into a room.
pub(super) fn legend_ui(
    ui: &Ui,
    room: Rect,
    panels: &[Panel],
    (has_truth, measure): (bool, Measure),
    palette: &Palette,
) {
    let painter = ui.painter().with_clip_rect(room.expand(2.0));
    let font = TextStyle::Small.resolve(ui.style());
    let mut at = room.left_top();
    for (mark, text) in entries(panels, has_truth, measure) {
        let galley = painter.layout_no_wrap(text.to_owned(), font.clone(), palette.weak);
        let width = SAMPLE.x + 4.0 + galley.size().x;
        if at.x > room.left() && at.x + width > room.right() {
            at = pos2(room.left(), at.y + LINE);
        }
        let middle = pos2(at.x + 0.5 * SAMPLE.x, at.y + 0.5 * LINE);
        mark.paint(&painter, Rect::from_center_size(middle, SAMPLE), palette);
        painter.galley(pos2(at.x + SAMPLE.x + 4.0, middle.y - 0.5 * galley.size().y), galley, palette.weak);
        at.x += width + GAP;
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
            Self::Grey => _ = painter.rect_filled(rect, 0.0, palette.grid),
            Self::Dot => {
                painter.circle(rect.center(), 4.0, palette.warning, Stroke::new(1.0, Color32::WHITE));
                painter.circle_stroke(rect.center(), 5.0, Stroke::new(0.8, Color32::BLACK));
            }
        }
    }
}

/// A score in words, with its unit.
pub(in crate::views) fn score_text(measure: Measure, value: f64) -> String {
    match measure {
        Measure::Diverged | Measure::Stopped if !value.is_nan() => if value == 0.0 { "no" } else { "yes" }.to_owned(),
        Measure::Verdict => {
            let kind = (value >= 0.0).then(|| VerdictKind::ALL.get(value as usize)).flatten();
            kind.map_or("not known", |kind| kind.name()).to_owned()
        }
        Measure::Settled(_) if value == f64::INFINITY => "never".to_owned(),
        _ => format!("{} {}", significant(value, 4), measure.unit()).trim_end().to_owned(),
    }
}
