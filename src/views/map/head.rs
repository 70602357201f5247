//! The line above the panels: axes, score, filters, ranges, and the progress.

use egui::{ComboBox, Grid, Ui, vec2};
use kalmanscope_core::setting::Address;
use kalmanscope_core::{Axis, Scenario, Spacing};
use kalmanscope_diagnosis::Measure;

use crate::controls::number::field_ui;
use crate::laboratory::{Laboratory, MOST, MapChoice, Survey, candidates, collide, offered, part_of, setting_name};
use crate::menu::{Closing, menu_ui};
use crate::probe::Remembered as _;
use crate::request::Request;
use crate::team::{Computer, Finding, Precision};
use crate::text::{significant, unit_in};
use crate::theme::Palette;
use crate::view::ViewContext;

const COUNTS: [usize; 4] = [32, 64, 128, 256];

const WAYS: [&str; 2] = ["across", "up"];

pub(super) fn head_ui(
    ui: &mut Ui,
    context: &ViewContext<'_>,
    laboratory: &Laboratory,
    choice: &MapChoice,
    requests: &mut Vec<Request>,
) {
    let run = context.session.run();
    let part = part_of(run.scenario(), &choice.filters());
    let keys = candidates(&part, context.session.is_measured());
    let mut next = choice.clone();
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 5.0;
        for at in [0, 1] {
            ui.weak(["→", "↑"][at]);
            axis_ui(ui, &mut next, at, &part, &keys);
        }
        measure_ui(ui, &mut next, &offered(&part, run.record()));
        filters_ui(ui, &mut next, run.scenario());
        ranges_ui(ui, &mut next, &part, laboratory.graphics().as_ref(), context.palette);
        work_ui(ui, laboratory, requests);
        computers_ui(ui, laboratory);
    });
    if &next != choice {
        requests.push(Request::ChooseMap(Box::new(next)));
    }
}

fn combo_ui(ui: &mut Ui, label: &str, text: String, width: f32, add: impl FnOnce(&mut Ui)) {
    let combo = ComboBox::from_id_salt(label).selected_text(text).width(width).height(420.0).show_ui(ui, add);
    ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label(label));
}

fn axis_ui(ui: &mut Ui, choice: &mut MapChoice, at: usize, part: &Scenario, keys: &[String]) {
    let present = choice.axes[at].key.clone();
    let other = choice.axes[1 - at].key.clone();
    combo_ui(ui, &format!("Setting {}", WAYS[at]), setting_name(&present, part), 118.0, |ui| {
        for key in keys.iter().filter(|key| **key == other || !collide(key, &other, part)) {
            if !ui.selectable_label(*key == present, setting_name(key, part)).clicked() || *key == present {
                continue;
            }
            // The other axis' setting is offered too: to choose it exchanges the axes.
            if *key == other {
                choice.axes.swap(0, 1);
            } else if let Ok(setting) = Address::parse(part, key) {
                choice.axes[at] = Axis::usual(&setting, part, choice.axes[at].count);
            }
        }
    });
}

fn measure_ui(ui: &mut Ui, choice: &mut MapChoice, offered: &[Measure]) {
    combo_ui(ui, "Score", choice.measure.name(), 150.0, |ui| {
        for measure in offered {
            ui.selectable_value(&mut choice.measure, *measure, measure.name());
        }
    });
}

fn filters_ui(ui: &mut Ui, choice: &mut MapChoice, scenario: &Scenario) {
    let name = |id: u32| {
        let filter = scenario.filters.iter().find(|filter| filter.id == id);
        filter.map_or(String::new(), |filter| filter.name.clone())
    };
    let MapChoice { filter: first, second, .. } = choice;
    combo_ui(ui, "Filter of the map", name(*first), 58.0, |ui| {
        for filter in &scenario.filters {
            if ui.selectable_label(*first == filter.id, &filter.name).clicked() {
                if *second == Some(filter.id) {
                    *second = Some(*first);
                }
                *first = filter.id;
            }
        }
    });
    if scenario.filters.len() < 2 {
        return;
    }
    let text = second.map_or_else(|| "alone".to_owned(), |id| format!("and {}", name(id)));
    combo_ui(ui, "Second filter", text, 66.0, |ui| {
        ui.selectable_value(second, None, "alone");
        for filter in scenario.filters.iter().filter(|filter| filter.id != *first) {
            ui.selectable_value(second, Some(filter.id), format!("and {}", filter.name));
        }
    });
}

fn ranges_ui(ui: &mut Ui, choice: &mut MapChoice, part: &Scenario, graphics: Option<&Finding>, palette: &Palette) {
    let [x, y] = choice.axes.each_ref().map(|axis| axis.count);
    let button = menu_ui(ui, format!("{x} × {y}"), Closing::Beside, |ui| {
        // Fields and buttons of a menu have no ground.
        ui.visuals_mut().widgets.inactive.weak_bg_fill = palette.faint;
        Grid::new("ranges of the map").spacing([8.0, 4.0]).show(ui, |ui| {
            for text in ["", "from", "to", "values", ""] {
                ui.weak(text);
            }
            ui.end_row();
            for (at, axis) in choice.axes.iter_mut().enumerate() {
                range_ui(ui, axis, WAYS[at], part);
                ui.end_row();
            }
        });
        ui.horizontal(|ui| {
            ui.weak("both");
            for count in COUNTS {
                if ui.button(format!("{count} × {count}")).clicked() {
                    choice.axes.iter_mut().for_each(|axis| axis.count = count);
                }
            }
            if ui.button("Usual ranges").clicked() {
                for axis in &mut choice.axes {
                    if let Ok(setting) = Address::parse(part, &axis.key) {
                        *axis = Axis::usual(&setting, part, axis.count);
                    }
                }
            }
        });
        // Without a graphics processor there is nothing to choose.
        if graphics == Some(&Finding::Ready) || choice.precision == Precision::Double {
            precision_ui(ui, &mut choice.precision);
        }
    });
    let button = button.on_hover_text("Ranges of the axes, and the numbers of their values");
    button.ctx.accesskit_node_builder(button.id, |node| node.set_label("Ranges of the map"));
}

