//! The colours.

use egui::{Color32, Theme};
use kalmanscope_core::FilterColor;

/// Every colour of one theme.
///
/// Filters have the colours of Okabe and Ito, which colour-blind readers can distinguish, a little lighter on dark
/// ground.
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
