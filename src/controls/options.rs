//! The less common settings of a filter: its plant, what else it estimates, its propagation, and those with rows.

use egui::{Checkbox, DragValue, PopupCloseBehavior, Ui};
use kalmanscope_core::Length;
use kalmanscope_core::channel::augment;
use kalmanscope_core::scenario::Between;
use kalmanscope_core::scenario::option::{BOUNDED, CONSIDERED, PLUCKED};
use kalmanscope_core::setting::{CHOICES_OF_FILTER, CORRELATION_TIME, Entry, OPTIONS, SENSOR_DELAY, TableInfo};
use kalmanscope_core::{Channel, FilterSettings, PlantKind, Sensor};

use super::lit::lit;
use super::row::{choice_row_ui, filter_row_ui, list_ui};
use crate::text::significant;
use crate::widgets::named;

/// A list with several choices or numbers stays open until the user clicks elsewhere.
const OUTSIDE: PopupCloseBehavior = PopupCloseBehavior::CloseOnClickOutside;

pub(super) fn options_ui(
    ui: &mut Ui,
    filter: &mut FilterSettings,
    truth: &PlantKind,
    sensors: &[Sensor],
    length: Length,
) {
    egui::CollapsingHeader::new("Options").id_salt(("options", filter.id)).show_unindented(ui, |ui| {
        plant_ui(ui, filter);
        augment_ui(ui, filter, truth, sensors);
        consider_ui(ui, filter, truth);
        bounds_ui(ui, filter, truth, length);
        let entries: Vec<Entry> = sensors.iter().map(|sensor| Entry::Sensor(sensor.measures)).collect();
        times_ui(ui, filter, sensors, &SENSOR_DELAY, "sensors late", &entries);
        let forgotten = filter.augment.iter().filter(|channel| channel.can_be_forgotten());
        let entries: Vec<Entry> = forgotten.map(|channel| Entry::Channel(*channel)).collect();
        times_ui(ui, filter, sensors, &CORRELATION_TIME, "forgotten", &entries);
        plucks_ui(ui, filter);
        for info in CHOICES_OF_FILTER {
            if (info.serves)(filter) {
                let name = format!("{} {}", filter.name, info.name);
                lit(ui, &filter.address(info.key), |ui| choice_row_ui(ui, info, filter, &name));
            }
        }
        for info in OPTIONS {
            if (info.serves)(filter, truth) {
                filter_row_ui(ui, info, filter, truth);
            }
        }
    });
}

fn augment_ui(ui: &mut Ui, filter: &mut FilterSettings, truth: &PlantKind, sensors: &[Sensor]) {
    let FilterSettings { name, augment, plant, .. } = filter;
    let plant = plant.as_ref().unwrap_or(truth);
    let offered: Vec<Channel> = augment::of_all(sensors.iter().map(|sensor| sensor.measures)).collect();
    let hint = "Properties of the input and the sensors that the filter estimates too: gain, offset, a force that \
         changes slowly (u) or is another one at each sample (w: wind, traffic), bias and gain of a sensor";
    let summary = listed(augment.iter().map(|channel| channel.symbol()), "nothing");
    let texts = (("estimates also", hint), summary, format!("{name} augmentations"));
    channels_ui(ui, texts, &offered, augment, true);
    // Bias and gain of a removed sensor go too, and so do those of a quantity that the plant lacks.
    augment.retain(|channel| augment::of(plant).any(|c| c == *channel));
}

fn consider_ui(ui: &mut Ui, filter: &mut FilterSettings, truth: &PlantKind) {
    let offered: Vec<Channel> = if filter.can(&CONSIDERED) { filter.considerable(truth).collect() } else { Vec::new() };
    let FilterSettings { name, consider, .. } = filter;
    // A filter that cannot consider a channel, or no longer has it, estimates it again or leaves it out.
    consider.retain(|channel| offered.contains(channel));
    if offered.is_empty() {
        return;
    }
    let symbols = listed(consider.iter().map(|channel| channel.symbol()), "");
    let summary = if symbols.is_empty() { "all of it".to_owned() } else { format!("all but {symbols}") };
    let hint = "What is left out keeps its mean and its σ: the filter does not estimate it, but counts what is not known of it in all \
         other bands (Schmidt 1966)";
    channels_ui(ui, (("learns", hint), summary, format!("{name} learns")), &offered, consider, false);
}

/// A list of channels with check boxes, which are on for those that are chosen, or else for the others.
fn channels_ui(
    ui: &mut Ui,
    (label_and_hint, summary, name): ((&str, &str), String, String),
    offered: &[Channel],
    chosen: &mut Vec<Channel>,
    is_on: bool,
) {
    list_ui(ui, label_and_hint, &summary, &name, OUTSIDE, &mut |ui| {
        for &channel in offered {
            let mut on = chosen.contains(&channel) == is_on;
            if ui.checkbox(&mut on, format!("{} {}", channel.symbol(), channel.name())).changed() {
                chosen.retain(|other| *other != channel);
                chosen.extend((on == is_on).then_some(channel));
            }
        }
    });
}

fn listed<T: Into<String>>(all: impl Iterator<Item = T>, none: &str) -> String {
    let all: Vec<String> = all.map(Into::into).collect();
    if all.is_empty() { none.to_owned() } else { all.join(", ") }
}

