//! One filter.

use egui::collapsing_header::CollapsingState;
use egui::{ComboBox, RichText, Ui};
use kalmanscope_core::import::Length;
use kalmanscope_core::setting::{FADING, MEMORY};
use kalmanscope_core::{FilterKind, FilterSettings, PlantKind, Scenario};

use super::belief::belief_ui;
use super::color::{color_ui, free_color};
use super::lit::lit;
use super::number::REMARK;
use super::options::options_ui;
use super::row::filter_row_ui;
use crate::text::significant;
use crate::theme::{self, Palette};

pub(super) fn filter_section(ui: &mut Ui, scenario: &mut Scenario, place: usize, palette: &Palette) {
    let id = ui.make_persistent_id(("filter", scenario.filters[place].id));
    let state = CollapsingState::load_with_default_open(ui.ctx(), id, place == 0);
    let open = state.is_open();
    let (mut match_truth, mut duplicate, mut remove) = (false, false, false);
    let several = scenario.filters.len();
    let filters = scenario.filters.iter().enumerate();
    let others: Vec<String> = filters.filter(|(i, _)| *i != place).map(|(_, f)| f.name.clone()).collect();
    state
        .show_header(ui, |ui| {
            let filter = &mut scenario.filters[place];
            color_ui(ui, filter, palette);
            let name = RichText::new(&filter.name).family(theme::strong()).size(14.5);
            // A folded section hides its lit settings: its name is lit instead.
            if open {
                ui.label(name);
            } else {
                lit(ui, &format!("filters#{}", filter.id), |ui| ui.label(name));
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| kind_ui(ui, filter, place, &others));
        })
        .body_unindented(|ui| {
            let Scenario { dt, plant, sensors, filters, record, .. } = scenario;
            let length = Length::of(record.as_ref());
            let filter = &mut filters[place];
            memory_ui(ui, filter, plant.kind, *dt);
            belief_ui(ui, filter, sensors, plant.kind, length);
            ui.add_space(2.0);
            options_ui(ui, filter, plant.kind, sensors, length);
            ui.add_space(2.0);
            ui.horizontal_wrapped(|ui| {
                let hint =
                    "Set R to the sensors' true noise, and Q to the effect of disturbance and changing parameters in a step";
                match_truth = ui.button("Match the truth").on_hover_text(hint).clicked();
                let small = |ui: &mut Ui, text: &str, enabled: bool| {
                    let button = ui.add_enabled(enabled, egui::Button::new(text));
                    button.ctx.accesskit_node_builder(button.id, |node| {
                        node.set_label(format!("{text} {}", filter.name));
                    });
                    button.clicked()
                };
                duplicate = small(ui, "Duplicate", several < MOST_FILTERS);
                remove = small(ui, "Remove", true);
            });
            lit(ui, &filter.address("name"), |ui| rename_ui(ui, filter, &others));
            ui.add_space(6.0);
        });
    if duplicate {
        let id = scenario.free_filter_id();
        let color = free_color(scenario, id);
        let mut copy = FilterSettings { id, color, ..scenario.filters[place].clone() };
        copy.name = scenario.free_filter_name(&copy.name);
        scenario.filters.insert(place + 1, copy);
    }
    if remove {
        scenario.filters.remove(place);
        return;
    }
    if match_truth {
        let (sensor_std, process_std) = scenario.true_noise_for(&scenario.filters[place]);
        let filter = &mut scenario.filters[place];
        filter.sensor_std = sensor_std;
        filter.process_std = process_std;
    }
}

pub(super) fn add_filter_ui(ui: &mut Ui, scenario: &mut Scenario) {
    let room = scenario.filters.len() < MOST_FILTERS;
    if ui.add_enabled(room, egui::Button::new("Add a filter")).clicked() {
        let kind = FilterKind::EKF;
        let sensor_std = scenario.true_sensor_std();
        let name = scenario.free_filter_name(kind.name());
        let id = scenario.free_filter_id();
        let color = free_color(scenario, id);
        scenario.filters.push(FilterSettings { id, name, kind, color, sensor_std, ..FilterSettings::default() });
    }
}

/// Limits the filters to the number of distinguishable colours.
const MOST_FILTERS: usize = 6;

fn rename_ui(ui: &mut Ui, filter: &mut FilterSettings, others: &[String]) {
    ui.horizontal(|ui| {
        ui.label("name");
        let mut name = filter.name.clone();
        let field = ui.add(egui::TextEdit::singleline(&mut name).desired_width(150.0).char_limit(40));
        field.ctx.accesskit_node_builder(field.id, |node| node.set_label(format!("Name of {}", filter.name)));
        if field.changed() && !name.trim().is_empty() && !others.contains(&name) {
            filter.name = name;
        }
    });
}

fn kind_ui(ui: &mut Ui, filter: &mut FilterSettings, place: usize, others: &[String]) {
    let before = filter.kind;
    let combo =
        ComboBox::from_id_salt(("kind", filter.id)).selected_text(before.name()).width(64.0).show_ui(ui, |ui| {
            for kind in FilterKind::ALL {
                ui.selectable_value(&mut filter.kind, kind, kind.name());
            }
        });
    ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label(format!("Kind of filter {}", place + 1)));
    // A name that is that of the kind follows the kind, but stays unique.
    let numbered = |kind: FilterKind| format!("{} {}", kind.name(), place + 1);
    if filter.kind != before && (filter.name == before.name() || filter.name == numbered(before)) {
        let name = filter.kind.name().to_owned();
        filter.name = if others.contains(&name) { numbered(filter.kind) } else { name };
    }
}

fn memory_ui(ui: &mut Ui, filter: &mut FilterSettings, truth: PlantKind, dt: f64) {
    for info in MEMORY {
        filter_row_ui(ui, info, filter, truth);
        if *info == FADING {
            half_life_ui(ui, filter.fading, dt);
        }
    }
}

fn half_life_ui(ui: &mut Ui, fading: f64, dt: f64) {
    let memory = if fading > 1.0 {
        let samples = std::f64::consts::LN_2 / fading.ln();
        format!("half-life {} s, {} samples", significant(samples * dt, 3), significant(samples, 3))
    } else {
        "remembers everything".to_owned()
    };
    ui.horizontal(|ui| {
        ui.add_space(REMARK);
        let hint = "Memory half-life: the time after which a measurement counts half";
        ui.add(egui::Label::new(RichText::new(memory).small()).truncate()).on_hover_text(hint);
    });
}
