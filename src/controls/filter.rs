//! One filter: its initial belief, its noise, its memory and its colour.

use egui::collapsing_header::CollapsingState;
use egui::{ComboBox, Grid, Popup, PopupCloseBehavior, Response, RichText, Sense, Ui, Vec2, WidgetInfo};
use kalmanscope_core::Length;
use kalmanscope_core::setting::{
    Allowed, CHANGES, Entry, FADING, INITIAL_MEAN, INITIAL_STD, MEMORY, PROCESS_STD, SENSOR_STD, TableInfo,
};
use kalmanscope_core::{Channel, FilterColor, FilterKind, FilterSettings, InputKind, Scenario};

use super::Edits;
use super::highlight::highlight_ui;
use super::number::{Named, REMARK, field_ui, std_field_ui, tell_hertz};
use super::options::options_ui;
use super::row::{filter_row_ui, list_ui};
use crate::text::significant;
use crate::theme;
use crate::theme::Palette;
use crate::widgets::named;

pub(super) fn filter_section_ui(ui: &mut Ui, edits: &mut Edits<'_>, place: usize, palette: &Palette) {
    let scenario = edits.scenario;
    let filter = &scenario.filters[place];
    // By id: at a place, the section of another filter would open when one is removed.
    let id = ui.make_persistent_id(("filter", filter.id));
    let state = CollapsingState::load_with_default_open(ui.ctx(), id, place == 0);
    let open = state.is_open();
    let (mut match_truth, mut duplicate, mut remove) = (false, false, false);
    let several = scenario.filters.len();
    let filters = scenario.filters.iter().enumerate();
    let others: Vec<String> = filters.filter(|(i, _)| *i != place).map(|(_, f)| f.name.clone()).collect();
    state
        .show_header(ui, |ui| {
            color_ui(ui, filter, palette, edits);
            let name = RichText::new(&filter.name).family(theme::strong()).size(14.5);
            // A folded section hides its lit settings: its name is lit instead.
            if open {
                ui.label(name);
            } else {
                highlight_ui(ui, &format!("filters#{}", filter.id), |ui| ui.label(name));
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                kind_ui(ui, filter, place, &others, edits);
            });
        })
        .body_unindented(|ui| {
            for info in MEMORY {
                filter_row_ui(ui, info, filter, edits);
                if *info == FADING {
                    half_life_ui(ui, filter.fading, scenario.dt);
                }
            }
            changes_ui(ui, filter, edits);
            belief_ui(ui, filter, edits);
            ui.add_space(2.0);
            options_ui(ui, filter, edits);
            ui.add_space(2.0);
            ui.horizontal_wrapped(|ui| {
                let hint =
                    "Set R to the sensors' true noise, and Q to the effect of disturbance and changing parameters in a step";
                match_truth = ui.button("Match the truth").on_hover_text(hint).clicked();
                let small = |ui: &mut Ui, text: &str, enabled: bool| {
                    let button = named(ui.add_enabled(enabled, egui::Button::new(text)), format!("{text} {}", filter.name));
                    button.clicked()
                };
                duplicate = small(ui, "Duplicate", several < MOST_FILTERS);
                remove = small(ui, "Remove", true);
            });
            highlight_ui(ui, &filter.address("name"), |ui| rename_ui(ui, filter, &others, edits));
            ui.add_space(6.0);
        });
    if duplicate {
        let id = scenario.free_filter_id();
        let (color, name) = (free_color(scenario, id), scenario.free_filter_name(&filter.name));
        edits.change.put_filter(place + 1, FilterSettings { id, color, name, ..filter.clone() });
    }
    if remove {
        edits.change.remove_filter(filter.id);
    }
    if match_truth {
        let (sensor_std, process_std) = scenario.true_noise_for(filter);
        edits.change.put_filter(place, FilterSettings { sensor_std, process_std, ..filter.clone() });
    }
}

