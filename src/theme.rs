//! Colours, fonts and spacing, all in one place.

pub(crate) mod palette;

pub use palette::Palette;

use std::sync::Arc;

use egui::{
    Context, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, FullOutput, Margin, Plugin, Stroke,
    TextStyle, TextureId, TextureOptions, Theme, Vec2,
};

pub fn install(ctx: &egui::Context) {
    ctx.set_fonts(definitions());
    ctx.add_plugin(Texels);
    for theme in [Theme::Light, Theme::Dark] {
        ctx.style_mut_of(theme, |style| restyle(style, theme));
    }
}

pub fn strong() -> FontFamily {
    FontFamily::Name(STRONG.into())
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

pub(super) const STRONG: &str = "strong";

macro_rules! font {
    ($name:literal) => {
        ($name, include_bytes!(concat!("../assets/fonts/", $name, ".subset.ttf")).as_slice())
    };
}

const SYMBOLS: [(&str, &[u8]); 3] =
    [font!("NotoSansMath-Regular"), font!("NotoSansSymbols-Regular"), font!("NotoSansSymbols2-Regular")];

pub(super) fn definitions() -> FontDefinitions {
    let regular = font!("NotoSans-Regular");
    let bold = font!("NotoSans-Bold");
    let mut fonts = FontDefinitions::empty();
    for (name, data) in [regular, bold].into_iter().chain(SYMBOLS) {
        fonts.font_data.insert(name.to_owned(), Arc::new(FontData::from_static(data)));
    }
    for (family, first) in [
        (FontFamily::Proportional, &[regular.0][..]),
        (FontFamily::Monospace, &[regular.0]),
        // The bold font has fewer letters.
        (FontFamily::Name(STRONG.into()), &[bold.0, regular.0]),
    ] {
        let names = first.iter().copied().chain(SYMBOLS.map(|(name, _)| name)).map(str::to_owned).collect();
        fonts.families.insert(family, names);
    }
    fonts
}

/// Draws glyphs and dots texel by texel. Glyphs have the size of the screen in their texture and are aligned to pixels,
/// so that this changes nothing. Without a graphics card, interpolation would cost as much as everything else together.
pub(super) struct Texels;

impl Plugin for Texels {
    fn debug_name(&self) -> &'static str {
        "texels"
    }

    fn output_hook(&mut self, _ctx: &Context, output: &mut FullOutput) {
        for delta in output.textures_delta.set.get_mut(&TextureId::default()).into_iter().flatten() {
            delta.options = TextureOptions::NEAREST;
        }
    }
}
