//! The legend of a figure: the entries that are shown, without buttons.

use egui::{Color32, Label, Sense, Ui, vec2};
use kalmanscope_core::Channel;

use crate::legend::{Mark, paint_mark};
use crate::view::ViewContext;

/// The size of a sample \[points of the canvas\].
const SAMPLE: egui::Vec2 = vec2(18.0, 9.0);

pub(super) fn legend_ui(ui: &mut Ui, context: &ViewContext<'_>) {
    let ViewContext { session, palette, visible, .. } = *context;
    let record = session.run().record();
    let knows_truth = Channel::all().iter().any(|channel| record.truth(*channel).is_some());
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = vec2(12.0, 2.0);
        if visible.truth && knows_truth {
            entry_ui(ui, "truth", Mark::Line, palette.truth);
        }
        if visible.measured && !record.sensors().is_empty() {
            entry_ui(ui, "measured", Mark::Dots, palette.weak);
        }
        for (_, estimates) in context.filters() {
            let mark = if visible.bands { Mark::Band } else { Mark::Line };
            let end = if visible.bands { " ±2σ" } else { "" };
            entry_ui(ui, &format!("{}{end}", estimates.name()), mark, palette.shade(estimates.color()));
        }
        if visible.hindsight && !session.smoothed().is_empty() {
            entry_ui(ui, "hindsight", Mark::Dashes, palette.weak);
        }
        if let Some(words) = session.before().map(|before| before.words.as_str()) {
            entry_ui(ui, &format!("before: {words}"), Mark::Line, palette.weak);
        }
    });
}

fn entry_ui(ui: &mut Ui, name: &str, mark: Mark, color: Color32) {
    let font = egui::TextStyle::Body.resolve(ui.style());
    let text = ui.painter().layout_no_wrap(name.to_owned(), font, ui.visuals().text_color());
    let size = text.size() + vec2(SAMPLE.x + 5.0, 0.0);
    // Sample and text stay together where a line ends.
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let sample = egui::Rect::from_center_size(rect.left_center() + vec2(0.5 * SAMPLE.x, 0.0), SAMPLE);
    paint_mark(ui.painter(), sample, mark, color);
    let label = egui::Rect::from_min_max(egui::pos2(sample.right() + 5.0, rect.top()), rect.max);
    ui.put(label, Label::new(text).selectable(false));
}
