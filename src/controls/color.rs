//! The colour of a filter: a dot that opens the palette.

use egui::{Popup, Sense, Ui, Vec2, WidgetInfo};
use kalmanscope_core::{FilterColor, FilterSettings, Scenario};

use crate::theme::Palette;

pub(super) fn color_ui(ui: &mut Ui, filter: &mut FilterSettings, palette: &Palette) {
    let color = color_of(filter);
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

/// The colour for a new filter with this id: `None` where the id's default colour is free, else the first free colour.
pub(super) fn free_color(scenario: &Scenario, id: u32) -> Option<FilterColor> {
    let taken: Vec<FilterColor> = scenario.filters.iter().map(color_of).collect();
    if taken.contains(&FilterColor::of(id)) {
        FilterColor::ALL.into_iter().find(|color| !taken.contains(color))
    } else {
        None
    }
}

pub(crate) fn color_of(filter: &FilterSettings) -> FilterColor {
    filter.color.unwrap_or(FilterColor::of(filter.id))
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
