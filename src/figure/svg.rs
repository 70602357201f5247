//! The shapes of a figure as SVG.

use std::fmt::Write as _;

use egui::epaint::{BandShape, ColorMode, CubicBezierShape, PathStroke, QuadraticBezierShape, StrokeKind};
use egui::{Color32, Mesh, Pos2, Rect, Shape, Stroke};

use super::Figure;
use super::svg_attributes::{number, paint};
use super::svg_text::text;

/// The text of an SVG file: as large as the figure, with a white ground.
pub(super) fn svg(figure: &Figure) -> String {
    let [width, height] = figure.millimetres().map(number);
    let [x, y] = [figure.size.x, figure.size.y].map(number);
    let mut writer = Writer { body: String::new(), clips: Vec::new() };
    for part in &figure.parts {
        let (offset, scaling) = (part.to.translation, part.to.scaling);
        writer.line(&format!(
            "<g transform=\"translate({} {}) scale({})\">",
            number(offset.x),
            number(offset.y),
            number(scaling)
        ));
        for clipped in &part.shapes {
            writer.clipped(&clipped.shape, clipped.clip_rect);
        }
        writer.line("</g>");
    }
    let Writer { body, clips } = writer;
    let clip =
        |(i, rect): (usize, &Rect)| format!("<clipPath id=\"c{i}\">{}</clipPath>\n", rect_element(*rect, 0.0, ""));
    let clips: String = clips.iter().enumerate().map(clip).collect();
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" viewBox=\"0 0 {x} {y}\" \
         font-family=\"'Noto Sans','Noto Sans Math','DejaVu Sans',Arial,sans-serif\" stroke-linejoin=\"round\">\n\
         <title>Kalmanscope</title>\n<defs>\n{clips}</defs>\n<rect width=\"{x}\" height=\"{y}\" fill=\"#fff\"/>\n{body}</svg>\n"
    )
}

struct Writer {
    body: String,
    /// The parts of the plane that some shapes are cut off at.
    clips: Vec<Rect>,
}

impl Writer {
    fn line(&mut self, markup: &str) {
        self.body.push_str(markup);
        self.body.push('\n');
    }

    /// A shape, which is cut off only if it goes beyond the limits.
    fn clipped(&mut self, shape: &Shape, limits: Rect) {
        if let Shape::Vec(shapes) = shape {
            return shapes.iter().for_each(|shape| self.clipped(shape, limits));
        }
        let bounds = shape.visual_bounding_rect();
        if !bounds.is_finite() || !bounds.intersects(limits) {
            return;
        }
        if limits.contains_rect(bounds) {
            return self.shape(shape);
        }
        let known = self.clips.iter().position(|clip| *clip == limits);
        let id = known.unwrap_or_else(|| {
            self.clips.push(limits);
            self.clips.len() - 1
        });
        self.line(&format!("<g clip-path=\"url(#c{id})\">"));
        self.shape(shape);
        self.line("</g>");
    }

