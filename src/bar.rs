//! The bar at the top: scenarios, views, lessons, exports, appearance and history.

use egui::{Button, Color32, RichText, Ui};
use kalmanscope_lessons::{BUILT_IN, BuiltIn, EQUATIONS};

use crate::export;
use crate::layout::ViewLayout;
use crate::menu::{Closing, entry_ui, menu_ui};
use crate::probe::{self, Remembered as _};
use crate::request::{Arrangement, Request, Tabs, VIEWS, ViewKind};
use crate::session::Session;
use crate::theme::{self, Palette};
use crate::thumbnail;
use crate::tutor::{self, Catalogue};
use crate::views::sketch::sketch;
use crate::widgets::named;

/// Limits the width below which the program's name and the two settings are left out \[points\].
const ROOMY: f32 = 1000.0;

const SKETCH: egui::Vec2 = egui::vec2(54.0, 20.0);

const FORGET: &str = "Remove the record’s file from this device: it will not be here next time";

#[derive(Clone, Copy)]
pub(crate) struct History {
    pub(crate) has_undo: bool,
    pub(crate) has_redo: bool,
}

pub(crate) struct Bar<'a> {
    pub(crate) session: &'a Session,
    pub(crate) layout: &'a ViewLayout,
    pub(crate) catalogue: &'a Catalogue,
    pub(crate) controls: bool,
    pub(crate) presenting: bool,
    pub(crate) narrow: bool,
    pub(crate) history: History,
    pub(crate) measures: bool,
}

impl Bar<'_> {
    pub(crate) fn ui(&self, ui: &mut Ui, requests: &mut Vec<Request>) {
        let Self { session, layout, catalogue, controls, presenting, narrow, history, measures } = *self;
        ui.horizontal_wrapped(|ui| {
            // Text without a frame, as in other programs' bars of menus.
            ui.visuals_mut().widgets.inactive.weak_bg_fill = Color32::TRANSPARENT;
            let toggle = ui.selectable_label(controls, RichText::new("☰").size(16.0)).on_hover_text("Settings (S)");
            if named(toggle, "Settings").remembered("Settings").clicked() {
                requests.push(Request::ToggleControls);
            }
            let is_roomy = ui.max_rect().width() > ROOMY;
            if !presenting && is_roomy {
                ui.label(RichText::new("Kalmanscope").family(theme::strong()).size(17.0));
            }
            if is_roomy {
                choose_file_ui(ui, "Open…", requests);
            }
            scenario_menu_ui(ui, session, [!is_roomy, measures], requests);
            views_menu_ui(ui, layout, requests);
            tutor::menu_ui(ui, catalogue, requests);
            export::menu_ui(ui, narrow, layout, requests);
            if is_roomy {
                ui.separator();
            }
            // On a phone they stand beside the transport, or in the drawer of the settings.
            if !narrow {
                history_ui(ui, history, requests);
            }
            if session.has_snapshot() {
                snapshot_ui(ui, session, requests);
            }
            if is_roomy {
                ui.separator();
            }
            more_menu_ui(ui, session, presenting, requests);
        });
    }
}

fn choose_file_ui(ui: &mut Ui, text: &str, requests: &mut Vec<Request>) -> bool {
    let button = ui.button(text).on_hover_text("A measured record, a scenario, a lesson or a session (Ctrl+O)");
    let button = named(button, "Open a file").remembered("Open a file");
    if button.clicked() {
        requests.push(Request::ChooseFile);
    }
    button.clicked()
}

fn scenario_menu_ui(ui: &mut Ui, session: &Session, [opens, measures]: [bool; 2], requests: &mut Vec<Request>) {
    let button = menu_ui(ui, "Scenario", Closing::AtOnce, |ui| {
        if opens && choose_file_ui(ui, "Open a file…", requests) {
            ui.close();
        }
        if measures {
            let hint = "Record something that swings or rings with the sensors of this device";
            let button = ui.button("Measure with this device…").on_hover_text(hint);
            if button.remembered("Measure with this device…").clicked() {
                requests.push(Request::Measure);
                ui.close();
            }
        }
        if opens || measures {
            ui.separator();
        }
        entries_ui(ui, BUILT_IN, requests);
        ui.menu_button("Your own equations", |ui| entries_ui(ui, EQUATIONS, requests));
        ui.separator();
        if ui.button("Copy as text").on_hover_text("The scenario as text, for a file or the command line").clicked() {
            match session.scenario().to_toml() {
                Ok(toml) => ui.ctx().copy_text(toml),
                Err(error) => requests.push(Request::Report(format!("The scenario cannot be copied: {error}."))),
            }
            ui.close();
        }
    });
    probe::remember(ui.ctx(), "Scenario", button.rect);
}

