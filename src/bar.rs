//! The bar at the top: what to look at, and the transport.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Button, PopupCloseBehavior, RichText, Ui};
use kalmanscope_lessons::Lesson;

use crate::command::Command;
use crate::library;
use crate::places;
use crate::session::Session;
use crate::theme;
use crate::transport;
use crate::tutor;
use crate::views::{Arrangement, Layout, ViewKind};

/// The width from which on there is room for the program's name \[points\].
const ROOMY: f32 = 1000.0;

/// What the bar tells of.
pub(crate) struct Bar<'a> {
    pub(crate) session: &'a Session,
    pub(crate) layout: &'a Layout,
    pub(crate) lessons: &'a [Lesson],
    /// Whether the settings are shown.
    pub(crate) controls: bool,
    pub(crate) presenting: bool,
    pub(crate) narrow: bool,
}

impl Bar<'_> {
    pub(crate) fn ui(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        let Self { session, layout, lessons, controls, presenting, narrow } = *self;
        ui.horizontal_wrapped(|ui| {
            let toggle = ui.selectable_label(controls, RichText::new("☰").size(16.0)).on_hover_text("Settings (S)");
            toggle.ctx.accesskit_node_builder(toggle.id, |node| node.set_label("Settings"));
            places::remember(ui.ctx(), "Settings", toggle.rect);
            if toggle.clicked() {
                commands.push(Command::ToggleControls);
            }
            if !presenting && ui.max_rect().width() > ROOMY {
                ui.label(RichText::new("Kalmanscope").family(theme::strong()).size(17.0));
            }
            scenario_menu_ui(ui, session, commands);
            views_menu_ui(ui, layout, commands);
            tutor::menu_ui(ui, lessons, commands);
            more_menu_ui(ui, presenting, commands);
            if narrow {
                ui.end_row();
            } else {
                ui.separator();
            }
            transport::transport_ui(ui, session, narrow, commands);
        });
    }
}

fn scenario_menu_ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    ui.menu_button("Scenario", |ui| {
        for entry in library::ENTRIES {
            if ui.button(entry.name).on_hover_text(entry.description()).clicked() {
                commands.push(Command::Open(entry));
                ui.close();
            }
        }
        ui.separator();
        if ui.button("Copy as TOML").on_hover_text("For the command line, or to keep").clicked() {
            if let Ok(toml) = session.scenario().to_toml() {
                ui.ctx().copy_text(toml);
            }
            ui.close();
        }
    });
}

fn views_menu_ui(ui: &mut Ui, layout: &Layout, commands: &mut Vec<Command>) {
    // One shows and hides several: the menu stays until something else is clicked.
    let stays = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let (button, _) = MenuButton::new("Views").config(stays).ui(ui, |ui| {
        for arrangement in Arrangement::ALL {
            if ui.button(arrangement.name()).clicked() {
                commands.push(Command::Arrange(arrangement));
                ui.close();
            }
        }
        ui.separator();
        let shown = layout.shown();
        for view in ViewKind::ALL {
            let mut on = shown.contains(&view);
            let checkbox = ui.checkbox(&mut on, view.view().name());
            places::remember(ui.ctx(), view.view().name(), checkbox.rect);
            if checkbox.changed() {
                commands.push(Command::ToggleView(view));
            }
        }
    });
    places::remember(ui.ctx(), "Views", button.rect);
}

/// How it looks, and help.
fn more_menu_ui(ui: &mut Ui, presenting: bool, commands: &mut Vec<Command>) {
    theme_ui(ui);
    let mut presenter = presenting;
    let toggle = ui.toggle_value(&mut presenter, "Aa").on_hover_text("Presenter mode: large type (P)");
    toggle.ctx.accesskit_node_builder(toggle.id, |node| node.set_label("Presenter mode"));
    if toggle.clicked() {
        commands.push(Command::TogglePresenter);
    }
    let keys = ui.add(Button::new("?")).on_hover_text("List of keys (?)");
    keys.ctx.accesskit_node_builder(keys.id, |node| node.set_label("List of keys"));
    if keys.clicked() {
        commands.push(Command::ToggleKeys);
    }
}

fn theme_ui(ui: &mut Ui) {
    let dark = ui.ctx().theme() == egui::Theme::Dark;
    let (icon, name) = if dark { ("☀", "Light theme") } else { ("☾", "Dark theme") };
    let button = ui.button(RichText::new(icon).size(15.0)).on_hover_text(name);
    button.ctx.accesskit_node_builder(button.id, |node| node.set_label(name));
    if button.clicked() {
        let next = if dark { egui::Theme::Light } else { egui::Theme::Dark };
        ui.ctx().set_theme(next);
    }
}
