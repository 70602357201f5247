//! The window: bar, settings, lesson and views.

use egui::{CentralPanel, Color32, Context, Frame, Margin, Panel, Ui};

use super::App;
use crate::bar::{Bar, History};
use crate::legend::{Legend, LegendExtent};
use crate::notice;
use crate::panes::{PaneArrangement, panes_ui};
use crate::request::Request;
use crate::ruler_table::{self, RulerReading};
use crate::story;
use crate::theme::{self, Palette};
use crate::transport::{Transport, TransportExtent};
use crate::view::ViewContext;
use crate::{keys, tutor, widgets};

/// Limits the width of a window that shows its settings in a drawer under the plots \[points\].
pub(super) const NARROW: f32 = 720.0;

/// Limits the width of a window in which a lesson replaces the settings, unless the user opens them \[points\].
pub(super) const WIDE: f32 = 1500.0;

/// In presenter mode the bar is shown only while it may be used: by a pointer near it, a finger, the keyboard, a menu.
fn is_bar_wanted(ctx: &Context) -> bool {
    let near =
        ctx.input(|input| input.pointer.latest_pos().is_none_or(|at| at.y < NEAR_BAR + input.content_rect().top()));
    near || theme::is_for_fingers(ctx)
        || egui::Popup::is_any_open(ctx)
        || ctx.memory(|memory| memory.focused().is_some_and(|id| id != tutor::text_id()))
}

/// Limits the height of a window that shows settings beside plots, unless the user opens them \[points\].
const LOW: f32 = 480.0;

const NEAR_BAR: f32 = 50.0;

fn missing_ui(ui: &mut Ui, name: &str, requests: &mut Vec<Request>) {
    ui.vertical_centered(|ui| {
        ui.add_space(0.35 * ui.available_height());
        ui.label(format!("The record “{name}” is not here. Drop the file on the window, or choose it."));
        ui.add_space(8.0);
        if ui.button("Choose the file…").clicked() {
            requests.push(Request::ChooseFile);
        }
    });
}

impl App {
    pub(super) fn window_ui(&mut self, ui: &mut Ui) {
        let palette = Palette::of(ui.ctx().theme());
        self.width = ui.available_width();
        theme::fit_text(ui.ctx(), self.width, self.presenting);
        let height = ui.available_height();
        self.low = height < LOW;
        let narrow = self.width < NARROW;
        self.theme = ui.ctx().options(|options| options.theme_preference);
        let open = self.controls_open();
        if open || self.tells_story() {
            self.story = story::story_of(&self.session);
        }
        let ground = if self.cleared { Color32::TRANSPARENT } else { palette.ground };
        let frame = Frame::new().fill(ground).inner_margin(Margin::symmetric(10, 6));
        let extent = self.transport(narrow);
        let Self { session, layout, catalogue, presenting, embedded, requests, history, sensors, .. } = self;
        let now = session.version();
        let history = History { has_undo: history.has_undo(&now), has_redo: history.has_redo(&now) };
        let (presenting, embedded) = (*presenting, *embedded);
        let measures = !sensors.is_empty();
        let bar = Bar { session, layout, catalogue, controls: open, presenting, narrow, history, measures };
        if !embedded && (!presenting || is_bar_wanted(ui.ctx())) {
            Panel::top("bar").frame(frame).show(ui, |ui| bar.ui(ui, requests));
        }
        self.live_ui(ui, frame, &palette);
        let is_missing = self.session.missing_record().is_some();
        if narrow && !is_missing {
            // The drawer comes first: its height depends on the room that is left.
            let frame = frame.inner_margin(Margin { bottom: 0, ..frame.inner_margin });
            let legend = Panel::top("legend").frame(frame).show_separator_line(false);
            legend.show(ui, |ui| self.legend_ui(ui, &palette));
        }
        let drawer = narrow.then_some(height);
        if narrow {
            // At the very foot, under the drawers.
            self.transport_ui(ui, frame, &palette, (narrow, extent, history));
        }
        if open {
            self.controls_panel_ui(ui, frame, &palette, (drawer, history));
        }
        if !(open && narrow) {
            self.lesson_panel_ui(ui, frame, &palette, drawer);
        }
        if !(is_missing || narrow && (open || self.tutor.is_some())) {
            self.diagnosis_ui(ui, frame, &palette, drawer);
        }
        if !narrow {
            self.transport_ui(ui, frame, &palette, (narrow, extent, history));
        }
        let centre = CentralPanel::default().frame(frame).show(ui, |ui| self.centre_ui(ui, &palette, narrow));
        if let Some(notice) = &self.notice {
            notice::notice_ui(ui.ctx(), notice, centre.response.rect, &palette, &mut self.requests);
        }
        if self.keys_open {
            keys::window_ui(ui.ctx(), &mut self.keys_open);
        }
        // Taken out, since its picture is drawn from the whole app.
        if let Some(mut dialog) = self.figure_dialog.take() {
            let mut requests = Vec::new();
            let is_open = dialog.ui(ui.ctx(), |format| self.figure(format), &mut requests);
            self.requests.append(&mut requests);
            self.figure_dialog = Some(dialog).filter(|_| is_open);
        }
        let Self { finder, editor, session, catalogue, requests, .. } = self;
        finder.take_if(|finder| !finder.ui(ui.ctx(), (session, catalogue), requests));
        widgets::ring_ui(ui.ctx(), &palette);
        editor.take_if(|editor| !editor.ui(ui.ctx(), session.scenario(), &palette, requests));
        self.measure_ui(ui.ctx(), &palette);
        self.import_ui(ui.ctx(), &palette);
        // Requests are applied in the next frame, for which nothing else may ask.
        if !self.requests.is_empty() {
            ui.ctx().request_repaint();
        }
    }

