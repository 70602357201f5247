//! The controls of the settings: each says which setting it changes.

pub(crate) mod filter;
mod highlight;
pub(crate) mod named;
pub mod number;
mod options;
mod plant;
mod record;
mod row;
mod sensors;

use std::sync::Arc;

use egui::{Button, RichText, ScrollArea, Ui};
use kalmanscope_core::Scenario;
use kalmanscope_core::setting::Change;
use kalmanscope_diagnosis::Story;
use serde::Serialize;

use crate::session::Library;
use crate::theme::{self, Palette};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PanelRequest {
    Columns,
    Equation,
    Fewer,
}

pub struct Edits<'a> {
    pub scenario: &'a Arc<Scenario>,
    pub change: Change,
}

impl Edits<'_> {
    pub fn set_other(&mut self, address: &str, before: f64, now: f64) {
        if now != before {
            self.change.set(self.scenario, address, now);
        }
    }

    pub fn put_other<T: PartialEq + Serialize>(&mut self, address: &str, before: &T, now: &T) {
        if now != before {
            self.change.put(address, now);
        }
    }
}

pub fn few_controls_ui(ui: &mut Ui, edits: &mut Edits<'_>, story: &Story, below: impl FnOnce(&mut Ui)) -> bool {
    let wanted = ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.set_max_width(ui.available_width() - ui.spacing().scroll.bar_width);
        ui.label(RichText::new("Try it").family(theme::strong()).size(14.5));
        ui.add_space(6.0);
        if !named::named_ui(ui, edits, story) && !story.sentences.is_empty() {
            ui.label(RichText::new("The text above the plots names no number to change.").weak());
        }
        let all = Button::new("All settings").min_size(egui::vec2(ui.available_width(), 30.0));
        let wanted = ui.add(all).on_hover_text("Every filter, the truth, the force and the sensors").clicked();
        below(ui);
        wanted
    });
    wanted.inner
}

pub fn controls_ui(
    ui: &mut Ui,
    edits: &mut Edits<'_>,
    library: &Library,
    palette: &Palette,
    lit: Vec<String>,
) -> Vec<PanelRequest> {
    let scenario = edits.scenario;
    highlight::set(ui, lit, scenario);
    let mut asked = Vec::new();
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        if ui
            .small_button("Fewer settings")
            .on_hover_text("Only the settings that the text above the plots names")
            .clicked()
        {
            asked.push(PanelRequest::Fewer);
        }
        // The floating scroll bar must not cover the units.
        ui.set_max_width(ui.available_width() - ui.spacing().scroll.bar_width);
        // Every field is named, so that a new one cannot be left without a control.
        let Scenario {
            seed: _,
            dt: _,
            duration: _,
            plant: _,
            force: _,
            forces: _,
            input: _,
            hold: _,
            sensors: _,
            filters,
            record,
            draw: _,
        } = &**scenario;
        // The filters come first: users tune these.
        for place in 0..filters.len() {
            filter::filter_section_ui(ui, edits, place, palette);
        }
        filter::add_filter_ui(ui, edits);
        ui.add_space(6.0);
        if record.is_some() {
            section_ui(ui, "Measured record", true, |ui| record::record_ui(ui, edits, library, &mut asked));
            ui.add_space(12.0);
            return;
        }
        section_ui(ui, "Truth", true, |ui| plant::plant_ui(ui, edits, &mut asked));
        section_ui(ui, "Force", true, |ui| highlight::highlight_ui(ui, "force", |ui| record::force_ui(ui, edits)));
        section_ui(ui, "Sensors", true, |ui| sensors::sensors_ui(ui, edits));
        section_ui(ui, "Record", false, |ui| record::general_ui(ui, edits));
        ui.add_space(12.0);
    });
    asked
}

fn section_ui(ui: &mut Ui, title: &str, open: bool, add_contents: impl FnOnce(&mut Ui)) {
    let heading = RichText::new(title).family(theme::strong()).size(14.5);
    egui::CollapsingHeader::new(heading).id_salt(title).default_open(open).show_unindented(ui, |ui| {
        add_contents(ui);
        ui.add_space(6.0);
    });
}
