//! Lines with soft edges, in two triangles per segment, because every frame draws many lines.
//!
//! egui draws a line as three strips of triangles, the outer ones fading to nothing. Here a line is one strip, and a
//! texture holds the cross-sections of lines of all widths.

use egui::epaint::{BandPoint, BandShape, Vertex};
use egui::{
    Color32, ColorImage, Context, Id, Mesh, Pos2, Rangef, Shape, Stroke, TextureHandle, TextureOptions, Vec2, pos2,
    vec2,
};

use super::medium::Medium;

/// Step between the widths that have a cross-section \[pixels\].
const STEP: f32 = 0.25;

const ROWS: usize = 64;
const COLUMNS: usize = 64;

pub(crate) struct Strokes {
    canvas: Canvas,
    pixel: f32,
}

enum Canvas {
    Mesh(Mesh),
    Shapes(Vec<Shape>),
}

impl Strokes {
    pub(crate) fn new(ctx: &Context) -> Self {
        let canvas = match Medium::of(ctx) {
            Medium::Screen => Canvas::Mesh(Mesh::with_texture(profiles(ctx).id())),
            Medium::Figure => Canvas::Shapes(Vec::new()),
        };
        Self { canvas, pixel: 1.0 / ctx.pixels_per_point() }
    }

    pub(crate) fn on_a_pixel(&self, position: f32) -> f32 {
        ((position / self.pixel).floor() + 0.5) * self.pixel
    }

    pub(crate) fn line(&mut self, points: &[Pos2], stroke: Stroke) {
        if let &[alone] = points {
            let half = vec2(0.5 * stroke.width, 0.0);
            return self.line(&[alone - half, alone + half], stroke);
        }
        let Self { canvas, pixel } = self;
        match canvas {
            Canvas::Mesh(mesh) => {
                let brush = Brush::new(stroke, *pixel);
                reserve(mesh, points.len());
                let strip = |joint: Joint| add_rung(mesh, &brush.ends(joint.at, joint.normal), joint.goes_on);
                joints(points, [0.5 * *pixel, 0.5 * brush.reach], strip);
            }
            Canvas::Shapes(shapes) => shapes.push(Shape::line(points.to_vec(), stroke)),
        }
    }

    /// Draws a dashed line. A line too long for dashes, such as one that crosses the plot in every pixel, is drawn
    /// solid.
    pub(crate) fn dashed(&mut self, points: &[Pos2], stroke: Stroke, (dash, gap): (f32, f32)) {
        let length: f32 = points.windows(2).map(|ends| ends[0].distance(ends[1])).sum();
        if length.is_nan() || length > LONGEST_DASHED {
            return self.line(points, stroke);
        }
        for dash in Shape::dashed_line(points, stroke, dash, gap) {
            if let Shape::LineSegment { points, stroke } = dash {
                self.line(&points, stroke);
            }
        }
    }

    pub(crate) fn area(&mut self, columns: &[[Pos2; 2]], fill: Color32) {
        match &mut self.canvas {
            Canvas::Mesh(mesh) => {
                reserve(mesh, columns.len());
                for (i, ends) in columns.iter().enumerate() {
                    // The middle of the widest line is fully opaque.
                    add_rung(mesh, &ends.map(|pos| Vertex { pos, uv: pos2(0.5, 1.0), color: fill }), i > 0);
                }
            }
            Canvas::Shapes(shapes) => {
                if columns.iter().any(|[a, b]| a.x != b.x) {
                    // From top to bottom, as trails are.
                    let back = columns.iter().rev().map(|ends| ends[1]);
                    let outline = columns.iter().map(|ends| ends[0]).chain(back).collect();
                    return shapes.push(Shape::convex_polygon(outline, fill, Stroke::NONE));
                }
                let rung = |[a, b]: &[Pos2; 2]| BandPoint::new(a.x, Rangef::new(a.y.min(b.y), a.y.max(b.y)));
                shapes.push(Shape::Band(BandShape::filled(columns.iter().map(rung).collect(), fill)));
            }
        }
    }

    pub(crate) fn into_shape(self) -> Shape {
        match self.canvas {
            Canvas::Mesh(mesh) => Shape::mesh(mesh),
            Canvas::Shapes(shapes) => Shape::Vec(shapes),
        }
    }
}

/// Limits the length of a dashed line, which is some ten thousand dashes \[points\].
const LONGEST_DASHED: f32 = 100_000.0;

