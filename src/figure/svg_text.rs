//! Text in SVG, as text: it can be searched and edited. Its length is fixed, so that it also fits in another font.

use egui::epaint::TextShape;
use egui::text::TextFormat;
use egui::{Color32, FontFamily};
use kalmanscope_figures::{Anchor, Color, Svg, Text};

pub(super) fn write_text(svg: &mut Svg, shape: &TextShape) {
    let TextShape { pos, galley, fallback_color, override_text_color, opacity_factor, angle, .. } = shape;
    let ink = |format: &TextFormat| {
        let own = if format.color == Color32::PLACEHOLDER { *fallback_color } else { format.color };
        override_text_color.unwrap_or(own).gamma_multiply(*opacity_factor)
    };
    let mut byte = 0;
    for row in &galley.rows {
        let mut runs: Vec<Run<'_>> = Vec::new();
        for glyph in &row.row.glyphs {
            let section = galley.job.sections.iter().find(|s| s.byte_range.end.0 > byte).or(galley.job.sections.last());
            let Some(section) = section else { return };
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
        for Run { text, format, from, to, baseline } in runs.iter().filter(|run| !run.text.trim().is_empty()) {
            svg.text(&Text {
                text,
                origin: (*pos).into(),
                turn: angle.to_degrees(),
                at: [*from, *baseline],
                anchor: Anchor::Start,
                size: format.font_id.size,
                length: Some(to - from),
                bold: matches!(format.font_id.family, FontFamily::Name(_)),
                color: color(ink(format)),
            });
        }
    }
}

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
}

pub(super) fn color(color: Color32) -> Color {
    Color(color.to_srgba_unmultiplied())
}
