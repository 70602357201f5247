//! Which sensor next: a sentence, and each sensor with its ±2σ of each parameter beside today's.

use egui::{Align, ComboBox, Grid, Layout, ProgressBar, RichText, ScrollArea, Sense, Stroke, Ui, UiBuilder, vec2};
use kalmanscope_core::{Aspect, Quantity, Scenario};
use kalmanscope_lab::next_sensor::{DURATIONS, RATES, SensorForecast, SensorRow, measurable};

use crate::controls::number::field_ui;
use crate::laboratory::{SensorChoice, Sensors};
use crate::plot::medium::Medium;
use crate::request::Request;
use crate::text::{significant, unit_in};
use crate::theme;
use crate::view::{View, ViewContext};
use crate::widgets::named;

pub(super) static VIEW: View = View {
    name: "Which sensor next",
    short: Some("Next sensor"),
    help: [
        "What each further sensor would tell about each parameter, before anything is measured.",
        "A bar is the filter's ±2σ at the end, the line that of today's sensors: by the Cramér-Rao bound along the true motion, with the filter's Q, λ and first ±σ, and the sensors' own noise.",
        "±2σ of 200 runs agrees within 10 %. Errors are smaller where λ or Q forgets what stays, and larger until an EKF has settled, or where it loses the truth.",
    ],
    ui: Some(view_ui),
    ..View::NONE
};

/// Limits the width below which the table has the chosen parameter alone \[points\].
const NARROW: f32 = 520.0;

/// The width for the names and buttons, in a narrow view too, and the limits of a bar's \[points\].
const NAMES: [f32; 2] = [330.0, 230.0];
const BAR: (f32, f32) = (104.0, 190.0);

/// The place of today's ±2σ in the width of a bar, so that worse choices have room.
const TODAY: f32 = 0.62;

fn view_ui(ui: &mut Ui, context: &ViewContext<'_>, requests: &mut Vec<Request>) -> Option<f64> {
    let sensors = &context.laboratory?.sensors;
    if let Some(problem) = sensors.problem.as_deref() {
        ui.weak(problem);
        return None;
    }
    let scenario = context.session.run().scenario();
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        if Medium::of(ui.ctx()) == Medium::Screen {
            head_ui(ui, sensors, scenario, requests);
        }
        let Some(((about, plan), forecast)) = &sensors.shown else {
            ui.weak("The sensors are being compared.");
            return;
        };
        let at = place(&sensors.choice, forecast);
        let unit = context.unit(forecast.channels[at].unit());
        let number = |two: f64| format!("{} {unit}", significant(two, 2)).trim_end().to_owned();
        let said = forecast.sentence(plan, (sensors.choice.duration, at), number);
        ui.add_space(2.0);
        ui.label(RichText::new(said).family(theme::strong()));
        table_ui(ui, context, forecast, at, requests);
        ui.add_space(2.0);
        let of = match forecast.inputs {
            1 => "one input".to_owned(),
            inputs => format!("the mean over {inputs} simulated inputs"),
        };
        let filter = about.filters.first().map_or("", |filter| &filter.name);
        ui.small(format!("±2σ at the end and its ratio to today's, by the bound with Q and λ of {filter}, {of}."));
    });
    None
}

fn place(choice: &SensorChoice, forecast: &SensorForecast) -> usize {
    let of = |parameter| forecast.channels.iter().position(|channel| *channel == parameter);
    choice.parameter.and_then(of).unwrap_or(0)
}

