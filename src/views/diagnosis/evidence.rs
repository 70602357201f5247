//! The results of the tests of a filter, each as a bar and a sentence.

use std::sync::Arc;

use egui::{Color32, DragValue, Grid, Label, Rect, RichText, Sense, Stroke, Ui, Vec2};
use kalmanscope_core::setting::{Address, PROCESS_STD, SENSOR_STD};
use kalmanscope_core::{Estimates, FilterSettings, Scenario};
use kalmanscope_diagnosis::{Evidence, Remedy};

use crate::request::Request;
use crate::session::Attempt;
use crate::text::{fixed, sentence, significant};
use crate::theme::Palette;
use crate::view::ViewContext;

const BAR: Vec2 = Vec2::new(64.0, 9.0);

pub(super) fn evidence_ui(ui: &mut Ui, evidence: &[Evidence], color: Color32, palette: &Palette) {
    let title = RichText::new("Evidence").small().weak();
    egui::CollapsingHeader::new(title).show_unindented(ui, |ui| {
        all_ui(ui, evidence, color, palette);
    });
}

fn all_ui(ui: &mut Ui, evidence: &[Evidence], color: Color32, palette: &Palette) {
    let mut sorted: Vec<&Evidence> = evidence.iter().filter(|one| !one.sentence.is_empty()).collect();
    sorted.sort_by(|a, b| b.counts.cmp(&a.counts).then(b.effect.total_cmp(&a.effect)));
    let counting = sorted.iter().filter(|one| one.counts).count();
    for (i, one) in sorted[..counting].iter().enumerate() {
        ui.push_id(i, |ui| one_ui(ui, one, color, palette));
    }
    let rest = &sorted[counting..];
    if rest.is_empty() {
        return;
    }
    let title = format!("{} other results", rest.len());
    egui::CollapsingHeader::new(RichText::new(title).small().weak()).id_salt("rest").show(ui, |ui| {
        for (i, one) in rest.iter().enumerate() {
            ui.push_id(counting + i, |ui| one_ui(ui, one, palette.weak, palette));
        }
    });
}

fn one_ui(ui: &mut Ui, one: &Evidence, color: Color32, palette: &Palette) {
    let id = ui.scope_id().with(("open", one.test.name));
    let mut open = ui.data(|data| data.get_temp::<bool>(id)).unwrap_or(false);
    ui.horizontal_top(|ui| {
        bar_ui(ui, one.effect, color, palette);
        ui.vertical(|ui| {
            let text = format!("{} {}", sentence(&one.sentence), if open { "▾" } else { "▸" });
            let title = ui.add(Label::new(text).wrap().selectable(false).sense(Sense::click()));
            open ^= title.clicked();
            title.on_hover_ui(|ui| {
                ui.set_max_width(380.0);
                ui.label(format!("How to read it: {}.", one.test.reading));
            });
            if open {
                let test = one.test;
                let numbers = format!("statistic {}, {}", significant(one.statistic, 3), chance(one.p_value));
                for line in [
                    format!("How to read it: {}.", test.reading),
                    format!("Effect: {} times what matters.", significant(one.effect, 2)),
                    format!("{}: {}; {numbers}.", sentence(test.name), test.statistic),
                    format!("If the filter is right: {}.", test.distribution),
                    format!("Source: {}.", test.source),
                ] {
                    ui.add(Label::new(RichText::new(line).small().color(palette.weak)).wrap());
                }
            }
        });
    });
    ui.data_mut(|data| data.insert_temp(id, open));
}

fn chance(p_value: f64) -> String {
    match p_value {
        p if p <= 0.0 => "no chance (p = 0)".to_owned(),
        p if p < 1e-4 => format!("p = {p:.0e}"),
        p => format!("p = {}", significant(p, 2)),
    }
}

fn bar_ui(ui: &mut Ui, effect: f64, color: Color32, palette: &Palette) {
    let (rect, response) = ui.allocate_exact_size(Vec2::new(BAR.x, 17.0), Sense::hover());
    let rect = Rect::from_center_size(rect.center(), BAR);
    // An effect that just matters fills half of the bar, and one of any size fits in.
    let share = if effect.is_finite() { effect / (1.0 + effect) } else { 1.0 };
    let filled = Rect::from_min_size(rect.min, Vec2::new(BAR.x * share.clamp(0.0, 1.0) as f32, BAR.y));
    ui.painter().rect_filled(rect, 1.0, palette.faint);
    ui.painter().rect_filled(filled, 1.0, color.gamma_multiply(0.75));
    ui.painter().vline(rect.center().x, rect.expand(2.0).y_range(), Stroke::new(1.0, palette.text));
    response.on_hover_text(format!("{} times the effect that matters, at the line", significant(effect, 2)));
}

