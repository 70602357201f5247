//! A message, until it is dismissed.

use egui::{Button, Ui};

use crate::request::Request;
use crate::theme::Palette;

/// A message.
pub(crate) struct Notice {
    pub(crate) sentence: String,
    is_failure: bool,
}

impl Notice {
    /// A message about something that has been done.
    pub(crate) fn done(sentence: &str) -> Self {
        Self { sentence: sentence.to_owned(), is_failure: false }
    }
}

/// A sentence about a failure.
impl From<String> for Notice {
    fn from(sentence: String) -> Self {
        Self { sentence, is_failure: true }
    }
}

/// Shows the message with a button to dismiss it.
pub(crate) fn notice_ui(ui: &mut Ui, notice: &Notice, palette: &Palette, requests: &mut Vec<Request>) {
    ui.horizontal_wrapped(|ui| {
        let color = if notice.is_failure { palette.warning } else { ui.visuals().text_color() };
        ui.colored_label(color, &notice.sentence);
        let dismiss = ui.add(Button::new("×").small()).on_hover_text("Dismiss");
        dismiss.ctx.accesskit_node_builder(dismiss.id, |node| node.set_label("Dismiss"));
        if dismiss.clicked() {
            requests.push(Request::DismissNotice);
        }
    });
}