fn changes_ui(ui: &mut Ui, filter: &FilterSettings, edits: &mut Edits<'_>) {
    let off = FilterSettings::default();
    let now = CHANGES.iter().position(|(row, ..)| (row.get)(filter) != (row.get)(&off));
    let mut chosen = now;
    let summary = now.map_or("still", |at| CHANGES[at].1);
    let (hint, name) = ("How the filter expects its parameters to change", format!("{} parameters", filter.name));
    let mut list = |ui: &mut Ui| {
        list_ui(ui, ("parameters", hint), summary, &name, PopupCloseBehavior::CloseOnClick, &mut |ui| {
            // The answers exclude each other: whether one serves is asked of a filter without the others.
            let mut still = filter.clone();
            CHANGES.iter().for_each(|(row, ..)| (row.set)(&mut still, (row.get)(&off)));
            ui.selectable_value(&mut chosen, None, "still").on_hover_text("They stay as they are");
            for (at, (row, answer, _)) in CHANGES.iter().enumerate() {
                let serves = (row.serves)(&still, &edits.scenario.plant.kind);
                let answer = ui.add_enabled_ui(serves, |ui| ui.selectable_value(&mut chosen, Some(at), *answer));
                answer.inner.on_hover_text(row.hint);
            }
        });
    };
    let [walk, jump, scales] = CHANGES.map(|(row, ..)| filter.address(row.key));
    highlight_ui(ui, &walk, |ui| highlight_ui(ui, &jump, |ui| highlight_ui(ui, &scales, |ui| list(ui))));
    let row_of = |place: Option<usize>| place.and_then(|at| CHANGES.get(at));
    if chosen != now {
        let none = row_of(now).map(|(row, ..)| (row, (row.get)(&off)));
        let other = row_of(chosen).map(|(row, _, value)| (row, *value));
        for (row, value) in none.into_iter().chain(other) {
            edits.set_other(&filter.address(row.key), (row.get)(filter), value);
        }
    } else if let Some((row, ..)) = row_of(now).filter(|(row, ..)| row.allowed != Allowed::Flag) {
        filter_row_ui(ui, row, filter, edits);
    }
}

pub(super) fn add_filter_ui(ui: &mut Ui, edits: &mut Edits<'_>) {
    let scenario = edits.scenario;
    let room = scenario.filters.len() < MOST_FILTERS;
    if ui.add_enabled(room, egui::Button::new("Add a filter")).clicked() {
        let kind = FilterKind::EKF;
        let sensor_std = scenario.true_sensor_std();
        let name = scenario.free_filter_name(kind.name());
        let id = scenario.free_filter_id();
        let color = free_color(scenario, id);
        let filter = FilterSettings { id, name, kind, color, sensor_std, ..FilterSettings::default() };
        edits.change.put_filter(scenario.filters.len(), filter);
    }
}

// As many as there are colours that readers with any colour vision can distinguish.
const MOST_FILTERS: usize = 6;

fn rename_ui(ui: &mut Ui, filter: &FilterSettings, others: &[String], edits: &mut Edits<'_>) {
    ui.horizontal(|ui| {
        ui.label("name");
        let mut name = filter.name.clone();
        let field = ui.add(egui::TextEdit::singleline(&mut name).desired_width(150.0).char_limit(40));
        let field = named(field, format!("Name of {}", filter.name));
        if field.changed() && !name.trim().is_empty() && !others.contains(&name) {
            edits.change.put(filter.address("name"), &name);
        }
    });
}

fn kind_ui(ui: &mut Ui, filter: &FilterSettings, place: usize, others: &[String], edits: &mut Edits<'_>) {
    let before = filter.kind;
    let mut chosen = before;
    let combo =
        ComboBox::from_id_salt(("kind", filter.id)).selected_text(before.name()).width(64.0).show_ui(ui, |ui| {
            for kind in FilterKind::ALL {
                ui.selectable_value(&mut chosen, kind, kind.name());
            }
        });
    named(combo.response, format!("Kind of filter {}", place + 1));
    // A name that is that of the kind follows the kind, but stays unique.
    let numbered = |kind: FilterKind| format!("{} {}", kind.name(), place + 1);
    if chosen == before {
        return;
    }
    edits.change.put(filter.address("kind"), &chosen);
    if filter.name == before.name() || filter.name == numbered(before) {
        let name = chosen.name().to_owned();
        let name = if others.contains(&name) { numbered(chosen) } else { name };
        edits.change.put(filter.address("name"), &name);
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

const SYMBOL_WIDTH: f32 = 22.0;
const UNIT_WIDTH: f32 = 36.0;

pub(super) fn belief_ui(ui: &mut Ui, filter: &FilterSettings, edits: &mut Edits<'_>) {
    let Scenario { plant, sensors, record, .. } = &**edits.scenario;
    let length = Length::of(record.as_ref());
    let channels = filter.model(&plant.kind, InputKind::Force).channels().to_vec();
    let spacing = ui.spacing().item_spacing.x;
    let column = ((ui.available_width() - SYMBOL_WIDTH - UNIT_WIDTH - 4.0 * spacing) / 3.0).max(36.0);
    let cell = |ui: &mut Ui, enabled: bool, add: &mut dyn FnMut(&mut Ui)| {
        ui.allocate_ui(Vec2::new(column, ui.spacing().interact_size.y), |ui| {
            ui.set_width(column);
            ui.add_enabled_ui(enabled, |ui| add(ui));
        });
    };
    let heading = |ui: &mut Ui, text: &str, hint: &str| {
        ui.label(RichText::new(text).small().weak()).on_hover_text(hint);
    };

    Grid::new(("belief", filter.id)).num_columns(5).min_col_width(0.0).spacing(Vec2::new(spacing, 4.0)).show(
        ui,
        |ui| {
            ui.label("");
            heading(ui, "initial guess", "Mean of the initial belief");
            heading(
                ui,
                "± σ of guess",
                "Standard deviation of the initial belief: how sure the filter is of its guess",
            );
            heading(ui, "√Q per step", "Standard deviation of the model's error in one step");
            ui.end_row();
            for &channel in &channels {
                // The parameters of a KF are known and have no uncertainty to set.
                let is_known = filter.knows(channel);
                ui.label(channel.symbol()).on_hover_text(channel.name());
                for (table, scale) in [(&INITIAL_MEAN, 1.0), (&INITIAL_STD, 10.0), (&PROCESS_STD, 1.0)] {
                    let scale = scale * self::scale(channel);
                    cell(ui, !is_known || *table == INITIAL_MEAN, &mut |ui| {
                        entry_ui(ui, filter, table, Entry::Channel(channel), scale, edits);
                    });
                }
                let unit = unit_ui(ui, length.in_place_of(channel.unit()));
                tell_hertz(unit, filter.initial_mean[channel], channel.unit(), "The guess is");
                ui.end_row();
            }
            for quantity in sensors.iter().map(|sensor| sensor.measures) {
                ui.label(quantity.symbol()).on_hover_text(format!("{} sensor", quantity.key()));
                ui.label("");
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    let symbol = RichText::new(SENSOR_STD.symbol).small().weak();
                    ui.label(symbol).on_hover_text("The noise that the filter assumes");
                });
                cell(ui, true, &mut |ui| entry_ui(ui, filter, &SENSOR_STD, Entry::Sensor(quantity), 10.0, edits));
                unit_ui(ui, length.in_place_of(quantity.unit()));
                ui.end_row();
            }
        },
    );
}