fn head_ui(ui: &mut Ui, sensors: &Sensors, scenario: &Scenario, requests: &mut Vec<Request>) {
    let mut next = sensors.choice.clone();
    ui.set_max_width(ui.clip_rect().width().min(ui.available_width()));
    ui.horizontal_wrapped(|ui| {
        if scenario.filters.len() > 1 {
            let filters = scenario.filters.iter().map(|filter| (Some(filter.id), filter.name.clone()));
            next.filter = menu_ui(ui, "Filter that estimates", &next.filter(scenario), filters).unwrap_or(next.filter);
        }
        if let Some((_, forecast)) = &sensors.shown {
            let all = forecast.channels.iter().map(|&channel| (channel, channel.symbol().to_owned()));
            let shown = forecast.channels[place(&next, forecast)];
            next.parameter = menu_ui(ui, "Parameter to narrow", &shown, all).or(next.parameter);
        }
        let rate = |rate: f64| (rate, format!("{} Hz, ×{rate}", significant(rate / scenario.dt, 4)));
        next.plan.rate =
            menu_ui(ui, "Rate of the readings", &next.plan.rate, RATES.map(rate)).unwrap_or(next.plan.rate);
        let seconds = |by: f64| format!("{} s, ×{by}", significant(by * scenario.duration, 4));
        let all = DURATIONS.into_iter().map(seconds).enumerate();
        next.duration = menu_ui(ui, "Duration of the record", &next.duration, all).unwrap_or(next.duration);
        let all = [(false, "beside today's sensors"), (true, "alone")].map(|(alone, text)| (alone, text.to_owned()));
        next.plan.alone = menu_ui(ui, "Place of the new sensor", &next.plan.alone, all).unwrap_or(next.plan.alone);
    });
    ui.horizontal_wrapped(|ui| {
        ui.weak("noise ±σ of a new sensor");
        let all = measurable(scenario);
        for aspect in Aspect::ALL.into_iter().filter(|aspect| all.iter().any(|one| one.aspect() == *aspect)) {
            noise_ui(ui, aspect, &mut next, scenario);
        }
    });
    let progress = sensors.progress();
    if progress.is_some() || sensors.is_stopped() {
        ui.horizontal(|ui| {
            if ui.button(if progress.is_some() { "Stop" } else { "Compare the sensors" }).clicked() {
                requests.push(Request::CompareSensors(progress.is_none()));
            }
            match progress {
                Some(share) => _ = ui.add(ProgressBar::new(share as f32).desired_height(6.0).desired_width(160.0)),
                None => _ = ui.weak("Stopped: the numbers below are of earlier settings."),
            }
        });
    }
    if next != sensors.choice {
        requests.push(Request::ChooseSensors(Box::new(next)));
    }
}

fn menu_ui<T: PartialEq>(ui: &mut Ui, name: &str, now: &T, all: impl IntoIterator<Item = (T, String)>) -> Option<T> {
    let mut all: Vec<(T, String)> = all.into_iter().collect();
    let chosen = all.iter().find(|(one, _)| one == now).map_or("", |(_, text)| text);
    let combo = ComboBox::from_id_salt(name).selected_text(chosen).width(58.0).show_ui(ui, |ui| {
        let is_clicked = |(one, text): &(T, String)| ui.selectable_label(one == now, text).clicked();
        all.iter().map(is_clicked).collect::<Vec<_>>().into_iter().position(|clicked| clicked)
    });
    named(combo.response.on_hover_text(name), name);
    combo.inner.flatten().map(|place| all.swap_remove(place).0)
}

fn noise_ui(ui: &mut Ui, aspect: Aspect, choice: &mut SensorChoice, scenario: &Scenario) {
    let (first, usual) = (Quantity::new(aspect, 0), aspect.info().usual_noise);
    let std = choice.plan.noise_std_of(aspect, scenario);
    let mut now = std;
    let (name, height) = (format!("Noise of a new {} sensor", first.name()), ui.spacing().interact_size.y);
    // Symbol, field and unit stay in one line of a narrow view.
    ui.allocate_ui_with_layout(vec2(136.0, height), Layout::left_to_right(Align::Center), |ui| {
        ui.weak(first.symbol());
        ui.allocate_ui(vec2(64.0, height), |ui| {
            field_ui(ui, &mut now, 0.0, usual, name.as_str(), "Its standard deviation")
        });
        ui.weak(unit_in(scenario, first.unit()));
    });
    ui.add_space(8.0);
    if now != std && now > 0.0 {
        choice.plan.noise_std.insert(first, now);
    }
}

