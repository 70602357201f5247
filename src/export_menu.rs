//! The menu of exports.

use egui::{Context, Id, Popup, RichText, Ui};

use crate::menu::{self, Closing};
use crate::probe;
use crate::request::{Export, FigureFormat, Request};

pub(crate) fn menu_ui(ui: &mut Ui, narrow: bool, requests: &mut Vec<Request>) {
    let button = menu::menu_ui(ui, if narrow { "↓" } else { "Export" }, Closing::AtOnce, |ui| {
        if ui.button("Copy link").on_hover_text("To this picture: settings, views and time (C)").clicked() {
            requests.push(Request::CopyLink);
            ui.close();
        }
        ui.separator();
        let mut entry = |ui: &mut Ui, export: Export| {
            let button = ui.button(export.name()).on_hover_text(export.hint());
            probe::remember(ui.ctx(), &export.name(), button.rect);
            if button.clicked() {
                requests.push(Request::Export(export));
                ui.close();
            }
        };
        ui.label(RichText::new("The views as a figure").weak());
        for format in FigureFormat::ALL {
            entry(ui, Export::Figure(format));
        }
        ui.separator();
        ui.label(RichText::new("Results").weak());
        for export in Export::DATA {
            entry(ui, export);
        }
    });
    button.ctx.accesskit_node_builder(button.id, |node| node.set_label("Export"));
    probe::remember(ui.ctx(), "Export", button.rect);
    let popup = Popup::default_response_id(&button);
    ui.data_mut(|data| data.insert_temp(popup_key(), popup));
}

pub(crate) fn toggle(ctx: &Context) {
    if let Some(popup) = ctx.data(|data| data.get_temp::<Id>(popup_key())) {
        Popup::toggle_id(ctx, popup);
    }
}

fn popup_key() -> Id {
    Id::unique("the popup of the menu of exports")
}
