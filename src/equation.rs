//! The equation of a plant: printed over its picture and in the settings, and edited in its own window.

mod editor;
mod similar;

use std::sync::LazyLock;

use egui::text::LayoutJob;
use egui::{Align, Color32, FontId, TextFormat};
use kalmanscope_core::PlantKind;
use kalmanscope_core::equation::{EquationSettings, TextLevel, typeset};

pub(crate) use editor::Editor;

const FIRST: &str = "x'' + 2 ζ ωₙ x' + ωₙ² x = f";

pub(crate) const NAME: &str = "equation of your own";

pub(crate) fn first() -> Option<PlantKind> {
    // A dialog offers it each frame.
    static KIND: LazyLock<Option<PlantKind>> =
        LazyLock::new(|| PlantKind::of_equation(&EquationSettings::new(FIRST)).ok());
    KIND.clone()
}

fn typed(kind: &PlantKind) -> EquationSettings {
    if let Some(own) = kind.own_equation() {
        return own.settings().clone();
    }
    let typed = EquationSettings::new(kind.equation().replace('ẍ', "x''").replace('ẋ', "x'"));
    let is_one = *kind != PlantKind::SDOF && typed.symbols().is_ok();
    if is_one { typed } else { EquationSettings::new(FIRST) }
}

const SMALL: f32 = 0.72;

/// A line for each equation, powers raised and subscripts lowered. A text that is no equation stays unchanged.
pub(crate) fn job(text: &str, font: &FontId, color: Color32) -> LayoutJob {
    let Ok(lines) = typeset(text) else {
        return LayoutJob::simple(text.to_owned(), font.clone(), color, f32::INFINITY);
    };
    let small = FontId::new(SMALL * font.size, font.family.clone());
    let mut job = LayoutJob::default();
    for (place, line) in lines.iter().enumerate() {
        if place > 0 {
            job.append("\n", 0.0, TextFormat::simple(font.clone(), color));
        }
        for run in line {
            let (font, valign) = match run.level {
                TextLevel::Line => (font, Align::Center),
                TextLevel::Above => (&small, Align::TOP),
                TextLevel::Below => (&small, Align::BOTTOM),
            };
            job.append(&run.text, 0.0, TextFormat { valign, ..TextFormat::simple(font.clone(), color) });
        }
    }
    job
}
