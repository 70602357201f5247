//! Verdicts on screen: a symbol and a word beside a filter's name.

use egui::{Color32, FontId, Response, Sense, Stroke, StrokeKind, TextStyle, Ui, Vec2, WidgetInfo};
use kalmanscope_diagnosis::{Verdict, VerdictKind};

use crate::theme::{self, Palette};

const MARGIN: f32 = 5.0;

pub(crate) const fn symbol(kind: VerdictKind) -> &'static str {
    match kind {
        VerdictKind::Consistent => "✓",
        VerdictKind::Recovered => "↺",
        VerdictKind::NotIdentifiable => "○",
        VerdictKind::Underconfident => "↓",
        VerdictKind::PatternLeft => "~",
        VerdictKind::Overconfident => "↑",
        VerdictKind::WoundUp => "∞",
        VerdictKind::Collapsed => "●",
        VerdictKind::Lost => "✕",
        VerdictKind::Diverged => "⚠",
    }
}

pub(crate) const fn text_color(kind: VerdictKind, palette: &Palette) -> Color32 {
    if kind.is_good() { palette.text } else { palette.warning }
}

/// The opacity of the verdict on a filter that is hidden. It keeps its place, so that nothing moves under the pointer.
const HIDDEN: f32 = 0.3;

pub(crate) fn chip_ui(
    ui: &mut Ui,
    name: &str,
    verdict: &Verdict,
    (color, on): (Color32, bool),
    palette: &Palette,
) -> Response {
    let opacity = if on { 1.0 } else { HIDDEN };
    let (color, text_color) = (color.gamma_multiply(opacity), palette.text.gamma_multiply(opacity));
    let kind = verdict.kind;
    let small = TextStyle::Small.resolve(ui.style());
    let mark = ui.painter().layout_no_wrap(symbol(kind).to_owned(), FontId::new(small.size, theme::strong()), color);
    let text = ui.painter().layout_no_wrap(kind.name().to_owned(), small, text_color);
    let size = Vec2::new(mark.size().x + text.size().x + 4.0 + 2.0 * MARGIN, 18.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, kind.on(name)));
    let fill = if kind.is_good() { Color32::TRANSPARENT } else { color.gamma_multiply(0.16) };
    let width = if response.hovered() || response.has_focus() { 2.0 } else { 1.0 };
    ui.painter().rect(rect, 9.0, fill, Stroke::new(width, color), StrokeKind::Inside);
    let at = |x: f32, height: f32| egui::pos2(rect.left() + MARGIN + x, rect.center().y - 0.5 * height);
    let after = mark.size().x + 4.0;
    ui.painter().galley(at(0.0, mark.size().y), mark, color);
    ui.painter().galley(at(after, text.size().y), text, text_color);
    response.on_hover_ui(|ui| {
        ui.set_max_width(380.0);
        ui.label(verdict.to_string());
        ui.weak("Parts of the record that are bad are marked at the foot of each plot. Click for evidence and causes.");
    })
}
