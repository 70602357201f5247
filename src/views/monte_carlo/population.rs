//! The numbers drawn for each seed, in a popup: the members of a population.

use std::collections::BTreeMap;

use egui::{Grid, ScrollArea, Ui, vec2};
use kalmanscope_core::Scenario;
use kalmanscope_core::scenario::{Law, is_drawable};
use kalmanscope_core::setting::{Address, Change};

use crate::controls::number::field;
use crate::laboratory::{candidates, setting_name};
use crate::menu::{Closing, menu_ui};
use crate::request::Request;
use crate::text::{significant, unit_in};
use crate::view::ViewContext;

const SHARE: f64 = 0.2;

/// The width of a window below which a row does not fit into it \[points\].
const NARROW: f32 = 620.0;

/// The width of a number's field \[points\].
const FIELD: f32 = 72.0;

pub(super) fn population_ui(ui: &mut Ui, context: &ViewContext<'_>, requests: &mut Vec<Request>) {
    let scenario = context.session.scenario();
    if context.session.is_measured() {
        return;
    }
    let mut edited = None;
    let text = match scenario.draw.len() {
        0 => "One truth".to_owned(),
        1 => "1 drawn number".to_owned(),
        several => format!("{several} drawn numbers"),
    };
    let button = menu_ui(ui, text, Closing::Beside, |ui| {
        let laws = edited.insert(scenario.draw.clone());
        ui.visuals_mut().widgets.inactive.weak_bg_fill = context.palette.faint;
        if scenario.draw.is_empty() {
            ui.weak("All seeds have the numbers of the scenario, with other noise. A number that is drawn is another one for each seed.");
        } else {
            Grid::new("drawn numbers").spacing([8.0, 4.0]).show(ui, |ui| {
                for key in scenario.draw.keys() {
                    law_ui(ui, scenario, laws, key);
                    ui.end_row();
                }
            });
        }
        add_ui(ui, scenario, laws);
    });
    let hint = "What is another number for each seed: a population in place of one truth";
    let button = button.on_hover_text(hint);
    button.ctx.accesskit_node_builder(button.id, |node| node.set_label("Drawn numbers"));
    if let Some(laws) = edited.filter(|laws| *laws != scenario.draw) {
        let mut change = Change::default();
        change.put("draw", &laws);
        requests.push(Request::Edit(change));
    }
}

type Laws = BTreeMap<String, Law>;

pub(super) fn name(key: &str, scenario: &Scenario) -> String {
    let of = scenario.filters_at(key).filter(|(places, _)| places.len() == 1 && scenario.filters.len() > 1);
    let filter = of.and_then(|(places, _)| Some(format!(", {}", scenario.filters.get(*places.first()?)?.name)));
    setting_name(key, scenario) + &filter.unwrap_or_default()
}

fn law_ui(ui: &mut Ui, scenario: &Scenario, laws: &mut Laws, key: &str) {
    let name = name(key, scenario);
    let unit = Address::parse(scenario, key).map_or("", |setting| unit_in(scenario, setting.unit()));
    let present = Address::parse(scenario, key).map_or(f64::NAN, |setting| setting.get(scenario));
    let Some(law) = laws.get_mut(key) else { return };
    ui.label(&name);
    let menu = ui.menu_button(law.info().name, |ui| {
        for other in Law::about(present, SHARE) {
            let is_this = other.info() == law.info();
            if ui.selectable_label(is_this, other.info().name).clicked() && !is_this {
                *law = other;
            }
        }
    });
    ui.ctx().accesskit_node_builder(menu.response.id, |node| node.set_label(format!("Law of {name}")));
    let is_narrow = ui.ctx().content_rect().width() < NARROW;
    let remove = |ui: &mut Ui| {
        let button = ui.small_button("✕").on_hover_text("Draw it no more");
        button.ctx.accesskit_node_builder(button.id, |node| node.set_label(format!("Draw {name} no more")));
        button.clicked()
    };
    let mut is_removed = false;
    if is_narrow {
        is_removed = remove(ui);
        ui.end_row();
    }
    let mut numbers = law.numbers();
    for (number, word) in numbers.iter_mut().zip(law.info().numbers) {
        let label = format!("{word} of {name}");
        let scale = number.abs().max(1e-9);
        let hint = if unit.is_empty() { label.clone() } else { format!("{label} [{unit}]") };
        let size = vec2(FIELD, ui.spacing().interact_size.y);
        let mut field_ui = |ui: &mut Ui, word: &str| {
            ui.weak(word);
            ui.allocate_ui(size, |ui| field(ui, number, f64::NEG_INFINITY, scale, label.as_str(), &hint));
        };
        if is_narrow {
            ui.horizontal(|ui| field_ui(ui, word.split(" of ").next().unwrap_or(word)));
        } else {
            field_ui(ui, word);
        }
    }
    // Ignores half-typed, impossible laws.
    let edited = law.with(numbers);
    if edited.problem().is_none() {
        *law = edited;
    }
    if is_removed || (!is_narrow && remove(ui)) {
        laws.remove(key);
    }
}

fn add_ui(ui: &mut Ui, scenario: &Scenario, laws: &mut Laws) {
    let taken: Vec<Address> = scenario.draw.keys().filter_map(|key| Address::parse(scenario, key).ok()).collect();
    let is_free = |key: &String| {
        Address::parse(scenario, key).is_ok_and(|setting| {
            is_drawable(&setting) && !setting.is_whole() && !taken.iter().any(|t| t.overlaps(&setting))
        })
    };
    let keys: Vec<String> = candidates(scenario, false).into_iter().filter(is_free).collect();
    let mut chosen = None;
    // A combo box would close the menu that it is in.
    ui.menu_button("Draw another number", |ui| {
        ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
            // The truth comes first, then the filters' settings.
            let (of_filters, of_truth): (Vec<&String>, Vec<&String>) =
                keys.iter().partition(|key| key.starts_with("filters"));
            for key in of_truth.into_iter().chain(of_filters) {
                if ui.button(setting_name(key, scenario)).clicked() {
                    chosen = Some(key.clone());
                }
            }
        });
    });
    let Some(setting) = chosen.and_then(|key| Address::parse(scenario, &key).ok()) else { return };
    let value = setting.get(scenario);
    let [normal, lognormal, ..] = Law::about(value, SHARE);
    // Most numbers above 0 must stay there.
    let law = if value > 0.0 { lognormal } else { normal };
    if law.problem().is_none() {
        laws.insert(setting.to_string(), law);
    }
}

pub(super) fn sentence(scenario: &Scenario) -> Option<String> {
    let one = |(key, law): (&String, &Law)| {
        let [a, b] = law.numbers().map(|number| significant(number, 4));
        format!("{} {} ({a}, {b})", name(key, scenario), law.info().name)
    };
    let all: Vec<String> = scenario.draw.iter().map(one).collect();
    (!all.is_empty()).then(|| format!("drawn: {}", all.join("; ")))
}