fn entry_ui(ui: &mut Ui, filter: &FilterSettings, table: &TableInfo, entry: Entry, scale: f64, edits: &mut Edits<'_>) {
    let text = format!("{} {} of {}", filter.name, table.name, entry.name());
    let key = filter.address(&format!("{}.{}", table.key, entry.key()));
    let name = Named { text: &text, key: &key };
    let Some(before) = table.get(filter, entry, &edits.scenario.sensors) else { return };
    let mut number = before;
    highlight_ui(ui, &key, |ui| {
        if table.factor.is_some() {
            std_field_ui(ui, &mut number, table.allowed.least(), scale, name, table.hint);
        } else {
            field_ui(ui, &mut number, table.allowed.least(), scale, name, table.hint);
        }
    });
    edits.set_other(&key, before, number);
}

/// A unit, cut where it is too long: a row that is wider than the panel would make the panel grow.
fn unit_ui(ui: &mut Ui, unit: &str) -> Response {
    ui.allocate_ui(Vec2::new(UNIT_WIDTH, ui.spacing().interact_size.y), |ui| {
        ui.set_width(UNIT_WIDTH);
        ui.add(egui::Label::new(RichText::new(unit).weak()).truncate())
    })
    .inner
}

fn scale(channel: Channel) -> f64 {
    let usual = channel.usual();
    if usual.std > 0.0 { usual.std } else { usual.mean.abs() }
}

pub(super) fn color_ui(ui: &mut Ui, filter: &FilterSettings, palette: &Palette, edits: &mut Edits<'_>) {
    let color = color_of(filter);
    let label = format!("Colour of {}", filter.name);
    let dot = dot_ui(ui, palette.shade(color), &label, false).on_hover_text("Choose another colour");
    let chosen = Popup::menu(&dot).show(|ui| {
        ui.horizontal(|ui| {
            let one = |ui: &mut Ui, choice: FilterColor| {
                let dot = dot_ui(ui, palette.shade(choice), choice.name(), choice == color);
                dot.on_hover_text(choice.name()).clicked()
            };
            FilterColor::ALL.into_iter().filter(|&choice| one(ui, choice)).last()
        })
        .inner
    });
    if let Some(choice) = chosen.and_then(|response| response.inner) {
        edits.change.put(filter.address("color"), &choice);
    }
}

pub(super) fn free_color(scenario: &Scenario, id: u32) -> Option<FilterColor> {
    let taken: Vec<FilterColor> = scenario.filters.iter().map(color_of).collect();
    if taken.contains(&FilterColor::of(id)) {
        FilterColor::ALL.into_iter().find(|color| !taken.contains(color))
    } else {
        None
    }
}

pub(crate) fn color_of(filter: &FilterSettings) -> FilterColor {
    filter.color.unwrap_or(FilterColor::of(filter.id))
}

fn dot_ui(ui: &mut Ui, color: egui::Color32, label: &str, ringed: bool) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(18.0), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, label));
    let radius = if response.hovered() || response.has_focus() { 7.0 } else { 5.5 };
    ui.painter().circle_filled(rect.center(), radius, color);
    if ringed {
        ui.painter().circle_stroke(rect.center(), 8.0, egui::Stroke::new(1.5, color));
    }
    response
}
