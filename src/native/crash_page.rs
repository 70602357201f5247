//! The window after a crash: the reason, and two ways to go on.

use egui::{Align, Button, CentralPanel, Frame, Layout, Margin, RichText, ScrollArea, Ui};
use kalmanscope::theme::{self, Palette};

use super::crash::Crash;

/// Limits the width of the text \[points\].
const WIDEST: f32 = 560.0;

/// The way to go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Choice {
    /// With the state as of the crash.
    Restore,
    /// With the first scenario.
    StartAnew,
}

/// A crash, as the window shows it.
pub(super) struct CrashPage {
    /// The note, or the reason why it cannot be read.
    pub(super) crash: Result<Crash, String>,
    /// The place where the note is put once the user has chosen.
    pub(super) told: String,
    /// Whether the crash before was at the same place.
    pub(super) is_repeated: bool,
    /// Whether the button has been given the focus.
    has_focus: bool,
}

impl CrashPage {
    /// A crash. Its note moves to `told` once the user has chosen.
    pub(super) fn new(crash: Result<Crash, String>, told: String, is_repeated: bool) -> Self {
        Self { crash, told, is_repeated, has_focus: false }
    }

    /// Fills the window. Returns the user's choice.
    pub(super) fn ui(&mut self, ui: &mut Ui) -> Option<Choice> {
        let palette = Palette::of(ui.ctx().theme());
        let frame = Frame::new().fill(palette.ground).inner_margin(Margin::same(24));
        let page = CentralPanel::default().frame(frame).show(ui, |ui| {
            let side = (0.5 * (ui.available_width() - WIDEST)).max(0.0);
            let top = (0.12 * ui.available_height()).min(90.0);
            let scroll = ScrollArea::vertical().show(ui, |ui| {
                ui.add_space(top);
                ui.horizontal_top(|ui| {
                    ui.add_space(side);
                    let width = ui.available_width().min(WIDEST);
                    let column = ui.allocate_ui_with_layout([width, 0.0].into(), Layout::top_down(Align::Min), |ui| {
                        ui.set_width(width);
                        self.column_ui(ui, &palette)
                    });
                    column.inner
                })
            });
            scroll.inner.inner
        });
        page.inner
    }

    fn column_ui(&mut self, ui: &mut Ui, palette: &Palette) -> Option<Choice> {
        let Self { crash, told, is_repeated, has_focus } = self;
        ui.spacing_mut().item_spacing.y = 10.0;
        ui.label(RichText::new("Kalmanscope has stopped").family(theme::strong()).size(22.0));
        let has_settings = crash.as_ref().is_ok_and(|crash| crash.session.is_some());
        let kept = if has_settings { "as of that moment" } else { "as they were saved last" };
        ui.label(format!("The program met with an error of its own and ended. Your settings {kept} are kept."));
        if *is_repeated {
            ui.colored_label(
                palette.warning,
                "It has happened at the same place before: these settings may end the program again.",
            );
        }
        ui.add_space(6.0);
        let choice = ui.horizontal_wrapped(|ui| {
            let restore = ui.add(Button::new("Restore").selected(true).min_size([110.0, 32.0].into()));
            if !std::mem::replace(has_focus, true) {
                restore.request_focus();
            }
            let anew = ui.add(Button::new("Start anew").min_size([110.0, 32.0].into()));
            let chosen = [(restore, Choice::Restore), (anew, Choice::StartAnew)];
            chosen.into_iter().find(|(button, _)| button.clicked()).map(|(_, choice)| choice)
        });
        ui.label("Restore opens the settings again. Start anew opens the first scenario.");
        ui.add_space(6.0);
        ui.separator();
        match crash {
            Ok(Crash { message, place, version, thread, .. }) => {
                ui.label(RichText::new(message.as_str()).monospace());
                ui.label(RichText::new(format!("{place}, version {version}, thread “{thread}”")).color(palette.weak));
            }
            Err(reason) => {
                ui.label(format!("The note about the crash cannot be read: {reason}."));
            }
        }
        let sentence = format!("This note is kept as {told}: please add it to a report.");
        ui.label(RichText::new(sentence).color(palette.weak));
        choice.inner
    }
}