fn plant_ui(ui: &mut Ui, filter: &mut FilterSettings) {
    let FilterSettings { name, plant, .. } = filter;
    let text = |plant: &Option<PlantKind>| plant.as_ref().map_or("as the truth", PlantKind::name).to_owned();
    let (label, now) = (("its plant", "What the filter takes the truth for"), text(plant));
    list_ui(ui, label, &now, &format!("{name} plant"), PopupCloseBehavior::CloseOnClick, &mut |ui| {
        for kind in std::iter::once(None).chain(PlantKind::ALL.map(Some)) {
            let text = text(&kind);
            ui.selectable_value(plant, kind, text);
        }
    });
}

/// The distance of a new end from the initial mean, in standard deviations of the initial belief.
const FAR: f64 = 4.0;

fn bounds_ui(ui: &mut Ui, filter: &mut FilterSettings, truth: &PlantKind, length: Length) {
    let offered: Vec<Channel> = if filter.can(&BOUNDED) { filter.considerable(truth).collect() } else { Vec::new() };
    // A filter that can have no bounds, or no longer has the channel, loses them.
    filter.bounds.retain(|channel| offered.contains(&channel));
    if offered.is_empty() {
        return;
    }
    let hint = "What a parameter cannot be: estimate and band are those of the belief between the ends (truncation; Simon 2010). The filter \
         itself goes on as without them";
    let short = |end: f64| significant(end, 3);
    let ends = filter.bounds.iter().map(|(channel, Between { least, most })| match (channel.symbol(), least, most) {
        (symbol, Some(least), Some(most)) => format!("{symbol} {}…{}", short(least), short(most)),
        (symbol, Some(least), None) => format!("{symbol} ≥ {}", short(least)),
        (symbol, None, Some(most)) => format!("{symbol} ≤ {}", short(most)),
        (symbol, None, None) => symbol.to_owned(),
    });
    let (name, summary) = (filter.name.clone(), listed(ends, "no bounds"));
    list_ui(ui, ("tells within", hint), &summary, &format!("{name} bounds"), OUTSIDE, &mut |ui| {
        for &channel in &offered {
            let (mean, std) = (filter.initial_mean[channel], filter.initial_std[channel]);
            let mut between = filter.bounds.of(channel);
            ui.horizontal(|ui| {
                let ([lower, upper], symbol) = (usual(channel, mean, std), channel.symbol());
                let Between { least, most } = &mut between;
                end_ui(ui, &format!("{symbol} at least"), &name, least, (f64::NEG_INFINITY, mean, lower));
                end_ui(ui, "at most", &format!("{name} {symbol}"), most, (mean, f64::INFINITY, upper));
                ui.weak(length.in_place_of(channel.unit()));
            });
            if between != filter.bounds.of(channel) {
                filter.bounds.set(channel, between);
            }
        }
    });
    // The mean of the initial belief is never beyond an end.
    for &channel in &offered {
        let (mean, Between { least, most }) = (filter.initial_mean[channel], filter.bounds.of(channel));
        let within = Between { least: least.map(|least| least.min(mean)), most: most.map(|most| most.max(mean)) };
        if within != (Between { least, most }) {
            filter.bounds.set(channel, within);
        }
    }
}

fn usual(channel: Channel, mean: f64, std: f64) -> [f64; 2] {
    let far = FAR * if std > 0.0 { std } else { mean.abs().max(1.0) };
    let lower = if mean >= 0.0 && channel.is_parameter() && !channel.is_augmentation() { 0.0 } else { mean - far };
    [lower, mean + far]
}

/// An optional end, with its limits and its first value.
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

/// A time for each sensor or channel. An untouched list stays as it is, so that a file need not list zeros.
fn times_ui(
    ui: &mut Ui,
    filter: &mut FilterSettings,
    sensors: &[Sensor],
    table: &TableInfo,
    label: &str,
    entries: &[Entry],
) {
    if entries.is_empty() {
        return;
    }
    let time = |filter: &FilterSettings, entry: Entry| table.get(filter, entry, sensors).unwrap_or(0.0);
    let set = entries.iter().map(|&entry| (entry.symbol(), time(filter, entry))).filter(|(_, time)| *time != 0.0);
    let set = set.map(|(symbol, time)| format!("{symbol} {} s", significant(time, 3)));
    let (name, summary) = (filter.name.clone(), listed(set, "none"));
    lit(ui, &filter.address(table.key), |ui| {
        list_ui(ui, (label, table.hint), &summary, &format!("{name} {label}"), OUTSIDE, &mut |ui| {
            for &entry in entries {
                let (before, least) = (time(filter, entry), table.allowed.least());
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
                if now != before
                    && let Some(own) = table.get_mut(filter, entry, sensors)
                {
                    *own = now;
                }
            }
        });
    });
}

const HINT: &str = "Where it was plucked again, by a hand that no input tells of: there the filter forgets the motion, and keeps what it knows \
                    of the parameters";

/// The change of a time per point of dragging \[s\], and the time from the last pluck to a new one.
const SPEED: f64 = 0.01;
const LATER: f64 = 10.0;

/// A number for each pluck. The times are in order.
fn plucks_ui(ui: &mut Ui, filter: &mut FilterSettings) {
    if !filter.can(&PLUCKED) {
        return;
    }
    let (name, address) = (filter.name.clone(), filter.address("plucks"));
    let times = &mut filter.plucks;
    let summary = match times[..] {
        [] => "none".to_owned(),
        [one] => format!("at {} s", significant(one, 4)),
        _ => format!("{} times", times.len()),
    };
    lit(ui, &address, |ui| {
        list_ui(ui, ("plucked again", HINT), &summary, &format!("{name} plucks"), OUTSIDE, &mut |ui| {
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
}
