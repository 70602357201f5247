//! The shapes of a figure as SVG.

use egui::epaint::{BandShape, ColorMode, CubicBezierShape, PathStroke, QuadraticBezierShape, StrokeKind, TextShape};
use egui::text::TextFormat;
use egui::{Color32, FontFamily, Mesh, Pos2, Rect, Shape, Stroke};
use kalmanscope_figures::{Anchor, Color, Point, Style, Svg, Text};

use super::Figure;

pub(super) fn svg(figure: &Figure) -> String {
    let mut svg = Svg::default();
    for part in &figure.parts {
        svg.group(part.to.translation.into(), part.to.scaling, |svg| {
            part.shapes.iter().for_each(|clipped| write_clipped(svg, &clipped.shape, clipped.clip_rect));
        });
    }
    svg.finish(figure.size.into(), figure.millimetres(), "mm")
}

fn write_clipped(svg: &mut Svg, shape: &Shape, limits: Rect) {
    if let Shape::Vec(shapes) = shape {
        return shapes.iter().for_each(|shape| write_clipped(svg, shape, limits));
    }
    let bounds = shape.visual_bounding_rect();
    // Nothing of it would be seen, and the file would be larger.
    if !bounds.is_finite() || !bounds.intersects(limits) {
        return;
    }
    if limits.contains_rect(bounds) {
        return write_shape(svg, shape);
    }
    svg.clipped(area(limits), |svg| write_shape(svg, shape));
}

fn write_shape(svg: &mut Svg, shape: &Shape) {
    match shape {
        Shape::Circle(circle) => {
            svg.ellipse(circle.center.into(), [circle.radius; 2], style(circle.fill, circle.stroke));
        }
        Shape::Ellipse(ellipse) => {
            svg.ellipse(ellipse.center.into(), ellipse.radius.into(), style(ellipse.fill, ellipse.stroke));
        }
        Shape::LineSegment { points, stroke } => {
            svg.path(points.map(Point::from), false, style(Color32::TRANSPARENT, *stroke));
        }
        Shape::Path(path) => {
            let points = path.points.iter().copied().map(Point::from);
            svg.path(points, path.closed, style(path.fill, plain(&path.stroke)));
        }
        Shape::Band(band) => svg.path(outline(band), true, style(band.fill, band.stroke)),
        Shape::Rect(rect) => {
            // A stroke in SVG lies half inside and half outside.
            let by = match rect.stroke_kind {
                StrokeKind::Inside => -0.5 * rect.stroke.width,
                StrokeKind::Middle => 0.0,
                StrokeKind::Outside => 0.5 * rect.stroke.width,
            };
            let radius = f32::from(rect.corner_radius.nw);
            svg.rect(area(rect.rect.expand(by)), radius, style(rect.fill, rect.stroke));
        }
        Shape::Text(shape) => write_text(svg, shape),
        Shape::Mesh(mesh) => write_triangles(svg, mesh),
        Shape::QuadraticBezier(QuadraticBezierShape { points: [a, b, c], closed, fill, stroke }) => {
            svg.curve((*a).into(), &[(*b).into()], (*c).into(), *closed, style(*fill, plain(stroke)));
        }
        Shape::CubicBezier(CubicBezierShape { points: [a, b, c, d], closed, fill, stroke }) => {
            svg.curve((*a).into(), &[(*b).into(), (*c).into()], (*d).into(), *closed, style(*fill, plain(stroke)));
        }
        Shape::Noop | Shape::Vec(_) | Shape::Callback(_) => {}
    }
}

fn plain(stroke: &PathStroke) -> Stroke {
    match stroke.color {
        ColorMode::Solid(color) => Stroke::new(stroke.width, color),
        ColorMode::UV(_) => Stroke::new(stroke.width, Color32::GRAY),
    }
}

fn outline(band: &BandShape) -> impl Iterator<Item = Point> {
    let upper = band.points.iter().map(|point| [point.x, point.y.min]);
    let lower = band.points.iter().rev().map(|point| [point.x, point.y.max]);
    upper.chain(lower)
}

/// Triangles of one colour as one path, all turned the same way, so that no seams are seen between them.
fn write_triangles(svg: &mut Svg, mesh: &Mesh) {
    let Some(color) = mesh.vertices.first().map(|vertex| vertex.color) else { return };
    let corner = |i: u32| Some(mesh.vertices.get(i as usize)?.pos);
    let turned = |triangle: &[u32]| {
        let [a, b, c]: [Pos2; 3] = [corner(triangle[0])?, corner(triangle[1])?, corner(triangle[2])?];
        let is_turned = (b - a).rot90().dot(c - a) < 0.0;
        Some(if is_turned { [a, c, b] } else { [a, b, c] }.map(Point::from))
    };
    svg.paths(mesh.indices.chunks_exact(3).filter_map(turned), true, style(color, Stroke::NONE));
}

fn area(rect: Rect) -> [f32; 4] {
    [rect.left(), rect.top(), rect.width(), rect.height()]
}

fn style(fill: Color32, stroke: Stroke) -> Style {
    let fill = (fill != Color32::TRANSPARENT).then(|| color(fill));
    Style { fill, stroke: (!stroke.is_empty()).then(|| (color(stroke.color), stroke.width)) }
}

pub(super) fn write_text(svg: &mut Svg, shape: &TextShape) {
    let TextShape { pos, galley, fallback_color, override_text_color, opacity_factor, angle, .. } = shape;
    let ink = |format: &TextFormat| {
        let own = if format.color == Color32::PLACEHOLDER { *fallback_color } else { format.color };
        override_text_color.unwrap_or(own).gamma_multiply(*opacity_factor)
    };
    let mut byte = 0;
    for row in &galley.rows {
        let mut runs: Vec<GlyphRun<'_>> = Vec::new();
        for glyph in &row.row.glyphs {
            let section = galley.job.sections.iter().find(|s| s.byte_range.end.0 > byte).or(galley.job.sections.last());
            let Some(section) = section else { return };
            let format = &section.format;
            let start = row.pos.x + glyph.pos.x;
            match runs.last_mut() {
                Some(run) if std::ptr::eq(run.format, format) => run.add(glyph.chr, start + glyph.advance_width),
                _ => runs.push(GlyphRun {
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
        for GlyphRun { text, format, from, to, baseline } in runs.iter().filter(|run| !run.text.trim().is_empty()) {
            svg.text(&Text {
                text,
                origin: (*pos).into(),
                turn: angle.to_degrees(),
                at: [*from, *baseline],
                anchor: Anchor::Start,
                size: format.font_id.size,
                // A reader may have another font: the length keeps each text in its place.
                length: Some(to - from),
                bold: matches!(format.font_id.family, FontFamily::Name(_)),
                color: color(ink(format)),
            });
        }
    }
}

struct GlyphRun<'a> {
    text: String,
    format: &'a TextFormat,
    from: f32,
    to: f32,
    baseline: f32,
}

impl GlyphRun<'_> {
    fn add(&mut self, letter: char, to: f32) {
        self.text.push(letter);
        self.to = to;
    }
}

pub(super) fn color(color: Color32) -> Color {
    Color(color.to_srgba_unmultiplied())
}
