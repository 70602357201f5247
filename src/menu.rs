//! A menu that does not cover its button: it scrolls if the window has no room for all of it.

use egui::containers::menu::{MenuConfig, menu_style};
use egui::{Popup, PopupCloseBehavior, Response, ScrollArea, Ui, UiKind, UiStackInfo};

/// The distance of a menu's contents from its button and from the window's edge, together \[points\].
const MARGINS: f32 = 28.0;

/// The least height of a menu's contents \[points\].
const LEAST: f32 = 100.0;

/// When a menu closes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Closing {
    /// With a choice, or a click beside it.
    AtOnce,
    /// Only with a click beside it, because users often choose several entries.
    Beside,
}

/// Shows a menu's button, and the menu while it is open. Returns the button.
pub(crate) fn menu_ui(
    ui: &mut Ui,
    text: impl Into<egui::WidgetText>,
    closing: Closing,
    add_contents: impl FnOnce(&mut Ui),
) -> Response {
    let button = ui.button(text.into());
    let window = ui.ctx().content_rect();
    // It opens above the button if there is more room.
    let room = (window.bottom() - button.rect.bottom()).max(button.rect.top() - window.top());
    let height = (room - MARGINS).max(LEAST);
    let close_behavior = match closing {
        Closing::AtOnce => PopupCloseBehavior::CloseOnClick,
        Closing::Beside => PopupCloseBehavior::CloseOnClickOutside,
    };
    let config = MenuConfig::new().close_behavior(close_behavior);
    Popup::menu(&button)
        .close_behavior(close_behavior)
        .style(menu_style)
        .info(UiStackInfo::new(UiKind::Menu).with_tag_value(MenuConfig::MENU_CONFIG_TAG, config))
        .show(|ui| {
            ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| add_contents(ui));
        });
    button
}
