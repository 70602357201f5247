//! A message, until it is dismissed or, about something that has been done, has been read.

use egui::{Align2, Area, Button, Context, Frame, Id, Label, Order, Rect, RichText, Stroke, Vec2, vec2};

use crate::probe::Remembered as _;
use crate::request::Request;
use crate::theme::Palette;
use crate::widgets::named;

const STAYS: f64 = 8.0;

const APART: f32 = 12.0;

const BUTTON: f32 = 120.0;

const WIDEST: f32 = 560.0;

pub(crate) struct Notice {
    pub(crate) sentence: String,
    pub(crate) is_failure: bool,
    pub(crate) button: Option<(&'static str, Request)>,
    pub(crate) since: Option<f64>,
}

impl Notice {
    pub(crate) fn done(sentence: &str) -> Self {
        Self { sentence: sentence.to_owned(), is_failure: false, button: None, since: None }
    }

    pub(crate) fn with(self, more: &str) -> Self {
        Self { sentence: format!("{} {more}", self.sentence).trim().to_owned(), since: None, ..self }
    }

    pub(crate) fn of_stalled_work(sentence: String) -> Self {
        Self { button: Some(("Stop", Request::Leave)), ..Self::from(sentence) }
    }

    pub(crate) fn is_of_stalled_work(&self) -> bool {
        self.button.as_ref().is_some_and(|(_, request)| *request == Request::Leave)
    }

    pub(crate) fn is_over(&mut self, ctx: &Context) -> bool {
        if self.is_failure {
            return false;
        }
        let now = ctx.input(|input| input.time);
        // Counted from the first frame that shows it: a long frame before must not use up its time.
        let rest = *self.since.get_or_insert(now) + STAYS - now;
        if rest > 0.0 {
            ctx.request_repaint_after(std::time::Duration::from_secs_f64(rest));
        }
        rest <= 0.0
    }
}

impl From<String> for Notice {
    fn from(sentence: String) -> Self {
        Self { sentence, is_failure: true, button: None, since: None }
    }
}

pub(crate) fn notice_ui(ctx: &Context, notice: &Notice, plots: Rect, palette: &Palette, requests: &mut Vec<Request>) {
    let at = plots.center_bottom() - vec2(0.0, APART);
    let area = Area::new(Id::unique("notice")).order(Order::Foreground).pivot(Align2::CENTER_BOTTOM).fixed_pos(at);
    let width = (plots.width() - 2.0 * APART).clamp(1.0, WIDEST);
    let color = if notice.is_failure { palette.warning } else { palette.text };
    area.default_width(width).show(ctx, |ui| {
        let frame = Frame::popup(ui.style()).stroke(Stroke::new(1.0, color));
        frame.show(ui, |ui| {
            ui.set_max_width(width);
            ui.horizontal(|ui| {
                let side = ui.spacing().interact_size.y;
                let text = RichText::new(&notice.sentence).color(color);
                let font = egui::TextStyle::Body.resolve(ui.style());
                let whole = ui.painter().layout_no_wrap(notice.sentence.clone(), font, color).size().x;
                let beside = if notice.button.is_some() { BUTTON } else { 2.0 * side };
                ui.allocate_ui(vec2(whole.min(width - beside) + 1.0, 0.0), |ui| {
                    ui.add(Label::new(text).wrap());
                });
                if let Some((text, request)) = &notice.button {
                    let button = ui.button(*text).remembered(text);
                    requests.extend(button.clicked().then(|| request.clone()));
                }
                let dismiss = Button::new("×").frame(false).min_size(Vec2::splat(side));
                let dismiss = named(ui.add(dismiss).on_hover_text("Dismiss"), "Dismiss");
                if dismiss.clicked() {
                    requests.push(Request::DismissNotice);
                }
            });
        });
    });
}
