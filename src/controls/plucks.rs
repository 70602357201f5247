//! The times at which a filter assumes that the motion begins again.

use egui::{DragValue, Ui};
use kalmanscope_core::FilterSettings;

use super::lit::lit;
use super::row::choices_ui;
use crate::text::significant;

const HINT: &str = "Where it was plucked again, by a hand that no input tells of: there the filter forgets the motion, and keeps what it knows \
                    of the parameters";

/// The change of a time per point of dragging \[s\], and the time from the last pluck to a new one.
const SPEED: f64 = 0.01;
const LATER: f64 = 10.0;

/// A number for each pluck. The times are in order.
pub(super) fn plucks_ui(ui: &mut Ui, filter: &mut FilterSettings) {
    if !filter.can_be_plucked() {
        filter.plucks.clear();
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
        choices_ui(ui, ("plucked again", HINT), &summary, &format!("{name} plucks"), &mut |ui| {
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
                    let text = format!("{name} pluck {}", place + 1);
                    ui.ctx().accesskit_node_builder(field.id, |node| node.set_label(text));
                    let button = ui.button("×").on_hover_text("Not plucked then");
                    let text = format!("{name} without pluck {}", place + 1);
                    ui.ctx().accesskit_node_builder(button.id, |node| node.set_label(text));
                    if button.clicked() {
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
