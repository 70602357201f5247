//! Headings in the panel of a lesson.

use egui::{RichText, Ui};

/// The small heading of a part of the text.
pub(super) fn heading_ui(ui: &mut Ui, heading: &str) {
    ui.label(RichText::new(heading).small().weak());
}