    pub(super) fn controls_open(&self) -> bool {
        if self.embedded {
            return false;
        }
        let room = if self.tutor.is_some() { WIDE } else { NARROW };
        self.controls_open.unwrap_or(self.width >= room && !self.low && !self.presenting)
    }

    fn is_tight(&self) -> bool {
        (self.width < NARROW || self.low) && (self.controls_open() || self.tutor.is_some())
    }

    fn transport(&self, narrow: bool) -> TransportExtent {
        match (self.is_tight(), self.controls_open() && narrow) {
            (false, _) => TransportExtent::Full,
            (true, false) => TransportExtent::Short,
            (true, true) => TransportExtent::Nothing,
        }
    }

    fn tells_story(&self) -> bool {
        self.tutor.is_none() && !self.low && self.session.missing_record().is_none()
    }

    fn transport_ui(
        &mut self,
        ui: &mut Ui,
        frame: Frame,
        palette: &Palette,
        (narrow, extent, history): (bool, TransportExtent, History),
    ) {
        // There is nothing to play where the record is missing.
        if extent == TransportExtent::Nothing || self.session.missing_record().is_some() {
            return;
        }
        let Self { session, ruler, embedded, requests, .. } = self;
        let transport = Transport { session, ruler, palette, narrow, extent, embedded: *embedded, history };
        let frame = if narrow { frame.inner_margin(Margin::symmetric(10, 3)) } else { frame };
        Panel::bottom("transport").frame(frame).show(ui, |ui| transport.ui(ui, requests));
    }

    fn legend_ui(&mut self, ui: &mut Ui, palette: &Palette) {
        let extent = if self.is_tight() || self.low { LegendExtent::OneRow } else { LegendExtent::Full };
        let Self { session, visible, requests, .. } = self;
        Legend { session, visible, palette }.ui(ui, extent, requests);
    }

    fn centre_ui(&mut self, ui: &mut Ui, palette: &Palette, narrow: bool) {
        if let Some(name) = self.session.missing_record() {
            return missing_ui(ui, name, &mut self.requests);
        }
        if !narrow {
            if self.tells_story() {
                story::story_ui(ui, (&self.story, &self.session), palette, true, &mut self.requests);
            }
            self.legend_ui(ui, palette);
        }
        let is_tuning = self.is_tight() && self.controls_open();
        let is_told = narrow && self.tells_story();
        let Self { session, axis, ruler, visible, layout, laboratory, requests, story, inviting, .. } = self;
        let context = ViewContext::new(session, palette, visible, axis, ruler).in_laboratory(Some(laboratory));
        let way = match (narrow, is_tuning || (self.low && !narrow)) {
            (_, true) => PaneArrangement::Plots,
            (true, false) => PaneArrangement::Column,
            (false, false) => PaneArrangement::Tiles,
        };
        panes_ui(ui, layout, &context, requests, way, |ui, requests| {
            if is_told {
                story::story_ui(ui, (story, session), palette, false, requests);
                if *inviting {
                    tutor::invitation_ui(ui, requests);
                }
            }
        });
        if let Some(reading) = RulerReading::of(ruler, session, visible, palette) {
            ruler_table::table_ui(ui.ctx(), &reading, requests);
        }
    }
}
