//! Colours, fonts and spacing, all in one place.

mod fonts;
mod palette;
pub mod ramps;
mod texels;

pub use palette::Palette;

use egui::{CornerRadius, FontFamily, FontId, Margin, Stroke, TextStyle, Theme, Vec2};

pub fn install(ctx: &egui::Context) {
    ctx.set_fonts(fonts::definitions());
    ctx.add_plugin(texels::Texels);
    for theme in [Theme::Light, Theme::Dark] {
        ctx.style_mut_of(theme, |style| restyle(style, theme));
    }
}

pub fn strong() -> FontFamily {
    FontFamily::Name(fonts::STRONG.into())
}

pub fn symbol() -> TextStyle {
    TextStyle::Name("symbol".into())
}

pub fn readout() -> TextStyle {
    TextStyle::Name("readout".into())
}

pub fn fit_targets(ctx: &egui::Context) {
    if ctx.input(egui::InputState::has_touch_screen) {
        expect_fingers(ctx);
    }
}

pub fn expect_fingers(ctx: &egui::Context) {
    if !is_for_fingers(ctx) {
        ctx.all_styles_mut(|style| style.spacing.interact_size.y = FINGER);
    }
}

pub fn is_for_fingers(ctx: &egui::Context) -> bool {
    ctx.global_style().spacing.interact_size.y >= FINGER
}

/// The height of buttons for fingers \[points\].
const FINGER: f32 = 40.0;

pub fn enlarge_readouts(ctx: &egui::Context, large: bool) {
    let size = if large { READOUT.1 } else { READOUT.0 };
    ctx.all_styles_mut(|style| {
        style.text_styles.insert(readout(), FontId::new(size, FontFamily::Proportional));
    });
}

/// Gives all text one size, for a figure \[points\].
pub(crate) fn level_text(ctx: &egui::Context, size: f32) {
    ctx.all_styles_mut(|style| style.text_styles.values_mut().for_each(|font| font.size = size));
}

/// Size of the numbers above plots, and in a lecture hall \[points\].
const READOUT: (f32, f32) = (11.5, 20.0);

fn restyle(style: &mut egui::Style, theme: Theme) {
    let palette = Palette::of(theme);
    let proportional = |size| FontId::new(size, FontFamily::Proportional);
    style.text_styles = [
        (TextStyle::Heading, FontId::new(17.0, strong())),
        (TextStyle::Body, proportional(13.5)),
        (TextStyle::Button, proportional(13.5)),
        (TextStyle::Small, proportional(11.5)),
        (TextStyle::Monospace, proportional(13.0)),
        (readout(), proportional(READOUT.0)),
        (symbol(), FontId::new(15.0, strong())),
    ]
    .into();
    style.spacing.item_spacing = Vec2::new(7.0, 5.0);
    style.spacing.button_padding = Vec2::new(7.0, 3.0);
    style.spacing.interact_size.y = 22.0;
    style.spacing.window_margin = Margin::same(8);
    style.spacing.slider_rail_height = 4.0;

    let visuals = &mut style.visuals;
    visuals.panel_fill = palette.ground;
    visuals.window_fill = palette.ground;
    visuals.extreme_bg_color = palette.ground;
    visuals.text_edit_bg_color = Some(palette.faint);
    visuals.faint_bg_color = palette.faint;
    visuals.weak_text_color = Some(palette.weak);
    visuals.selection.bg_fill = palette.accent;
    visuals.selection.stroke = Stroke::new(1.0, palette.on_accent);
    visuals.warn_fg_color = palette.warning;
    visuals.hyperlink_color = palette.accent;
    visuals.slider_trailing_fill = true;
    visuals.widgets.noninteractive.bg_stroke = Stroke::new(1.0, palette.separator);
    for widget in [
        &mut visuals.widgets.noninteractive,
        &mut visuals.widgets.inactive,
        &mut visuals.widgets.hovered,
        &mut visuals.widgets.active,
        &mut visuals.widgets.open,
    ] {
        widget.corner_radius = CornerRadius::ZERO;
        widget.fg_stroke.color = palette.text;
    }
}
