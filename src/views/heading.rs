//! The line above a chart: what it shows, and the values at the cursor.

use egui::{Align, Color32, FontSelection, Id, Layout, Response, RichText, TextStyle, Ui, vec2};

use crate::theme;

/// A value in a heading.
pub(super) struct Readout {
    pub(super) text: String,
    pub(super) color: Color32,
    /// Whose value it is.
    pub(super) hint: String,
}

/// Space between the parts of a heading \[points\].
const GAP: f32 = 10.0;

/// Name and unit at the left, values at the cursor or at playback at the right. Returns the symbol, at the very left.
pub(super) fn heading_ui(ui: &mut Ui, symbol: &str, name: &str, unit: &str, readouts: &[Readout]) -> Response {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = GAP;
        let label = ui.label(RichText::new(symbol).family(theme::strong()).size(15.0));
        let unit = if unit.is_empty() { String::new() } else { format!(" [{unit}]") };
        let named = ui.available_width() > 200.0 + 75.0 * readouts.len() as f32;
        ui.weak(if named { format!("{name}{unit}") } else { unit });
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| readouts_ui(ui, symbol, readouts));
        label
    })
    .inner
}

/// As many values as there is room for, without their ±2σ where it is tight; where some are left out, the hint has all.
fn readouts_ui(ui: &mut Ui, symbol: &str, readouts: &[Readout]) {
    let room = ui.available_width();
    let total = |widths: &[f32]| widths.iter().map(|width| width + GAP).sum::<f32>();
    let mut texts: Vec<&str> = readouts.iter().map(|readout| readout.text.as_str()).collect();
    let mut shown: Vec<f32> = texts.iter().map(|text| width(ui, text)).collect();
    if total(&shown) > room {
        texts.iter_mut().for_each(|text| *text = value(text));
        shown = texts.iter().map(|text| width(ui, text)).collect();
    }
    let all = shown.len();
    while total(&shown) + width(ui, "…") > room && shown.pop().is_some() {}
    if shown.len() < all {
        let lines = readouts.iter().map(|r| format!("{}: {}", r.hint, r.text));
        ui.label(RichText::new("…").small()).on_hover_text(lines.collect::<Vec<_>>().join("\n"));
    }
    for ((readout, text), width) in readouts.iter().zip(texts).zip(shown).rev() {
        // A value keeps the room that it once had: nothing jumps while it changes.
        let id = ui.scope_id().with((symbol, &readout.hint));
        let width = steady(ui, id, width);
        ui.allocate_ui_with_layout(vec2(width, ui.available_height()), Layout::right_to_left(Align::Center), |ui| {
            let text = RichText::new(text).small().color(readout.color);
            ui.label(text).on_hover_text(format!("{}: {}", readout.hint, readout.text));
        });
    }
}

/// The value without what is after it.
fn value(text: &str) -> &str {
    text.split(' ').next().unwrap_or(text)
}

fn width(ui: &Ui, text: &str) -> f32 {
    let font = FontSelection::Style(TextStyle::Small).resolve(ui.style());
    ui.painter().layout_no_wrap(text.to_owned(), font, Color32::PLACEHOLDER).size().x
}

/// The largest width so far, unless that was much more.
fn steady(ui: &Ui, id: Id, width: f32) -> f32 {
    ui.data_mut(|data| {
        let kept = data.get_temp_mut_or(id, width);
        *kept = if *kept > 1.3 * width { width } else { kept.max(width) };
        *kept
    })
}
