//! Headings in the panel of a lesson.

use egui::{RichText, Ui};

pub(super) fn heading_ui(ui: &mut Ui, heading: &str) {
    ui.label(RichText::new(heading).small().weak());
}
