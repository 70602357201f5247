//! The fonts: subsets of Noto Sans, with the mathematics and the few icons that the interface uses.

use std::sync::Arc;

use egui::{FontData, FontDefinitions, FontFamily};

pub(super) const STRONG: &str = "strong";

macro_rules! font {
    ($name:literal) => {
        ($name, include_bytes!(concat!("../../assets/fonts/", $name, ".subset.ttf")).as_slice())
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