    fn shape(&mut self, shape: &Shape) {
        let element = match shape {
            Shape::Circle(circle) => format!(
                "<circle cx=\"{}\" cy=\"{}\" r=\"{}\"{}/>",
                number(circle.center.x),
                number(circle.center.y),
                number(circle.radius),
                style(circle.fill, circle.stroke)
            ),
            Shape::Ellipse(ellipse) => format!(
                "<ellipse cx=\"{}\" cy=\"{}\" rx=\"{}\" ry=\"{}\"{}/>",
                number(ellipse.center.x),
                number(ellipse.center.y),
                number(ellipse.radius.x),
                number(ellipse.radius.y),
                style(ellipse.fill, ellipse.stroke)
            ),
            Shape::LineSegment { points, stroke } => path(points, false, &style(Color32::TRANSPARENT, *stroke)),
            Shape::Path(shape) => path(&shape.points, shape.closed, &style(shape.fill, plain(&shape.stroke))),
            Shape::Band(band) => path(&outline(band), true, &style(band.fill, band.stroke)),
            Shape::Rect(rect) => {
                // A stroke in SVG lies half inside and half outside.
                let by = match rect.stroke_kind {
                    StrokeKind::Inside => -0.5 * rect.stroke.width,
                    StrokeKind::Middle => 0.0,
                    StrokeKind::Outside => 0.5 * rect.stroke.width,
                };
                let radius = f32::from(rect.corner_radius.nw);
                rect_element(rect.rect.expand(by), radius, &style(rect.fill, rect.stroke))
            }
            Shape::Text(shape) => text(shape),
            Shape::Mesh(mesh) => triangles(mesh),
            Shape::QuadraticBezier(QuadraticBezierShape { points: [a, b, c], closed, fill, stroke }) => {
                let data = format!("M{}Q{} {}{}", at(*a), at(*b), at(*c), if *closed { "Z" } else { "" });
                format!("<path d=\"{data}\"{}/>", style(*fill, plain(stroke)))
            }
            Shape::CubicBezier(CubicBezierShape { points: [a, b, c, d], closed, fill, stroke }) => {
                let data = format!("M{}C{} {} {}{}", at(*a), at(*b), at(*c), at(*d), if *closed { "Z" } else { "" });
                format!("<path d=\"{data}\"{}/>", style(*fill, plain(stroke)))
            }
            Shape::Noop | Shape::Vec(_) | Shape::Callback(_) => return,
        };
        self.line(&element);
    }
}

/// The stroke of a path; grey if its colour varies.
fn plain(stroke: &PathStroke) -> Stroke {
    match stroke.color {
        ColorMode::Solid(color) => Stroke::new(stroke.width, color),
        ColorMode::UV(_) => Stroke::new(stroke.width, Color32::GRAY),
    }
}

/// Along the upper edge of a band and back along its lower edge.
fn outline(band: &BandShape) -> Vec<Pos2> {
    let upper = band.points.iter().map(|point| Pos2::new(point.x, point.y.min));
    let lower = band.points.iter().rev().map(|point| Pos2::new(point.x, point.y.max));
    upper.chain(lower).collect()
}

fn path(points: &[Pos2], closed: bool, style: &str) -> String {
    let mut data = String::with_capacity(14 * points.len());
    for (i, point) in points.iter().enumerate() {
        data.push(if i == 0 { 'M' } else { 'L' });
        data.push_str(&at(*point));
    }
    format!("<path d=\"{data}{}\"{style}/>", if closed { "Z" } else { "" })
}

/// Triangles of one colour as one path, all turned the same way, so that no seams are seen between them.
fn triangles(mesh: &Mesh) -> String {
    let Some(color) = mesh.vertices.first().map(|vertex| vertex.color) else { return String::new() };
    let mut data = String::new();
    for triangle in mesh.indices.chunks_exact(3) {
        let Some(mut corners) = corners(mesh, triangle) else { continue };
        if (corners[1] - corners[0]).rot90().dot(corners[2] - corners[0]) < 0.0 {
            corners.swap(1, 2);
        }
        // Writing to a string cannot fail.
        let _ = write!(data, "M{}L{}L{}Z", at(corners[0]), at(corners[1]), at(corners[2]));
    }
    format!("<path d=\"{data}\"{}/>", style(color, Stroke::NONE))
}

fn corners(mesh: &Mesh, triangle: &[u32]) -> Option<[Pos2; 3]> {
    let corner = |i: usize| Some(mesh.vertices.get(*triangle.get(i)? as usize)?.pos);
    Some([corner(0)?, corner(1)?, corner(2)?])
}

fn rect_element(rect: Rect, radius: f32, style: &str) -> String {
    let round = if radius > 0.0 { format!(" rx=\"{}\"", number(radius)) } else { String::new() };
    format!(
        "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"{round}{style}/>",
        number(rect.left()),
        number(rect.top()),
        number(rect.width().max(0.0)),
        number(rect.height().max(0.0))
    )
}

/// The attributes of fill and stroke.
fn style(fill: Color32, stroke: Stroke) -> String {
    let mut style = paint("fill", fill);
    if !stroke.is_empty() {
        let _ = write!(style, "{} stroke-width=\"{}\"", paint("stroke", stroke.color), number(stroke.width));
    }
    style
}

fn at(point: Pos2) -> String {
    format!("{} {}", number(point.x), number(point.y))
}
