//! A message, until it is dismissed or, about something that has been done, has been read.

use egui::{Button, Context, Ui};

use crate::request::Request;
use crate::theme::Palette;

/// The time for which a message about something that has been done stays \[s\].
const STAYS: f64 = 8.0;

/// A message.
pub(crate) struct Notice {
    pub(crate) sentence: String,
    is_failure: bool,
    /// The time of the first frame with the message, if there has been one \[s\].
    since: Option<f64>,
}

impl Notice {
    /// A message about something that has been done.
    pub(crate) fn done(sentence: &str) -> Self {
        Self { sentence: sentence.to_owned(), is_failure: false, since: None }
    }

    /// Whether the message has been there for long enough. A failure stays until it is dismissed.
    pub(crate) fn is_over(&mut self, ctx: &Context) -> bool {
        if self.is_failure {
            return false;
        }
        let now = ctx.input(|input| input.time);
        let rest = *self.since.get_or_insert(now) + STAYS - now;
        if rest > 0.0 {
            ctx.request_repaint_after(std::time::Duration::from_secs_f64(rest));
        }
        rest <= 0.0
    }
}

/// A sentence about a failure.
impl From<String> for Notice {
    fn from(sentence: String) -> Self {
        Self { sentence, is_failure: true, since: None }
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