struct Brush {
    color: Color32,
    /// Half the width with the soft edge \[points\].
    reach: f32,
    row: f32,
}

impl Brush {
    fn new(stroke: Stroke, pixel: f32) -> Self {
        // A line wider than any in the texture has slightly softer edges.
        let widest = STEP * ROWS as f32;
        let width = stroke.width / pixel;
        let row = (width.clamp(STEP, widest) / STEP - 0.5) / ROWS as f32;
        Self { color: stroke.color, reach: 0.5 * (width + (width / widest).max(1.0)) * pixel, row }
    }

    fn ends(&self, at: Pos2, normal: Vec2) -> [Vertex; 2] {
        let Self { color, reach, row } = *self;
        let edge = normal * reach;
        [Vertex { pos: at + edge, uv: pos2(0.0, row), color }, Vertex { pos: at - edge, uv: pos2(1.0, row), color }]
    }
}

fn reserve(mesh: &mut Mesh, rungs: usize) {
    mesh.reserve_vertices(2 * rungs);
    mesh.reserve_triangles(2 * rungs);
}

#[inline]
fn add_rung(mesh: &mut Mesh, ends: &[Vertex; 2], on: bool) {
    let next = mesh.vertices.len() as u32;
    mesh.vertices.extend_from_slice(ends);
    if on {
        mesh.indices.extend_from_slice(&[next - 2, next - 1, next, next - 1, next, next + 1]);
    }
}

#[derive(Clone, Copy, Debug)]
struct Joint {
    at: Pos2,
    /// The direction to the strip's left edge, for a width of two.
    normal: Vec2,
    goes_on: bool,
}

/// The joints of a line. A corner sharper than a right angle ends one strip and begins another. Strips extend a little
/// beyond their ends, by one length at the line's ends and another at corners.
fn joints(points: &[Pos2], [beyond_end, beyond_corner]: [f32; 2], mut visit: impl FnMut(Joint)) {
    let Some((&(mut at), others)) = points.split_first() else { return };
    let begin = |at: Pos2, normal: Vec2, by: f32| Joint { at: at + by * normal.rot90(), normal, goes_on: false };
    let end = |at: Pos2, normal: Vec2, by: f32| Joint { at: at - by * normal.rot90(), normal, goes_on: true };
    let mut last: Option<Vec2> = None;
    for &next in others {
        let way = next - at;
        // Not `length`, which is slow because it guards against overflow.
        let length = way.length_sq().sqrt();
        if length.is_nan() || length == 0.0 {
            continue;
        }
        let normal = way.rot90() / length;
        if let Some(before) = last {
            let middle = 0.5 * (before + normal);
            let square = middle.length_sq();
            if square < 0.5 {
                visit(end(at, before, beyond_corner));
                visit(begin(at, normal, beyond_corner));
            } else {
                visit(Joint { at, normal: middle / square, goes_on: true });
            }
        } else {
            visit(begin(at, normal, beyond_end));
        }
        (at, last) = (next, Some(normal));
    }
    if let Some(normal) = last {
        visit(end(at, normal, beyond_end));
    }
}

/// The texture with the cross-sections, one per row: the coverage of a pixel from one edge to the other.
fn profiles(ctx: &Context) -> TextureHandle {
    let id = Id::unique("cross-sections of lines");
    if let Some(texture) = ctx.data(|data| data.get_temp(id)) {
        return texture;
    }
    let texel = |row: usize, column: usize| {
        let width = STEP * (row + 1) as f32;
        let from_middle = ((column as f32 + 0.5) / COLUMNS as f32 - 0.5).abs() * (width + 1.0);
        let covered = (0.5 * (width + 1.0) - from_middle).min(width).min(1.0);
        Color32::from_white_alpha((255.0 * covered).round() as u8)
    };
    let texels = (0..ROWS).flat_map(|row| (0..COLUMNS).map(move |column| texel(row, column))).collect();
    let image = ColorImage::new([COLUMNS, ROWS], texels);
    // Its texels are finer than pixels, so that no interpolation is needed, which is slow in a software renderer.
    let texture = ctx.load_texture("cross-sections of lines", image, TextureOptions::NEAREST);
    ctx.data_mut(|data| data.insert_temp(id, texture.clone()));
    texture
}

#[cfg(test)]
mod tests {
    use super::*;

