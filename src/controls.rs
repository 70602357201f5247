//! The settings, of which each writes to a copy of the scenario.

pub(crate) mod filter;
mod lit;
pub(crate) mod named;
pub mod number;
mod options;
mod plant;
mod record;
mod row;
mod sensors;

use egui::{Button, RichText, ScrollArea, Ui};
use kalmanscope_core::{Scenario, Story};

use crate::session::Library;
use crate::theme::{self, Palette};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PanelRequest {
    Columns,
    Equation,
    Fewer,
}

pub fn few_controls_ui(ui: &mut Ui, scenario: &mut Scenario, story: &Story) -> bool {
    let wanted = ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.set_max_width(ui.available_width() - ui.spacing().scroll.bar_width);
        ui.label(RichText::new("Try it").family(theme::strong()).size(14.5));
        ui.add_space(6.0);
        if !named::named_ui(ui, scenario, story) && !story.sentences.is_empty() {
            ui.label(RichText::new("The sentence above the plots names no number to change.").weak());
        }
        let all = Button::new("All settings").min_size(egui::vec2(ui.available_width(), 30.0));
        ui.add(all).on_hover_text("Every filter, the truth, the force and the sensors").clicked()
    });
    wanted.inner
}

pub fn controls_ui(
    ui: &mut Ui,
    scenario: &mut Scenario,
    library: &Library,
    palette: &Palette,
    lit: Vec<String>,
) -> Vec<PanelRequest> {
    lit::light(ui, lit, scenario);
    let mut asked = Vec::new();
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        if ui
            .small_button("Fewer settings")
            .on_hover_text("Only those that the sentence above the plots names")
            .clicked()
        {
            asked.push(PanelRequest::Fewer);
        }
        // The floating scroll bar must not cover the units.
        ui.set_max_width(ui.available_width() - ui.spacing().scroll.bar_width);
        let Scenario {
            seed: _,
            dt: _,
            duration: _,
            plant: _,
            force: _,
            input: _,
            hold: _,
            sensors: _,
            filters,
            record: _,
            draw: _,
        } = scenario;
        let filters = filters.len();
        // The filters come first: users tune these.
        for place in 0..filters {
            // A filter may have been removed in this frame.
            if place < scenario.filters.len() {
                filter::filter_section(ui, scenario, place, palette);
            }
        }
        filter::add_filter_ui(ui, scenario);
        ui.add_space(6.0);
        if scenario.record.is_some() {
            section(ui, "Measured record", true, |ui| record::record_ui(ui, scenario, library, &mut asked));
            ui.add_space(12.0);
            return;
        }
        section(ui, "Truth", true, |ui| plant::plant_ui(ui, scenario, &mut asked));
        section(ui, "Force", true, |ui| lit::lit(ui, "force", |ui| record::force_ui(ui, scenario)));
        section(ui, "Sensors", true, |ui| sensors::sensors_ui(ui, scenario));
        section(ui, "Record", false, |ui| record::general_ui(ui, scenario));
        ui.add_space(12.0);
    });
    asked
}

fn section(ui: &mut Ui, title: &str, open: bool, add_contents: impl FnOnce(&mut Ui)) {
    let heading = RichText::new(title).family(theme::strong()).size(14.5);
    egui::CollapsingHeader::new(heading).id_salt(title).default_open(open).show_unindented(ui, |ui| {
        add_contents(ui);
        ui.add_space(6.0);
    });
}