pub(super) fn estimates_ui(ui: &mut Ui, context: &ViewContext<'_>, place: usize, estimates: &Estimates) {
    let Some(last) = estimates.len().checked_sub(1) else { return };
    let diagnostics = context.session.diagnostics().get(place);
    Grid::new(("numbers", estimates.id())).num_columns(3).spacing([10.0, 2.0]).show(ui, |ui| {
        for (at, &channel) in estimates.channels().iter().enumerate() {
            let std = estimates.std(last, at);
            if !channel.is_parameter() || (std == 0.0 && estimates.initial_std(at) == 0.0) {
                continue;
            }
            let decimals = channel.usual().decimals;
            ui.label(channel.symbol()).on_hover_text(channel.name());
            let mean = fixed(estimates.canonical_mean(last, at), decimals);
            let unit = context.unit(channel.unit());
            ui.label(format!("{mean} ± {} {unit}", significant(2.0 * std, 2)).trim_end());
            let error = diagnostics.and_then(|diagnostics| diagnostics.error(channel));
            ui.weak(error.map_or(String::new(), |error| format!("off by {}", significant(error, 2))));
            ui.end_row();
        }
    });
}

pub(super) fn settings_ui(ui: &mut Ui, context: &ViewContext<'_>, id: u32, requests: &mut Vec<Request>) {
    let scenario = context.session.scenario();
    let Some(filter) = scenario.filters.iter().find(|filter| filter.id == id) else { return };
    Grid::new(("edits", id)).num_columns(4).spacing([8.0, 4.0]).show(ui, |ui| {
        for (place, key) in keys(filter, scenario).into_iter().enumerate() {
            if place > 0 && place.is_multiple_of(2) {
                ui.end_row();
            }
            let Ok(address) = Address::parse(scenario, &filter.address(&key)) else { continue };
            let label: &str = if key == "fading" { "λ" } else { &address.name };
            ui.label(RichText::new(label).weak());
            let mut value = address.get(scenario);
            let step = if key == "fading" { 0.001 } else { 0.02 * value.abs().max(1e-9) };
            let number = DragValue::new(&mut value).speed(step).range(0.0..=f64::MAX).clamp_existing_to_range(false);
            let number = ui.add(number.custom_formatter(|value, _| significant(value, 4)));
            let name = format!("{label} of {}, in the diagnosis", filter.name);
            number.ctx.accesskit_node_builder(number.id, |node| node.set_label(name));
            if number.changed() {
                requests.push(Request::set(address, value));
            }
        }
    });
}

fn keys(filter: &FilterSettings, scenario: &Scenario) -> Vec<String> {
    let model = filter.model(&scenario.plant.kind, scenario.input);
    let parameters = model.channels().iter().filter(|channel| channel.is_parameter() && !filter.knows(**channel));
    let entries = parameters.map(|channel| format!("{}.{}", PROCESS_STD.key, channel.key()));
    let sensors = scenario.sensors.iter().map(|sensor| format!("{}.{}", SENSOR_STD.key, sensor.measures.key()));
    std::iter::once("fading".to_owned()).chain(entries).chain(sensors).collect()
}

#[derive(Clone)]
struct RemedyRows {
    picture: u64,
    remedies: Arc<Vec<Remedy>>,
}

/// The remedies in order, or, while the pointer is on the view, the rows of the last frame, then new ones.
pub(super) fn on_screen(ui: &Ui, attempt: &Attempt, is_held: bool) -> Arc<Vec<Remedy>> {
    let id = ui.scope_id().with("rows of causes");
    let before = ui.data(|data| data.get_temp::<RemedyRows>(id));
    // Rows of another picture would offer changes of settings that are no longer there.
    let before = before.filter(|rows| is_held && rows.picture == attempt.picture());
    let remedies = match before {
        Some(before) => with_new(before.remedies, &attempt.remedies),
        None => Arc::new(attempt.remedies.to_vec()),
    };
    let rows = RemedyRows { picture: attempt.picture(), remedies: Arc::clone(&remedies) };
    ui.data_mut(|data| data.insert_temp(id, rows));
    remedies
}

pub(super) fn is_in_order(rows: &[Remedy], attempt: &Attempt) -> bool {
    let same = |(row, remedy): (&Remedy, &Remedy)| row.edits == remedy.edits && key(row) == key(remedy);
    rows.len() == attempt.remedies.len() && rows.iter().zip(&attempt.remedies).all(same)
}

fn with_new(mut rows: Arc<Vec<Remedy>>, remedies: &[Remedy]) -> Arc<Vec<Remedy>> {
    for remedy in remedies {
        if rows.iter().all(|row| key(row) != key(remedy)) {
            Arc::make_mut(&mut rows).push(remedy.clone());
        }
    }
    rows
}

fn key(remedy: &Remedy) -> &'static str {
    remedy.first.cause.key
}