fn entries_ui(ui: &mut Ui, entries: &[BuiltIn], requests: &mut Vec<Request>) {
    for entry in entries {
        let picture = thumbnail::of_scenario(ui.ctx(), entry);
        if entry_ui(ui, entry.title, entry.description(), picture).clicked() {
            requests.push(Request::Open(*entry));
            ui.close();
        }
    }
}

fn views_menu_ui(ui: &mut Ui, layout: &ViewLayout, requests: &mut Vec<Request>) {
    let button = menu_ui(ui, "Views", Closing::Beside, |ui| {
        for arrangement in Arrangement::ALL {
            if ui.button(arrangement.name()).clicked() {
                requests.push(Request::Arrange(arrangement));
                ui.close();
            }
        }
        let shown = layout.shown();
        for (question, views) in VIEWS {
            ui.separator();
            ui.label(RichText::new(question).small().weak());
            for Tabs { name, tabs } in views {
                let of_view: Vec<ViewKind> = shown.iter().copied().filter(|kind| tabs.contains(kind)).collect();
                let row = ui.horizontal(|ui| {
                    let (rect, _) = ui.allocate_exact_size(SKETCH, egui::Sense::hover());
                    sketch(tabs[0]).paint(ui.painter(), rect, &Palette::of(ui.ctx().theme()));
                    ui.checkbox(&mut !of_view.is_empty(), *name)
                });
                let checkbox = row.inner.remembered(name);
                if checkbox.changed() {
                    let toggled = if of_view.is_empty() { &tabs[..1] } else { &of_view };
                    requests.extend(toggled.iter().map(|kind| Request::ToggleView(*kind)));
                }
            }
        }
    });
    probe::remember(ui.ctx(), "Views", button.rect);
}

fn more_menu_ui(ui: &mut Ui, session: &Session, presenting: bool, requests: &mut Vec<Request>) {
    let button = menu_ui(ui, "More", Closing::AtOnce, |ui| {
        theme_ui(ui);
        let commands = [
            ("Presenter mode", "Large type, and no bar (P)", presenting, Request::TogglePresenter),
            ("Find…", "Any setting, view, scenario, lesson, export or command (/)", false, Request::Find),
            ("List of keys", "All keys and gestures (?)", false, Request::ToggleKeys),
        ];
        for (name, hint, is_on, request) in commands {
            if ui.selectable_label(is_on, name).on_hover_text(hint).clicked() {
                requests.push(request);
                ui.close();
            }
        }
        if session.is_measured() && ui.selectable_label(false, "Forget the record").on_hover_text(FORGET).clicked() {
            requests.push(Request::ForgetRecord);
            ui.close();
        }
        if !session.has_snapshot() {
            snapshot_ui(ui, session, requests);
        }
    });
    probe::remember(ui.ctx(), "More", button.rect);
}

pub(crate) fn history_ui(ui: &mut Ui, history: History, requests: &mut Vec<Request>) {
    let undo = ("↶", "Undo", "Ctrl+Z", history.has_undo, Request::Undo);
    let redo = ("↷", "Redo", "Ctrl+Shift+Z", history.has_redo, Request::Redo);
    for (icon, name, key, possible, request) in [undo, redo] {
        let button = ui.add_enabled(possible, Button::new(RichText::new(icon).size(15.0)));
        let button = named(button.on_hover_text(format!("{name} the last change of a setting ({key})")), name);
        if button.clicked() {
            requests.push(request);
        }
    }
}

fn snapshot_ui(ui: &mut Ui, session: &Session, requests: &mut Vec<Request>) {
    let (text, hint) = if session.has_snapshot() {
        ("Swap snapshot", "Exchange the settings with those of the snapshot (X)")
    } else {
        ("Take a snapshot", "Keep these settings, to compare others with them (X)")
    };
    if named(ui.button(text).on_hover_text(hint), "Snapshot").clicked() {
        requests.push(Request::SwapSnapshot);
    }
}

fn theme_ui(ui: &mut Ui) {
    let (theme, name) = theme::other(ui.ctx());
    if ui.selectable_label(false, name).clicked() {
        ui.ctx().set_theme(theme);
        ui.close();
    }
}
