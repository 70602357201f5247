//! The trials as rows that can be named, given a mass, and removed.

use egui::{DragValue, Grid, RichText, TextEdit, Ui, vec2};
use kalmanscope_core::Story;
use kalmanscope_lab::Trial;

/// Grams in a kilogram.
const GRAMS: f64 = 1000.0;

/// The width of a name's field, and of that in a narrow table, which has no room for the period, 1 / f, either \[points\].
const NAME: f32 = 84.0;
const SHORT_NAME: f32 = 62.0;
const NARROW: f32 = 430.0;

/// The head of the period's column.
const PERIOD: &str = "T [s]";

/// Shows the rows. Returns other ones if the user has changed them.
pub(super) fn table_ui(ui: &mut Ui, rows: &[Trial], is_screen: bool) -> Option<Vec<Trial>> {
    let mut next = rows.to_vec();
    let mut removed = None;
    let has_period = ui.available_width() >= NARROW;
    Grid::new("trials").striped(true).spacing([if has_period { 10.0 } else { 8.0 }, 4.0]).show(ui, |ui| {
        for name in ["name", "added [g]", "f [Hz]", PERIOD, "ζ [%]", ""] {
            if has_period || name != PERIOD {
                ui.weak(name);
            }
        }
        ui.end_row();
        for (place, trial) in next.iter_mut().enumerate() {
            let number = place + 1;
            if is_screen {
                editors_ui(ui, trial, number, if has_period { NAME } else { SHORT_NAME });
            } else {
                ui.label(&trial.name);
                ui.label(format!("{}", GRAMS * trial.mass));
            }
            let damping = trial.damping.times(100.0);
            let numbers = [Some(trial.hertz()), has_period.then(|| trial.period()), Some(damping)];
            for one in numbers.into_iter().flatten() {
                ui.label(Story::estimate(one.mean, one.band(), ""));
            }
            ui.horizontal(|ui| {
                if is_screen {
                    let button = ui.small_button("✕").on_hover_text("Remove this row");
                    button.ctx.accesskit_node_builder(button.id, |node| node.set_label(format!("Remove row {number}")));
                    if button.clicked() {
                        removed = Some(place);
                    }
                }
                if !trial.is_believed {
                    let warning = RichText::new("⚠").color(ui.visuals().warn_fg_color);
                    ui.label(warning).on_hover_text("The verdict on this filter was bad: its bands may be too narrow");
                }
            });
            ui.end_row();
        }
    });
    if let Some(place) = removed {
        next.remove(place);
    }
    (next != rows && next.iter().all(|trial| trial.check().is_ok())).then_some(next)
}

fn editors_ui(ui: &mut Ui, trial: &mut Trial, number: usize, width: f32) {
    let name = TextEdit::singleline(&mut trial.name).char_limit(Trial::LONGEST_NAME);
    let size = vec2(width, ui.spacing().interact_size.y);
    let name = ui.add_sized(size, name.hint_text(format!("trial {number}")));
    name.ctx.accesskit_node_builder(name.id, |node| node.set_label(format!("Name of row {number}")));
    let mut grams = GRAMS * trial.mass;
    let field = DragValue::new(&mut grams).range(0.0..=GRAMS * Trial::HEAVIEST).speed(1.0).max_decimals(3);
    let field = ui.add(field).on_hover_text("The mass that was added to the oscillator [g]");
    field.ctx.accesskit_node_builder(field.id, |node| node.set_label(format!("Added mass of row {number}")));
    if field.changed() {
        trial.mass = grams / GRAMS;
    }
}