fn table_ui(
    ui: &mut Ui,
    context: &ViewContext<'_>,
    forecast: &SensorForecast,
    chosen: usize,
    requests: &mut Vec<Request>,
) {
    let sensors = &context.laboratory.map(|laboratory| &laboratory.sensors);
    let Some(choice) = sensors.map(|sensors| &sensors.choice) else { return };
    let width = ui.clip_rect().width();
    let is_narrow = width < NARROW;
    let columns: Vec<usize> = (0..forecast.channels.len()).filter(|at| !is_narrow || *at == chosen).collect();
    let room = (width - NAMES[usize::from(is_narrow)]) / columns.len() as f32;
    let size = vec2(room.clamp(BAR.0, BAR.1), ui.spacing().interact_size.y);
    let is_screen = Medium::of(ui.ctx()) == Medium::Screen;
    Grid::new("sensors").spacing(vec2(10.0, 3.0)).show(ui, |ui| {
        // Above the names and the buttons.
        ui.label("");
        ui.label("");
        for &at in &columns {
            let channel = forecast.channels[at];
            let unit = context.unit(channel.unit());
            let text =
                if unit.is_empty() { channel.symbol().to_owned() } else { format!("{} [{unit}]", channel.symbol()) };
            let text = RichText::new(text);
            ui.label(if at == chosen { text.family(theme::strong()) } else { text }).on_hover_text(channel.name());
        }
        ui.end_row();
        for row in forecast.ranked(choice.duration, chosen) {
            let name = forecast.name(row.sensor);
            let name = if is_narrow { name.replace(" on mass", "\non mass") } else { name };
            ui.label(if row.sensor.is_some() { RichText::new(name) } else { RichText::new(name).weak() });
            match row.sensor.filter(|_| is_screen) {
                None => _ = ui.label(""),
                Some(sensor) => {
                    let (text, what) = if choice.plan.alone { ("Use alone", "Use alone:") } else { ("Add", "Add:") };
                    let what = format!("{what} {}", sensor.measures.name());
                    let hint = "Changes the sensors of the scenario; its rate and duration stay";
                    if named(ui.small_button(text).on_hover_text(hint), what).clicked() {
                        requests.extend(Request::edit(choice.change(sensor, context.session.scenario())));
                    }
                }
            }
            for &at in &columns {
                bar_ui(ui, context, (row, forecast.now[at]), (choice.duration, at), at == chosen, size);
            }
            ui.end_row();
        }
    });
}

fn bar_ui(
    ui: &mut Ui,
    context: &ViewContext<'_>,
    (row, now): (&SensorRow, f64),
    (duration, at): (usize, usize),
    is_chosen: bool,
    size: egui::Vec2,
) {
    let (std, palette) = (row.std[duration][at], context.palette);
    let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
    let ratio = std / now;
    if ratio.is_finite() {
        let share = (TODAY * ratio as f32).min(1.0);
        let bar = rect.with_max_x(rect.left() + share * rect.width());
        ui.painter().rect_filled(bar, 1.5, palette.accent.gamma_multiply(if is_chosen { 0.38 } else { 0.16 }));
        let today = rect.left() + TODAY * rect.width();
        ui.painter().vline(today, rect.y_range(), Stroke::new(1.5, palette.weak));
    }
    let layout = Layout::left_to_right(Align::Center);
    let mut cell = ui.new_child(UiBuilder::new().max_rect(rect.shrink2(vec2(4.0, 0.0))).layout(layout));
    let text = if std.is_finite() { format!("±{}", significant(2.0 * std, 2)) } else { "–".to_owned() };
    cell.label(text);
    if ratio.is_finite() {
        cell.with_layout(Layout::right_to_left(Align::Center), |ui| ui.weak(format!("×{}", significant(ratio, 2))));
    }
}
