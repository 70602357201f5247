//! Colours of numbers, distinguishable with any colour vision.

use egui::Color32;

use super::Palette;

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

pub fn sequential(share: f32) -> Color32 {
    between(&SEQUENTIAL, share)
}

pub fn diverging(share: f32, palette: &Palette) -> Color32 {
    let [r, g, b, _] = palette.faint.to_array();
    let is_dark = palette.ground.intensity() < 0.5;
    let [low, lower, higher, high] = if is_dark { DIVERGING_ON_DARK } else { DIVERGING };
    between(&[low, lower, [r, g, b], higher, high], share)
}

pub fn kind(place: usize) -> Color32 {
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