    fn along(points: &[(f32, f32)]) -> Vec<Joint> {
        let points: Vec<Pos2> = points.iter().map(|&(x, y)| pos2(x, y)).collect();
        let mut visited = Vec::new();
        joints(&points, [0.5, 1.0], |joint| visited.push(joint));
        visited
    }

    #[test]
    fn a_line_is_as_wide_after_a_bend() {
        let bent = along(&[(0.0, 0.0), (10.0, 0.0), (10.0, 0.0), (20.0, 10.0)]);
        assert_eq!(bent.len(), 3, "a point that comes twice is one");
        assert_eq!((bent[0].at, bent[1].at), (pos2(-0.5, 0.0), pos2(10.0, 0.0)));
        for way in [vec2(1.0, 0.0), vec2(1.0, 1.0).normalized()] {
            let across = way.rot90().dot(bent[1].normal);
            assert!((across - 1.0).abs() < 1e-5, "{across}");
        }
    }

    #[test]
    fn a_line_that_is_too_long_for_dashes_is_drawn_through() {
        let shapes = |end: f32| {
            let mut strokes = Strokes { canvas: Canvas::Shapes(Vec::new()), pixel: 1.0 };
            strokes.dashed(&[pos2(0.0, 0.0), pos2(end, 0.0)], Stroke::new(1.0, Color32::BLACK), (5.0, 3.0));
            let Canvas::Shapes(shapes) = strokes.canvas else { panic!("it was no mesh") };
            shapes.len()
        };
        assert_eq!([80.0, 1e30, f32::INFINITY, f32::NAN].map(shapes), [10, 1, 1, 1]);
    }

    #[test]
    fn sharp_corners_are_two_ends() {
        for tip in [0.0, 1e-5, 0.5, 3.0] {
            let peak = along(&[(0.0, 0.0), (0.0, 50.0), (tip, 0.0)]);
            assert_eq!(peak.iter().map(|joint| joint.goes_on).collect::<Vec<_>>(), [false, true, false, true]);
            assert!((peak[1].at - pos2(0.0, 51.0)).length() < 1e-3, "{peak:?}");
            assert!(peak.iter().all(|joint| (joint.normal.length() - 1.0).abs() < 1e-5), "{peak:?}");
        }
    }

    #[test]
    fn lines_without_length_have_no_joints() {
        assert!(along(&[]).is_empty());
        assert!(along(&[(1.0, 1.0), (1.0, 1.0)]).is_empty());
        assert_eq!(along(&[(0.0, 0.0), (f32::NAN, 1.0), (2.0, 0.0)]).len(), 2);
    }

    #[test]
    fn strokes_take_two_triangles_per_segment() {
        let ctx = Context::default();
        let mut strokes = Strokes::new(&ctx);
        let stroke = Stroke::new(2.0, Color32::RED);
        strokes.line(&[pos2(0.0, 0.0), pos2(10.0, 0.0), pos2(20.0, 5.0)], stroke);
        strokes.line(&[pos2(5.0, 5.0)], stroke);
        strokes.area(&[[pos2(0.0, 0.0), pos2(0.0, 1.0)], [pos2(1.0, 0.0), pos2(1.0, 1.0)]], Color32::BLUE);
        let Shape::Mesh(mesh) = strokes.into_shape() else { panic!("a screen gets one mesh") };
        assert_eq!(mesh.indices.len(), 3 * 2 * (2 + 1 + 1));
        assert!(mesh.is_valid());
    }

    #[test]
    fn a_figure_has_outlines() {
        let ctx = Context::default();
        Medium::Figure.set(&ctx);
        let mut strokes = Strokes::new(&ctx);
        let points = [pos2(0.0, 0.0), pos2(10.0, 0.0), pos2(20.0, 5.0)];
        strokes.line(&points, Stroke::new(2.0, Color32::RED));
        strokes.area(&[[pos2(0.0, 3.0), pos2(0.0, 1.0)], [pos2(1.0, 0.0), pos2(1.0, 1.0)]], Color32::BLUE);
        let Shape::Vec(shapes) = strokes.into_shape() else { panic!("a figure gets shapes") };
        let [Shape::Path(line), Shape::Band(band)] = &shapes[..] else { panic!("{shapes:?}") };
        assert_eq!(line.points, points);
        assert_eq!(band.points, [BandPoint::new(0.0, 1.0..=3.0), BandPoint::new(1.0, 0.0..=1.0)]);
    }
}
