//! Text in SVG, as text: it can be searched and edited. Its length is fixed, so that it also fits in another font.

use std::fmt::Write as _;

use egui::epaint::TextShape;
use egui::text::TextFormat;
use egui::{Color32, FontFamily};
use kalmanscope_cli::escaped;

use super::svg_attributes::{number, paint};

/// The elements of a text: one for each row and format.
pub(super) fn text(shape: &TextShape) -> String {
    let TextShape { pos, galley, fallback_color, override_text_color, opacity_factor, angle, .. } = shape;
    let color = |format: &TextFormat| {
        let own = if format.color == Color32::PLACEHOLDER { *fallback_color } else { format.color };
        override_text_color.unwrap_or(own).gamma_multiply(*opacity_factor)
    };
    let place = if *angle == 0.0 {
        format!("translate({} {})", number(pos.x), number(pos.y))
    } else {
        format!("translate({} {}) rotate({})", number(pos.x), number(pos.y), number(angle.to_degrees()))
    };
    let mut elements = String::new();
    let mut byte = 0;
    for row in &galley.rows {
        let mut runs: Vec<Run<'_>> = Vec::new();
        for glyph in &row.row.glyphs {
            let section = galley.job.sections.iter().find(|s| s.byte_range.end.0 > byte).or(galley.job.sections.last());
            let Some(section) = section else { return elements };
            let format = &section.format;
            let start = row.pos.x + glyph.pos.x;
            match runs.last_mut() {
                Some(run) if std::ptr::eq(run.format, format) => run.add(glyph.chr, start + glyph.advance_width),
                _ => runs.push(Run {
                    text: glyph.chr.to_string(),
                    format,
                    from: start,
                    to: start + glyph.advance_width,
                    baseline: row.pos.y + glyph.pos.y,
                }),
            }
            byte += glyph.chr.len_utf8();
        }
        byte += usize::from(row.ends_with_newline);
        for run in runs.iter().filter(|run| !run.text.trim().is_empty()) {
            // Writing to a string cannot fail.
            let _ = write!(elements, "{}", run.element(&place, color(run.format)));
        }
    }
    elements
}

/// Letters of one format in one row.
struct Run<'a> {
    text: String,
    format: &'a TextFormat,
    from: f32,
    to: f32,
    baseline: f32,
}

impl Run<'_> {
    fn add(&mut self, letter: char, to: f32) {
        self.text.push(letter);
        self.to = to;
    }

    fn element(&self, place: &str, color: Color32) -> String {
        let Self { text, format, from, to, baseline } = self;
        let weight = match format.font_id.family {
            FontFamily::Name(_) => " font-weight=\"bold\"",
            FontFamily::Proportional | FontFamily::Monospace => "",
        };
        format!(
            "<text transform=\"{place}\" x=\"{}\" y=\"{}\" font-size=\"{}\" textLength=\"{}\" \
             lengthAdjust=\"spacingAndGlyphs\" xml:space=\"preserve\"{weight}{}>{}</text>",
            number(*from),
            number(*baseline),
            number(format.font_id.size),
            number((to - from).max(0.01)),
            paint("fill", color),
            escaped(text)
        )
    }
}
