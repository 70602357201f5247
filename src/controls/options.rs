//! The less common settings of a filter: its plant, what else it estimates, its propagation, and those with rows.

use egui::{Checkbox, DragValue, PopupCloseBehavior, Ui};
use kalmanscope_core::Length;
use kalmanscope_core::channel::augment;
use kalmanscope_core::scenario::Between;
use kalmanscope_core::scenario::option::{BOUNDED, CONSIDERED, FilterOption, PLUCKED};
use kalmanscope_core::setting::{CHOICES_OF_FILTER, CORRELATION_TIME, Entry, SENSOR_DELAY, TableInfo, options};
use kalmanscope_core::{Channel, FilterSettings, PlantKind, Scenario};

use super::Edits;
use super::highlight::highlight_ui;
use super::row::{choice_row_ui, filter_row_ui, list_ui};
use crate::text::significant;
use crate::widgets::named;

const OUTSIDE: PopupCloseBehavior = PopupCloseBehavior::CloseOnClickOutside;

pub(super) fn options_ui(ui: &mut Ui, filter: &FilterSettings, edits: &mut Edits<'_>) {
    let Scenario { plant, sensors, .. } = &**edits.scenario;
    egui::CollapsingHeader::new("Options").id_salt(("options", filter.id)).show_unindented(ui, |ui| {
        plant_ui(ui, filter, edits);
        augment_ui(ui, filter, edits);
        consider_ui(ui, filter, edits);
        bounds_ui(ui, filter, edits);
        let entries: Vec<Entry> = sensors.iter().map(|sensor| Entry::Sensor(sensor.measures)).collect();
        times_ui(ui, filter, (&SENSOR_DELAY, "sensors late"), &entries, edits);
        let forgotten = filter.augment.iter().filter(|channel| channel.can_be_forgotten());
        let entries: Vec<Entry> = forgotten.map(|channel| Entry::Channel(*channel)).collect();
        times_ui(ui, filter, (&CORRELATION_TIME, "forgotten"), &entries, edits);
        plucks_ui(ui, filter, edits);
        for info in CHOICES_OF_FILTER {
            if (info.serves)(filter) {
                let (name, key) = (format!("{} {}", filter.name, info.name), filter.address(info.key));
                highlight_ui(ui, &key, |ui| choice_row_ui(ui, info, (filter, &key), &name, edits));
            }
        }
        for info in options() {
            if (info.serves)(filter, &plant.kind) {
                filter_row_ui(ui, info, filter, edits);
            }
        }
    });
}

fn augment_ui(ui: &mut Ui, filter: &FilterSettings, edits: &mut Edits<'_>) {
    let FilterSettings { name, augment, .. } = filter;
    let sensors = edits.scenario.sensors.iter();
    let offered: Vec<Channel> = augment::of_all(sensors.map(|sensor| sensor.measures)).collect();
    let hint = "Properties of the input and the sensors that the filter estimates too: gain, offset, a force that \
         changes slowly (u) or is another one at each sample (w: wind, traffic), bias and gain of a sensor";
    let summary = listed(augment.iter().map(|channel| channel.symbol()), "nothing");
    let texts = (("also estimate", hint), summary, format!("{name} augmentations"));
    channels_ui(ui, texts, &offered, (augment, filter.address("augment")), true, edits);
}

fn offered(filter: &FilterSettings, option: &FilterOption, truth: &PlantKind) -> Vec<Channel> {
    if filter.can(option) { filter.considerable(truth).collect() } else { Vec::new() }
}

fn consider_ui(ui: &mut Ui, filter: &FilterSettings, edits: &mut Edits<'_>) {
    let offered = offered(filter, &CONSIDERED, &edits.scenario.plant.kind);
    let FilterSettings { name, consider, .. } = filter;
    if offered.is_empty() {
        return;
    }
    let symbols = listed(consider.iter().map(|channel| channel.symbol()), "");
    let summary = if symbols.is_empty() { "all".to_owned() } else { format!("all but {symbols}") };
    let hint = "What is left out keeps its mean and its σ: the filter does not estimate it, but counts what is not known of it in all \
         other bands (Schmidt 1966)";
    let texts = (("estimated", hint), summary, format!("{name} learns"));
    channels_ui(ui, texts, &offered, (consider, filter.address("consider")), false, edits);
}