fn range_ui(ui: &mut Ui, axis: &mut Axis, way: &str, part: &Scenario) {
    let before = axis.clone();
    ui.label(setting_name(&axis.key, part));
    let unit = Address::parse(part, &axis.key).map_or("", |setting| unit_in(part, setting.unit));
    let size = vec2(72.0, ui.spacing().interact_size.y);
    for (value, end) in [(&mut axis.from, "first"), (&mut axis.to, "last")] {
        let scale = value.abs().max(1e-9);
        let name = format!("{end} value {way}");
        let hint = format!("{name} {unit}");
        ui.allocate_ui(size, |ui| field_ui(ui, value, f64::NEG_INFINITY, scale, name.as_str(), &hint));
    }
    let count = ui.add(egui::DragValue::new(&mut axis.count).range(2..=MOST));
    ui.ctx().accesskit_node_builder(count.id, |node| node.set_label(format!("Values {way}")));
    let mut is_logarithmic = axis.spacing == Spacing::Logarithmic;
    let hint = "Equal ratios between the values, in place of equal differences";
    if ui.checkbox(&mut is_logarithmic, "logarithmic").on_hover_text(hint).changed() {
        axis.spacing = if is_logarithmic { Spacing::Logarithmic } else { Spacing::Linear };
        if is_logarithmic && axis.from <= 0.0 && axis.to > 0.0 {
            axis.from = axis.to / 1000.0;
        }
    }
    // Ignores half-typed, impossible ranges.
    if axis.check().is_err() || axis.from >= axis.to {
        *axis = before;
    }
}

fn precision_ui(ui: &mut Ui, precision: &mut Precision) {
    let mut is_double = *precision == Precision::Double;
    let hint = "In double precision, with the bits of a sweep on the command line; the graphics processor has single precision";
    if ui.checkbox(&mut is_double, "without the graphics processor").on_hover_text(hint).changed() {
        *precision = if is_double { Precision::Double } else { Precision::Fastest };
    }
}

fn computers_ui(ui: &mut Ui, laboratory: &Laboratory) {
    let computers = laboratory.shown().map_or(&[][..], |survey| &survey.computers);
    let named: Vec<String> = computers.iter().filter(|by| **by != Computer::Frames).map(Computer::to_string).collect();
    if !named.is_empty() {
        let text = format!("computed {}", named.join(", and "));
        ui.weak(&text).remembered(&text);
    }
    if let Some(Finding::Lost(reason)) = laboratory.graphics() {
        ui.weak("The graphics processor has failed; maps go on without it.").on_hover_text(reason);
    }
}

fn work_ui(ui: &mut Ui, laboratory: &Laboratory, requests: &mut Vec<Request>) {
    let Some(share) = laboratory.progress() else { return };
    let is_stopped = laboratory.state.is_stopped;
    let button = ui.button(if is_stopped { "Go on" } else { "Stop" });
    if button.on_hover_text(format!("{:.0} % of the cells are known", 100.0 * share)).clicked() {
        requests.push(Request::ComputeMap(is_stopped));
    }
}

const TOLD: usize = 2;

pub(super) fn sentence(survey: &Survey, measure: Measure, context: &ViewContext<'_>) -> Option<String> {
    if !survey.sheet.is_complete() {
        return None;
    }
    let filters = survey.ensemble.scenario().filters.iter().enumerate().take(TOLD);
    let told: Vec<String> = filters
        .filter_map(|(place, filter)| {
            let best = best(survey, place, measure)?;
            Some(format!("{}: {}", filter.name, of_filter(survey, place, measure, best, context)))
        })
        .collect();
    (!told.is_empty()).then(|| told.join(" "))
}

fn best(survey: &Survey, filter: usize, measure: Measure) -> Option<usize> {
    let goal = measure.info().best;
    let distances =
        (0..survey.sheet.len()).filter_map(|cell| Some((cell, goal.distance(survey.value(cell, filter, measure)?)?)));
    distances.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(cell, _)| cell)
}

fn of_filter(survey: &Survey, filter: usize, measure: Measure, best: usize, context: &ViewContext<'_>) -> String {
    let scenario = survey.ensemble.scenario();
    let values = survey.ensemble.values(best);
    let axes = survey.axes();
    let setting =
        |at: usize, value: f64| format!("{} = {}", setting_name(&axes[at].key, scenario), significant(value, 3));
    let value = survey.value(best, filter, measure).unwrap_or(f64::NAN);
    let unit = context.unit(measure.unit());
    let value = format!("{} {unit}", significant(value, 3));
    let value = value.trim_end();
    let at = [0, 1].map(|at| setting(at, values[at])).join(" and ");
    let present = survey.present(context.session.scenario());
    let here = [0, 1].map(|at| axes[at].place_of(present[at]));
    let here = match here {
        [Some(x), Some(y)] => survey.value(survey.ensemble.cell(&[x, y]), filter, measure),
        _ => None,
    };
    let here = here.map_or_else(String::new, |here| format!("; on screen it is {}", significant(here, 3)));
    format!("{} is best, {value}, at {at}{here}.", measure.name())
}
