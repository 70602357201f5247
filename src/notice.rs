//! A message about a failure, until it is dismissed.

use egui::{Button, Ui};

use crate::request::Request;
use crate::theme::Palette;

/// Shows the message with a button to dismiss it.
pub(crate) fn notice_ui(ui: &mut Ui, sentence: &str, palette: &Palette, requests: &mut Vec<Request>) {
    ui.horizontal_wrapped(|ui| {
        ui.colored_label(palette.warning, sentence);
        let dismiss = ui.add(Button::new("×").small()).on_hover_text("Dismiss");
        dismiss.ctx.accesskit_node_builder(dismiss.id, |node| node.set_label("Dismiss"));
        if dismiss.clicked() {
            requests.push(Request::DismissNotice);
        }
    });
}