fn channels_ui(
    ui: &mut Ui,
    (label_and_hint, summary, name): ((&str, &str), String, String),
    offered: &[Channel],
    (chosen, address): (&[Channel], String),
    is_on: bool,
    edits: &mut Edits<'_>,
) {
    list_ui(ui, label_and_hint, &summary, &name, OUTSIDE, &mut |ui| {
        for &channel in offered {
            let mut on = chosen.contains(&channel) == is_on;
            if ui.checkbox(&mut on, format!("{} {}", channel.symbol(), channel.name())).changed() {
                let others = chosen.iter().copied().filter(|other| *other != channel);
                let chosen: Vec<Channel> = others.chain((on == is_on).then_some(channel)).collect();
                edits.change.put(&*address, &chosen);
            }
        }
    });
}

fn listed<T: Into<String>>(all: impl Iterator<Item = T>, none: &str) -> String {
    let all: Vec<String> = all.map(Into::into).collect();
    if all.is_empty() { none.to_owned() } else { all.join(", ") }
}

fn plant_ui(ui: &mut Ui, filter: &FilterSettings, edits: &mut Edits<'_>) {
    let FilterSettings { name, plant, .. } = filter;
    let mut chosen = plant.clone();
    let text = |plant: &Option<PlantKind>| plant.as_ref().map_or("same as truth", PlantKind::name).to_owned();
    let (label, now) = (("model", "The model that the filter uses"), text(plant));
    list_ui(ui, label, &now, &format!("{name} plant"), PopupCloseBehavior::CloseOnClick, &mut |ui| {
        for kind in std::iter::once(None).chain(PlantKind::ALL.map(Some)) {
            let text = text(&kind);
            ui.selectable_value(&mut chosen, kind, text);
        }
    });
    edits.put_other(&filter.address("plant"), plant, &chosen);
}

/// The distance of a new end from the initial mean, in standard deviations of the initial belief.
const FAR: f64 = 4.0;

fn bounds_ui(ui: &mut Ui, filter: &FilterSettings, edits: &mut Edits<'_>) {
    let offered = offered(filter, &BOUNDED, &edits.scenario.plant.kind);
    let length = Length::of(edits.scenario.record.as_ref());
    if offered.is_empty() {
        return;
    }
    let hint = "Limits of a parameter: estimate and band are those of the belief between them (truncation; Simon 2010). The filter itself does not use them";
    let short = |end: f64| significant(end, 3);
    let ends = filter.bounds.iter().map(|(channel, Between { least, most })| match (channel.symbol(), least, most) {
        (symbol, Some(least), Some(most)) => format!("{symbol} {}…{}", short(least), short(most)),
        (symbol, Some(least), None) => format!("{symbol} ≥ {}", short(least)),
        (symbol, None, Some(most)) => format!("{symbol} ≤ {}", short(most)),
        (symbol, None, None) => symbol.to_owned(),
    });
    let (name, summary) = (&filter.name, listed(ends, "no bounds"));
    let mut bounds = filter.bounds.clone();
    list_ui(ui, ("limits", hint), &summary, &format!("{name} bounds"), OUTSIDE, &mut |ui| {
        for &channel in &offered {
            let (mean, std) = (filter.initial_mean[channel], filter.initial_std[channel]);
            let mut between = filter.bounds.of(channel);
            ui.horizontal(|ui| {
                let ([lower, upper], symbol) = (usual(channel, mean, std), channel.symbol());
                let Between { least, most } = &mut between;
                end_ui(ui, &format!("{symbol} at least"), name, least, (f64::NEG_INFINITY, mean, lower));
                end_ui(ui, "at most", &format!("{name} {symbol}"), most, (mean, f64::INFINITY, upper));
                ui.weak(length.in_place_of(channel.unit()));
            });
            bounds.set(channel, between);
        }
    });
    edits.put_other(&filter.address("bounds"), &filter.bounds, &bounds);
}

fn usual(channel: Channel, mean: f64, std: f64) -> [f64; 2] {
    let far = FAR * if std > 0.0 { std } else { mean.abs().max(1.0) };
    let lower = if mean >= 0.0 && channel.is_parameter() && !channel.is_augmentation() { 0.0 } else { mean - far };
    [lower, mean + far]
}

