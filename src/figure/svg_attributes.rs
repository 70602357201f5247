//! Colours and numbers in the attributes of SVG.

use egui::Color32;

/// The attributes of a colour.
pub(super) fn paint(attribute: &str, color: Color32) -> String {
    if color == Color32::TRANSPARENT {
        return format!(" {attribute}=\"none\"");
    }
    let [r, g, b, a] = color.to_srgba_unmultiplied();
    let opacity =
        if a < 255 { format!(" {attribute}-opacity=\"{}\"", number(f32::from(a) / 255.0)) } else { String::new() };
    format!(" {attribute}=\"#{r:02x}{g:02x}{b:02x}\"{opacity}")
}

/// A number to two decimals, without zeros at its end.
pub(super) fn number(value: f32) -> String {
    let text = format!("{value:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}
