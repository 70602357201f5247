//! The times by which a filter takes its sensors to be late.

use egui::{DragValue, Ui};
use kalmanscope_core::setting::{Entry, SENSOR_DELAY};
use kalmanscope_core::{FilterSettings, Sensor};

use super::lit::lit;
use super::row::choices_ui;
use crate::text::significant;

/// The change of a delay per point of dragging \[s\].
const SPEED: f64 = 1e-3;

/// A number for each sensor. An untouched list stays as it is, so that a file need not list zeros.
pub(super) fn delays_ui(ui: &mut Ui, filter: &mut FilterSettings, sensors: &[Sensor]) {
    if sensors.is_empty() {
        return;
    }
    let name = filter.name.clone();
    lit(ui, &filter.address(SENSOR_DELAY.key), |ui| {
        choices_ui(
            ui,
            ("sensors late", SENSOR_DELAY.hint),
            &summary(filter, sensors),
            &format!("{name} delays"),
            &mut |ui| {
                for quantity in sensors.iter().map(|sensor| sensor.measures) {
                    let entry = Entry::Sensor(quantity);
                    let before = SENSOR_DELAY.get(filter, entry, sensors).unwrap_or(0.0);
                    let mut delay = before;
                    ui.horizontal(|ui| {
                        ui.label(format!("{} by", quantity.symbol())).on_hover_text(quantity.name());
                        let least = SENSOR_DELAY.allowed.least();
                        let field =
                            DragValue::new(&mut delay).speed(SPEED).range(least..=-least).max_decimals(5).suffix(" s");
                        let field = ui.add(field).on_hover_text(SENSOR_DELAY.hint);
                        let text = format!("{name} {} of {}", SENSOR_DELAY.name, entry.name());
                        ui.ctx().accesskit_node_builder(field.id, |node| node.set_label(text));
                    });
                    if delay != before
                        && let Some(own) = SENSOR_DELAY.get_mut(filter, entry, sensors)
                    {
                        *own = delay;
                    }
                }
            },
        );
    });
}

fn summary(filter: &FilterSettings, sensors: &[Sensor]) -> String {
    let late = sensors.iter().zip(&filter.sensor_delay).filter(|(_, delay)| **delay != 0.0);
    let late: Vec<String> =
        late.map(|(sensor, delay)| format!("{} {} s", sensor.measures.symbol(), significant(*delay, 3))).collect();
    if late.is_empty() { "none".to_owned() } else { late.join(", ") }
}
