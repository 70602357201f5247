//! The equation of the user's own plant, among the settings.

use egui::{Button, TextStyle, Ui};
use kalmanscope_core::Scenario;

use super::Asked;
use crate::equation::job;

pub(super) fn equation_ui(ui: &mut Ui, scenario: &Scenario, asked: &mut Vec<Asked>) {
    let Some(own) = scenario.plant.kind.own_equation() else { return };
    let font = TextStyle::Body.resolve(ui.style());
    let printed = job(&own.settings().equation, &font, ui.visuals().text_color());
    let button = Button::new(printed).wrap().min_size(egui::vec2(ui.available_width(), 0.0));
    let button = ui.add(button).on_hover_text("Edit the equation and its parameters");
    button.ctx.accesskit_node_builder(button.id, |node| node.set_label("Edit the equation"));
    if button.clicked() {
        asked.push(Asked::Equation);
    }
}