fn end_ui(ui: &mut Ui, label: &str, name: &str, end: &mut Option<f64>, (least, most, offered): (f64, f64, f64)) {
    let mut is_on = end.is_some();
    if ui.add(Checkbox::new(&mut is_on, label)).changed() {
        *end = is_on.then_some(offered);
    }
    if let Some(end) = end {
        let speed = 0.01 * end.abs().max(0.1);
        let drag = DragValue::new(end).range(least..=most).speed(speed).max_decimals(6);
        named(ui.add(drag), format!("{name} {label}"));
    }
}

fn times_ui(
    ui: &mut Ui,
    filter: &FilterSettings,
    (table, label): (&TableInfo, &str),
    entries: &[Entry],
    edits: &mut Edits<'_>,
) {
    if entries.is_empty() {
        return;
    }
    let time = |entry: Entry| table.get(filter, entry, &edits.scenario.sensors).unwrap_or(0.0);
    let set = entries.iter().map(|&entry| (entry.symbol(), time(entry))).filter(|(_, time)| *time != 0.0);
    let set = set.map(|(symbol, time)| format!("{symbol} {} s", significant(time, 3)));
    let (name, summary) = (&filter.name, listed(set, "none"));
    let scenario = edits.scenario;
    highlight_ui(ui, &filter.address(table.key), |ui| {
        list_ui(ui, (label, table.hint), &summary, &format!("{name} {label}"), OUTSIDE, &mut |ui| {
            for &entry in entries {
                let before = table.get(filter, entry, &scenario.sensors).unwrap_or(0.0);
                let least = table.allowed.least();
                let mut now = before;
                ui.horizontal(|ui| {
                    ui.label(entry.symbol()).on_hover_text(entry.name());
                    let most = if least < 0.0 { -least } else { f64::INFINITY };
                    let field = DragValue::new(&mut now).speed(1e-3).range(least..=most).max_decimals(5).suffix(" s");
                    named(
                        ui.add(field).on_hover_text(table.hint),
                        format!("{name} {} of {}", table.name, entry.name()),
                    );
                });
                edits.set_other(&filter.address(&format!("{}.{}", table.key, entry.key())), before, now);
            }
        });
    });
}

const HINT: &str = "Times when a hand plucked it again, which no input records: there the filter forgets the motion, and keeps what it knows of the parameters";

/// The change of a time per point of dragging \[s\], and the time from the last pluck to a new one.
const SPEED: f64 = 0.01;
const LATER: f64 = 10.0;

fn plucks_ui(ui: &mut Ui, filter: &FilterSettings, edits: &mut Edits<'_>) {
    if !filter.can(&PLUCKED) {
        return;
    }
    let (name, address) = (&filter.name, filter.address("plucks"));
    let mut times = filter.plucks.clone();
    let summary = match times[..] {
        [] => "none".to_owned(),
        [one] => format!("at {} s", significant(one, 4)),
        _ => format!("{} times", times.len()),
    };
    highlight_ui(ui, &address, |ui| {
        list_ui(ui, ("plucked again at", HINT), &summary, &format!("{name} plucks"), OUTSIDE, &mut |ui| {
            // Above the others: a list that grows while it is open keeps its height and scrolls.
            if ui.button("One more").clicked() {
                times.push(times.last().copied().unwrap_or(0.0) + LATER);
            }
            let mut removed = None;
            for place in 0..times.len() {
                let least = place.checked_sub(1).map_or(f64::NEG_INFINITY, |before| times[before] + SPEED);
                let most = times.get(place + 1).map_or(f64::INFINITY, |after| after - SPEED);
                ui.horizontal(|ui| {
                    let field = DragValue::new(&mut times[place])
                        .speed(SPEED)
                        .range(least..=most)
                        .clamp_existing_to_range(false);
                    let field = ui.add(field.max_decimals(3).prefix("at ").suffix(" s")).on_hover_text(HINT);
                    named(field, format!("{name} pluck {}", place + 1));
                    let button = ui.button("×").on_hover_text("Not plucked then");
                    if named(button, format!("{name} without pluck {}", place + 1)).clicked() {
                        removed = Some(place);
                    }
                });
            }
            if let Some(place) = removed {
                times.remove(place);
            }
        });
    });
    edits.put_other(&address, &filter.plucks, &times);
}
