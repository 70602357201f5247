//! A message about a failure, or about a file that was written, until it is dismissed.

use egui::{Button, Color32, Ui};

use crate::request::Request;

/// Shows the message with a button to dismiss it.
pub(crate) fn notice_ui(ui: &mut Ui, sentence: &str, color: Color32, requests: &mut Vec<Request>) {
    ui.horizontal_wrapped(|ui| {
        ui.colored_label(color, sentence);
        let dismiss = ui.add(Button::new("×").small()).on_hover_text("Dismiss");
        dismiss.ctx.accesskit_node_builder(dismiss.id, |node| node.set_label("Dismiss"));
        if dismiss.clicked() {
            requests.push(Request::DismissNotice);
        }
    });
}
