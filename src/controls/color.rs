//! The colour of a filter: a dot that opens the palette.

use egui::{Popup, Sense, Ui, Vec2, WidgetInfo};
use kalmanscope_core::{FilterColor, Scenario};

use crate::theme::Palette;

/// The dot of the filter at `place`; a click offers the others.
pub(super) fn color_ui(ui: &mut Ui, scenario: &mut Scenario, place: usize, palette: &Palette) {
    let Some(filter) = scenario.filters.get_mut(place) else { return };
    let color = filter.color.unwrap_or(FilterColor::at(place));
    let label = format!("Colour of {}", filter.name);
    let dot = dot_ui(ui, palette.shade(color), &label, false).on_hover_text("Choose another colour");
    let chosen = Popup::menu(&dot).show(|ui| {
        ui.horizontal(|ui| {
            let one = |ui: &mut Ui, choice: FilterColor| {
                let dot = dot_ui(ui, palette.shade(choice), choice.name(), choice == color);
                dot.on_hover_text(choice.name()).clicked()
            };
            FilterColor::ALL.into_iter().filter(|&choice| one(ui, choice)).last()
        })
        .inner
    });
    if let Some(choice) = chosen.and_then(|response| response.inner) {
        filter.color = Some(choice);
    }
}

/// Lets every filter keep the colour that it has by its place, before places change. Returns the first that none has.
pub(super) fn keep_colors(scenario: &mut Scenario) -> Option<FilterColor> {
    for (place, filter) in scenario.filters.iter_mut().enumerate() {
        filter.color.get_or_insert(FilterColor::at(place));
    }
    FilterColor::ALL.into_iter().find(|color| scenario.filters.iter().all(|filter| filter.color != Some(*color)))
}

fn dot_ui(ui: &mut Ui, color: egui::Color32, label: &str, ringed: bool) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(Vec2::splat(18.0), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, label));
    let radius = if response.hovered() || response.has_focus() { 7.0 } else { 5.5 };
    ui.painter().circle_filled(rect.center(), radius, color);
    if ringed {
        ui.painter().circle_stroke(rect.center(), 8.0, egui::Stroke::new(1.5, color));
    }
    response
}
