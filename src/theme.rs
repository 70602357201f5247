//! Colours, fonts and spacing, all in one place.

use std::collections::BTreeMap;
use std::sync::Arc;

use egui::{
    Color32, Context, CornerRadius, FontData, FontDefinitions, FontFamily, FontId, FullOutput, Margin, Plugin, Stroke,
    TextStyle, TextureId, TextureOptions, Theme, Vec2,
};
use kalmanscope_core::FilterColor;

pub fn install(ctx: &egui::Context) {
    ctx.set_fonts(definitions());
    ctx.add_plugin(Texels);
    for theme in [Theme::Light, Theme::Dark] {
        ctx.style_mut_of(theme, |style| restyle(style, theme));
    }
}

pub(crate) fn other(ctx: &egui::Context) -> (Theme, &'static str) {
    match ctx.theme() {
        Theme::Dark => (Theme::Light, "Light theme"),
        Theme::Light => (Theme::Dark, "Dark theme"),
    }
}

pub fn strong() -> FontFamily {
    FontFamily::Name(STRONG.into())
}

pub(crate) fn story() -> TextStyle {
    TextStyle::Name("story".into())
}

pub(crate) fn title() -> TextStyle {
    TextStyle::Name("title".into())
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

const FINGER: f32 = 40.0;

/// Fits the sizes of texts to a window of this width \[points\]; in a lecture hall the numbers are larger.
pub(crate) fn fit_text(ctx: &Context, width: f32, presenting: bool) {
    let sizes = sizes(width, presenting);
    if ctx.global_style().text_styles != sizes {
        ctx.all_styles_mut(|style| style.text_styles = sizes.clone());
    }
}

pub(crate) fn level_text(ctx: &egui::Context, size: f32) {
    ctx.all_styles_mut(|style| style.text_styles.values_mut().for_each(|font| font.size = size));
}

/// Sizes are those of the table at this width, and larger in a wider window, up to a limit \[points\].
const USUAL_WIDTH: f32 = 1280.0;
const LARGEST: f32 = 1.3;
/// Limits the width of a window whose story is as small as its other texts \[points\].
const NARROW: f32 = 720.0;

fn sizes(width: f32, presenting: bool) -> BTreeMap<TextStyle, FontId> {
    let scale = (0.5 + 0.5 * width / USUAL_WIDTH).clamp(1.0, LARGEST);
    // Half points: each other size would draw all glyphs again while a window is made wider.
    let size = |style, size: f32, family| (style, FontId::new((2.0 * scale * size).round() / 2.0, family));
    let plain = |style, points| size(style, points, FontFamily::Proportional);
    [
        plain(story(), if width < NARROW { 15.0 } else { 18.0 }),
        size(TextStyle::Heading, 17.0, strong()),
        size(symbol(), 16.0, strong()),
        plain(title(), 15.0),
        plain(readout(), if presenting { 20.0 } else { 13.5 }),
        plain(TextStyle::Body, 13.5),
        plain(TextStyle::Button, 13.5),
        plain(TextStyle::Monospace, 13.0),
        plain(TextStyle::Small, 12.0),
    ]
    .into()
}

fn restyle(style: &mut egui::Style, theme: Theme) {
    let palette = Palette::of(theme);
    style.text_styles = sizes(USUAL_WIDTH, false);
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

/// Filters have the colours of Okabe and Ito, for readers with any colour vision, a little lighter on dark ground.
#[derive(Clone, Copy, Debug, Hash)]
pub struct Palette {
    pub ground: Color32,
    pub faint: Color32,
    pub separator: Color32,
    pub grid: Color32,
    pub text: Color32,
    pub weak: Color32,
    pub accent: Color32,
    pub on_accent: Color32,
    pub warning: Color32,
    pub truth: Color32,
    pub measured: Color32,
    pub force: Color32,
    shades: [Color32; 6],
}

const LIGHT: Palette = Palette {
    ground: Color32::WHITE,
    faint: Color32::from_rgb(0xea, 0xed, 0xf1),
    separator: Color32::from_rgb(0xd8, 0xdc, 0xe2),
    grid: Color32::from_rgb(0xa6, 0xae, 0xba),
    text: Color32::from_rgb(0x1d, 0x23, 0x2c),
    weak: Color32::from_rgb(0x5b, 0x65, 0x73),
    accent: Color32::from_rgb(0x2b, 0x5c, 0x9e),
    on_accent: Color32::WHITE,
    warning: Color32::from_rgb(0xb0, 0x2a, 0x1c),
    truth: Color32::from_rgb(0x22, 0x28, 0x30),
    measured: Color32::from_rgba_premultiplied(0x38, 0x3e, 0x48, 0x90),
    force: Color32::from_rgb(0x80, 0x86, 0x90),
    shades: LIGHT_SHADES,
};

const LIGHT_SHADES: [Color32; 6] = [
    Color32::from_rgb(0x00, 0x72, 0xb2),
    Color32::from_rgb(0xd5, 0x5e, 0x00),
    Color32::from_rgb(0x00, 0x9e, 0x73),
    Color32::from_rgb(0xb8, 0x5c, 0x94),
    Color32::from_rgb(0xc0, 0x88, 0x00),
    Color32::from_rgb(0x3a, 0x9a, 0xd0),
];

const DARK: Palette = Palette {
    ground: Color32::from_rgb(0x15, 0x19, 0x1f),
    faint: Color32::from_rgb(0x26, 0x2b, 0x34),
    separator: Color32::from_rgb(0x33, 0x3a, 0x45),
    grid: Color32::from_rgb(0x80, 0x88, 0x94),
    text: Color32::from_rgb(0xe4, 0xe8, 0xee),
    weak: Color32::from_rgb(0x9c, 0xa6, 0xb4),
    accent: Color32::from_rgb(0x3c, 0x78, 0xc2),
    on_accent: Color32::WHITE,
    warning: Color32::from_rgb(0xff, 0x8a, 0x75),
    truth: Color32::from_rgb(0xee, 0xf1, 0xf5),
    measured: Color32::from_rgba_premultiplied(0x60, 0x66, 0x70, 0x80),
    force: Color32::from_rgb(0x90, 0x98, 0xa4),
    shades: DARK_SHADES,
};

const DARK_SHADES: [Color32; 6] = [
    Color32::from_rgb(0x4d, 0xa9, 0xe8),
    Color32::from_rgb(0xf2, 0x82, 0x35),
    Color32::from_rgb(0x2c, 0xc1, 0x95),
    Color32::from_rgb(0xdd, 0x8f, 0xbd),
    Color32::from_rgb(0xe6, 0xb0, 0x2e),
    Color32::from_rgb(0x8f, 0xd0, 0xf5),
];

impl Palette {
    pub const fn of(theme: Theme) -> Self {
        match theme {
            Theme::Light => LIGHT,
            Theme::Dark => DARK,
        }
    }

    pub const fn shade(&self, color: FilterColor) -> Color32 {
        self.shades[color as usize]
    }
}

// Viridis: its lightness rises evenly, for colour-blind readers and in grey too.
const SEQUENTIAL: [[u8; 3]; 9] = [
    [68, 1, 84],
    [71, 44, 122],
    [59, 81, 139],
    [44, 113, 142],
    [33, 144, 141],
    [39, 173, 129],
    [92, 200, 99],
    [170, 220, 50],
    [253, 231, 37],
];

/// The ends and the middles of the sides of a diverging ramp, from low to high: blue and orange.
const DIVERGING: [[u8; 3]; 4] = [[14, 77, 140], [96, 160, 212], [232, 152, 88], [158, 58, 4]];
const DIVERGING_ON_DARK: [[u8; 3]; 4] = [[130, 200, 255], [48, 112, 172], [176, 92, 32], [255, 182, 110]];

const KINDS: [[u8; 3]; 9] = [
    [0, 158, 115],
    [86, 180, 233],
    [240, 228, 66],
    [0, 114, 178],
    [230, 159, 0],
    [204, 121, 167],
    [213, 94, 0],
    [120, 40, 20],
    [60, 60, 66],
];

pub(crate) fn sequential(share: f32) -> Color32 {
    between(&SEQUENTIAL, share)
}

pub(crate) fn diverging(share: f32, palette: &Palette) -> Color32 {
    let [r, g, b, _] = palette.faint.to_array();
    let is_dark = palette.ground.intensity() < 0.5;
    let [low, lower, higher, high] = if is_dark { DIVERGING_ON_DARK } else { DIVERGING };
    between(&[low, lower, [r, g, b], higher, high], share)
}

pub(crate) fn kind(place: usize) -> Color32 {
    let [r, g, b] = KINDS[place % KINDS.len()];
    Color32::from_rgb(r, g, b)
}

fn between(colors: &[[u8; 3]], share: f32) -> Color32 {
    let last = colors.len() - 1;
    let place = share.clamp(0.0, 1.0) * last as f32;
    let low = (place as usize).min(last - 1);
    let part = place - low as f32;
    let [r, g, b] = std::array::from_fn(|i| {
        let (from, to) = (f32::from(colors[low][i]), f32::from(colors[low + 1][i]));
        (from + part * (to - from)).round() as u8
    });
    Color32::from_rgb(r, g, b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_grows_along_the_sequential_ramp() {
        let light: Vec<f32> = (0..=40).map(|i| sequential(i as f32 / 40.0).intensity()).collect();
        assert!(light.windows(2).all(|pair| pair[0] < pair[1]), "{light:?}");
        assert_eq!(sequential(2.0), sequential(1.0));
    }

    #[test]
    fn the_middle_of_the_diverging_ramp_is_quiet() {
        for theme in [egui::Theme::Light, egui::Theme::Dark] {
            let palette = Palette::of(theme);
            assert_eq!(diverging(0.5, &palette), palette.faint);
            assert_ne!(diverging(0.0, &palette), diverging(1.0, &palette));
        }
    }
}
