//! The window: bar, settings, lesson and views.

use egui::{CentralPanel, Color32, Context, Frame, Margin, Panel, Ui};

use super::App;
use crate::bar::Bar;
use crate::controls::{Asked, controls_ui};
use crate::keys;
use crate::legend::legend_ui;
use crate::notice::notice_ui;
use crate::panes::panes_ui;
use crate::reading::{self, Reading};
use crate::request::Request;
use crate::theme::Palette;
use crate::tutor::{self, Tutor};
use crate::view::ViewContext;

/// Limits the width of a window whose settings are a drawer under the plots \[points\].
pub(super) const NARROW: f32 = 720.0;

/// Limits the width of a window in which a lesson replaces the settings, unless the user opens them \[points\].
pub(super) const WIDE: f32 = 1500.0;

/// In presenter mode the bar is there for a pointer near it, for a finger, and for who goes through it by keyboard.
fn is_bar_wanted(ctx: &Context) -> bool {
    let near = ctx.input(|input| {
        input.has_touch_screen()
            || input.pointer.latest_pos().is_none_or(|at| at.y < NEAR_BAR + input.content_rect().top())
    });
    near || egui::Popup::is_any_open(ctx) || ctx.memory(|memory| memory.focused().is_some())
}

/// Limits the height of a window that shows settings beside plots, unless the user opens them \[points\].
const LOW: f32 = 480.0;

/// The distance from the top at which a pointer is near the bar \[points\].
const NEAR_BAR: f32 = 50.0;

impl App {
    /// Fills the window.
    pub(super) fn window_ui(&mut self, ui: &mut Ui) {
        let palette = Palette::of(ui.ctx().theme());
        self.width = ui.available_width();
        self.low = ui.available_height() < LOW;
        let narrow = self.width < NARROW;
        self.theme = ui.ctx().options(|options| options.theme_preference);
        let open = self.controls_open();
        let ground = if self.cleared { Color32::TRANSPARENT } else { palette.ground };
        let frame = Frame::new().fill(ground).inner_margin(Margin::symmetric(10, 6));
        let Self { session, layout, catalogue, presenting, embedded, requests, history, .. } = self;
        let history = (history.has_undo(session.scenario()), history.has_redo(session.scenario()));
        let (presenting, embedded) = (*presenting, *embedded);
        let bar = Bar { session, layout, catalogue, controls: open, presenting, narrow, embedded, history };
        if !presenting || is_bar_wanted(ui.ctx()) {
            Panel::top("transport").frame(frame).show(ui, |ui| bar.ui(ui, requests));
        }
        if open {
            self.controls_panel_ui(ui, frame, &palette, narrow);
        }
        if !(open && narrow) {
            self.lesson_panel_ui(ui, frame, &palette, narrow);
        }
        CentralPanel::default().frame(frame).show(ui, |ui| self.centre_ui(ui, &palette, narrow));
        self.keys_ui(ui.ctx());
        self.import_ui(ui.ctx(), &palette);
        if !self.requests.is_empty() {
            ui.ctx().request_repaint();
        }
    }

    /// Whether the settings are shown.
    pub(super) fn controls_open(&self) -> bool {
        if self.embedded {
            return false;
        }
        let room = if self.tutor.is_some() { WIDE } else { NARROW };
        self.controls_open.unwrap_or(self.width >= room && !self.low && !self.presenting)
    }

    fn controls_panel_ui(&mut self, ui: &mut Ui, frame: Frame, palette: &Palette, narrow: bool) {
        // A drawer leaves the plots visible, so that the effect of a setting can be seen.
        let panel = if narrow {
            Panel::bottom("drawer").default_size(0.46 * ui.available_height()).size_range(120.0..=600.0).resizable(true)
        } else {
            Panel::left("controls").default_size((0.29 * self.width).clamp(340.0, 420.0)).size_range(300.0..=460.0)
        };
        let Self { session, tutor, requests, .. } = self;
        let lit = tutor.as_ref().map_or(vec![], Tutor::lit);
        panel.frame(frame).show(ui, |ui| {
            let mut scenario = session.scenario().clone();
            let (changed, asked) = controls_ui(ui, &mut scenario, session.library(), palette, lit);
            if changed {
                requests.push(Request::Edit(Box::new(scenario)));
            }
            requests.extend(asked.into_iter().map(|Asked::Columns| Request::ChangeColumns));
        });
    }

    fn lesson_panel_ui(&mut self, ui: &mut Ui, frame: Frame, palette: &Palette, narrow: bool) {
        let Self { tutor: Some(tutor), catalogue, requests, .. } = self else { return };
        let panel = if narrow {
            Panel::bottom("lesson").default_size(0.46 * ui.available_height()).size_range(160.0..=600.0).resizable(true)
        } else {
            Panel::right("lesson").default_size(290.0).size_range(240.0..=420.0)
        };
        panel.frame(frame).show(ui, |ui| tutor.ui(ui, catalogue, palette, requests));
    }

    /// Legend and views.
    fn centre_ui(&mut self, ui: &mut Ui, palette: &Palette, narrow: bool) {
        let Self { session, axis, ruler, visible, layout, laboratory, requests, inviting, notice, .. } = self;
        if let Some(notice) = notice {
            notice_ui(ui, notice, palette, requests);
        }
        legend_ui(ui, session, visible, palette, requests, |ui, requests| {
            if *inviting {
                tutor::invitation_ui(ui, requests);
            }
        });
        let context = ViewContext::new(session, palette, visible, axis, ruler).in_laboratory(Some(laboratory));
        panes_ui(ui, layout, &context, requests, narrow);
        if let Some(reading) = Reading::of(ruler, session, visible, palette) {
            reading::table_ui(ui.ctx(), &reading, requests);
        }
    }

    fn keys_ui(&mut self, ctx: &Context) {
        if self.keys_open {
            let window = egui::Window::new("Keys").collapsible(false).resizable(false).open(&mut self.keys_open);
            window.anchor(egui::Align2::CENTER_CENTER, egui::Vec2::ZERO).show(ctx, keys::list_ui);
        }
    }
}
