//! A menu that does not cover its button: it scrolls if the window has no room for all of it.

use egui::containers::menu::{MenuConfig, menu_style};
use egui::text::{LayoutJob, TextFormat};
use std::sync::Arc;

use egui::{
    Atom, AtomPaintArgs, Button, Popup, PopupCloseBehavior, Response, ScrollArea, TextStyle, Ui, UiKind, UiStackInfo,
    Vec2, vec2,
};

use crate::spark::SparkPicture;
use crate::theme::Palette;

/// The distance of a menu's contents from its button and from the window's edge, together \[points\].
const MARGINS: f32 = 28.0;

const LEAST: f32 = 100.0;

/// The width of an entry with a sentence, where there is room \[points\].
const ENTRY: f32 = 420.0;

const PICTURE: Vec2 = vec2(64.0, 26.0);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Closing {
    AtOnce,
    Beside,
}

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

pub(crate) fn entry_ui(ui: &mut Ui, title: &str, sentence: &str, picture: Option<Arc<SparkPicture>>) -> Response {
    ui.set_min_width(ENTRY.min(ui.available_width()));
    let [body, small] = [TextStyle::Body, TextStyle::Small].map(|style| style.resolve(ui.style()));
    let mut text = LayoutJob::default();
    text.append(&format!("{title}\n"), 0.0, TextFormat::simple(body, ui.visuals().strong_text_color()));
    text.append(sentence, 0.0, TextFormat::simple(small, ui.visuals().weak_text_color()));
    let palette = Palette::of(ui.ctx().theme());
    let paint = move |ui: &Ui, place: AtomPaintArgs| {
        picture.iter().for_each(|picture| picture.paint(ui.painter(), place.rect, &palette));
    };
    let button = ui.add(
        Button::new((Atom::paint(PICTURE, paint), text))
            .wrap()
            .frame_when_inactive(false)
            .min_size(vec2(ui.available_width(), 0.0)),
    );
    button.ctx.accesskit_node_builder(button.id, |node| node.set_label(title));
    button
}
