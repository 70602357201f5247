//! The line above the table: buttons to add the run on screen, to take in links, and to save.

use egui::{Id, ScrollArea, TextEdit, Ui};
use kalmanscope_lab::Trial;

use crate::laboratory::{Trials, trial_of};
use crate::menu::{Closing, menu_ui};
use crate::request::{Export, Request};
use crate::text::sentence;
use crate::view::ViewContext;

/// Limits the characters of the links that are pasted.
const LONGEST: usize = 2_000_000;

/// The width of the field for links \[points\].
const FIELD: f32 = 320.0;

pub(super) fn head_ui(ui: &mut Ui, context: &ViewContext<'_>, trials: &Trials, requests: &mut Vec<Request>) {
    ui.horizontal_wrapped(|ui| {
        let is_full = trials.rows().len() >= Trial::MOST;
        let full = || Err(format!("there are {} rows, and no room for more", Trial::MOST));
        let trial = if is_full { full() } else { trial_of(context.session) };
        let button = ui.add_enabled(trial.is_ok(), egui::Button::new("Add this run"));
        let button =
            button.on_hover_text("Keep frequency and damping of the run on screen, with their bands, as a row");
        match trial {
            Ok(trial) if button.clicked() => {
                let rows = trials.rows().iter().cloned().chain([trial]);
                requests.push(Request::KeepTrials(rows.collect()));
            }
            Ok(_) => {}
            Err(reason) => _ = button.on_disabled_hover_text(sentence(&format!("{reason}."))),
        }
        links_ui(ui, requests);
        if ui.add_enabled(!trials.rows().is_empty(), egui::Button::new("Save as CSV")).clicked() {
            requests.push(Request::Export(Export::Trials));
        }
        if trials.can_restore() && ui.button("Bring back").on_hover_text("The rows that were removed").clicked() {
            requests.push(Request::RestoreTrials);
        }
    });
}

/// A menu with a field for the links of a class.
fn links_ui(ui: &mut Ui, requests: &mut Vec<Request>) {
    let id = Id::unique("links of a class");
    let button = menu_ui(ui, "Links of a class…", Closing::Beside, |ui| {
        ui.set_max_width(FIELD);
        ui.label("Everybody shows this view, copies a link (key C) and sends it. Paste all of them here.");
        let mut text: String = ui.data_mut(|data| data.remove_temp(id)).unwrap_or_default();
        ScrollArea::vertical().id_salt("links").max_height(120.0).show(ui, |ui| {
            let field = TextEdit::multiline(&mut text).desired_rows(4).desired_width(FIELD).char_limit(LONGEST);
            let field = ui.add(field.hint_text("a link in each line"));
            field.ctx.accesskit_node_builder(field.id, |node| node.set_label("Links of a class"));
        });
        if ui.add_enabled(!text.trim().is_empty(), egui::Button::new("Add their trials")).clicked() {
            requests.push(Request::CollectTrials(std::mem::take(&mut text)));
            ui.close();
        }
        ui.data_mut(|data| data.insert_temp(id, text));
    });
    button.on_hover_text("Collect the trials of many people");
}
