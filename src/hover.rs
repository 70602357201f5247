//! Names of widgets, and texts over them. These are built only when they are shown or read aloud, which most frames do not need.

use egui::Response;

pub(crate) fn hover_text(response: Response, text: &dyn Fn() -> String) -> Response {
    if response.ctx.has_accesskit_node(response.id) {
        return response.on_hover_text(text());
    }
    response.on_hover_ui(|ui| {
        ui.set_max_width(ui.spacing().tooltip_width);
        ui.label(text());
    })
}

/// Gives a widget its accessible name.
pub(crate) fn named(response: Response, name: impl Into<String>) -> Response {
    let name = name.into();
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(name));
    response
}
