//! The panels beside the plots, or drawers below them: settings, lesson, diagnosis.

use egui::{Align, Frame, Layout, Panel, RichText, Ui};
use kalmanscope_core::setting::Change;

use super::App;
use crate::bar::{self, History};
use crate::controls::{Edits, PanelRequest, controls_ui, few_controls_ui};
use crate::drawer::{Drawer, close_ui};
use crate::panes::help_ui;
use crate::request::Request;
use crate::theme::{self, Palette};
use crate::tutor::invitation_ui;
use crate::view::ViewContext;
use crate::views::diagnosis;

#[derive(Default)]
pub(super) struct Drawers {
    settings: Drawer,
    lesson: Drawer,
    diagnosis: Drawer,
}

impl App {
    pub(super) fn controls_panel_ui(
        &mut self,
        ui: &mut Ui,
        frame: Frame,
        palette: &Palette,
        (drawer, history): (Option<f32>, History),
    ) {
        let Self { session, tutor, requests, width, drawers, all_settings, story, inviting, .. } = self;
        let lit = tutor.as_mut().map_or(vec![], |tutor| tutor.lit(session.scenario()));
        let is_short = !*all_settings;
        let contents = |ui: &mut Ui, requests: &mut Vec<Request>| {
            let mut edits = Edits { scenario: session.shared_scenario(), change: Change::default() };
            if is_short {
                let all = few_controls_ui(ui, &mut edits, story, |ui| {
                    if *inviting {
                        invitation_ui(ui, requests);
                    }
                });
                requests.extend(Request::edit(edits.change));
                requests.extend(all.then_some(Request::ShowAllSettings(true)));
                return;
            }
            let asked = controls_ui(ui, &mut edits, session.library(), palette, lit);
            requests.extend(Request::edit(edits.change));
            requests.extend(asked.into_iter().map(|asked| match asked {
                PanelRequest::Columns => Request::ChangeColumns,
                PanelRequest::Equation => Request::EditEquation,
                PanelRequest::Fewer => Request::ShowAllSettings(false),
            }));
        };
        let Some(height) = drawer else {
            let panel = if is_short {
                Panel::left("few controls").default_size((0.17 * *width).clamp(250.0, 340.0)).size_range(200.0..=360.0)
            } else {
                Panel::left("controls").default_size((0.29 * *width).clamp(340.0, 420.0)).size_range(300.0..=460.0)
            };
            panel.frame(frame).show(ui, |ui| contents(ui, requests));
            return;
        };
        let mut asked = Vec::new();
        let heading = |ui: &mut Ui| {
            ui.label(RichText::new("Settings").family(theme::strong()).size(15.0));
            bar::history_ui(ui, history, &mut asked);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if close_ui(ui, "Close the settings") {
                    asked.push(Request::ToggleControls);
                }
            });
        };
        drawers.settings.ui(ui, "settings", (frame, height), heading, |ui| contents(ui, requests));
        requests.append(&mut asked);
    }

    pub(super) fn lesson_panel_ui(&mut self, ui: &mut Ui, frame: Frame, palette: &Palette, drawer: Option<f32>) {
        let Self { tutor: Some(tutor), catalogue, requests, drawers, .. } = self else { return };
        let Some(height) = drawer else {
            let panel = Panel::right("lesson").default_size(290.0).size_range(240.0..=420.0);
            panel.frame(frame).show(ui, |ui| {
                // The panel keeps its size when the text becomes shorter.
                ui.set_min_size(ui.available_size());
                tutor.title_ui(ui, Align::Min, requests);
                tutor.ui(ui, catalogue, palette, requests);
            });
            return;
        };
        let mut asked = Vec::new();
        let heading = |ui: &mut Ui| tutor.title_ui(ui, Align::Center, &mut asked);
        let contents = |ui: &mut Ui| tutor.ui(ui, catalogue, palette, requests);
        drawers.lesson.ui(ui, "lesson", (frame, height), heading, contents);
        requests.append(&mut asked);
    }

    pub(super) fn diagnosis_ui(&mut self, ui: &mut Ui, frame: Frame, palette: &Palette, drawer: Option<f32>) {
        let Self { session, axis, ruler, visible, requests, drawers, diagnosed: Some(id), .. } = self else { return };
        let context = ViewContext::new(session, palette, visible, axis, ruler);
        let mut asked = Vec::new();
        let heading = |ui: &mut Ui| {
            ui.label(RichText::new("Diagnosis").family(theme::strong()).size(15.0));
            help_ui(ui, diagnosis::HELP.0, diagnosis::HELP.1);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if close_ui(ui, "Close the diagnosis") {
                    asked.push(Request::CloseDiagnosis);
                }
            });
        };
        let mut contents = |ui: &mut Ui| diagnosis::drawer_ui(ui, &context, *id, requests);
        match drawer {
            Some(height) => drawers.diagnosis.ui(ui, "diagnosis", (frame, height), heading, contents),
            None => {
                let panel = Panel::right("diagnosis").default_size(340.0).size_range(280.0..=560.0);
                panel.frame(frame).show(ui, |ui| {
                    ui.set_min_size(ui.available_size());
                    ui.horizontal(heading);
                    contents(ui);
                });
            }
        }
        requests.append(&mut asked);
    }
}
