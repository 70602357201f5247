//! The shapes of a figure as pixels, without a graphics card.

use egui::epaint::{ClippedPrimitive, ClippedShape, Primitive, Vertex};
use egui::{Color32, ColorImage, Mesh, Pos2, Rect};
use thiserror::Error;

use super::Figure;
use super::canvas::Part;
use super::format::MILLIMETRES_PER_POINT;

/// The reason why a picture could not be encoded.
#[derive(Debug, Error)]
#[error("the picture cannot be encoded: {0}")]
pub struct PngError(#[from] png::EncodingError);

/// A PNG file of the figure on white.
pub(super) fn png(figure: &Figure) -> Result<Vec<u8>, PngError> {
    let shapes: Vec<ClippedShape> = figure.parts.iter().flat_map(Part::placed).collect();
    let ctx = figure.canvas.ctx();
    let primitives = ctx.tessellate(shapes, figure.density);
    #[expect(clippy::redundant_closure_for_method_calls, reason = "the method itself is not general enough")]
    let glyphs = ctx.fonts(|fonts| fonts.image());
    let [width, height] = [figure.size.x, figure.size.y].map(|length| (length * figure.density).round() as usize);
    let mut pixels = Pixels::new(width, height, glyphs);
    for ClippedPrimitive { clip_rect, primitive } in &primitives {
        if let Primitive::Mesh(mesh) = primitive {
            pixels.mesh(mesh, *clip_rect, figure.density);
        }
    }
    encoded(&pixels, figure.density / figure.scale / MILLIMETRES_PER_POINT)
}

/// Encodes pixels as a PNG file with `per_millimetre` pixels per millimetre.
fn encoded(pixels: &Pixels, per_millimetre: f32) -> Result<Vec<u8>, PngError> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, pixels.width as u32, pixels.height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let per_metre = (1000.0 * per_millimetre).round() as u32;
    encoder.set_pixel_dims(Some(png::PixelDimensions { xppu: per_metre, yppu: per_metre, unit: png::Unit::Meter }));
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&pixels.bytes())?;
    writer.finish()?;
    Ok(file)
}

/// A picture under way.
struct Pixels {
    width: usize,
    height: usize,
    /// Red, green and blue of each pixel, from 0 to 255.
    colors: Vec<[f32; 3]>,
    /// The texture of all triangles: glyphs and discs.
    glyphs: ColorImage,
}

impl Pixels {
    fn new(width: usize, height: usize, glyphs: ColorImage) -> Self {
        Self { width, height, colors: vec![[255.0; 3]; width * height], glyphs }
    }

    fn bytes(&self) -> Vec<u8> {
        self.colors.iter().flatten().map(|value| value.round().clamp(0.0, 255.0) as u8).collect()
    }

    /// Fills the triangles of a mesh within limits \[points\].
    fn mesh(&mut self, mesh: &Mesh, limits: Rect, density: f32) {
        let edge = |position: f32, most: usize| (position * density).round().clamp(0.0, most as f32) as usize;
        let columns = edge(limits.left(), self.width)..edge(limits.right(), self.width);
        let rows = edge(limits.top(), self.height)..edge(limits.bottom(), self.height);
        for triangle in mesh.indices.chunks_exact(3) {
            let corner = |i: usize| mesh.vertices.get(triangle[i] as usize);
            if let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) {
                self.triangle([a, b, c], (&columns, &rows), density);
            }
        }
    }

    /// Fills the pixels that have their middle in a triangle. A middle on an edge belongs to the triangle to the right
    /// of it, or below it.
    fn triangle(
        &mut self,
        mut corners: [&Vertex; 3],
        (columns, rows): (&std::ops::Range<usize>, &std::ops::Range<usize>),
        density: f32,
    ) {
        let mut at = corners.map(|corner| corner.pos * density);
        let mut area = cross(at[0], at[1], at[2]);
        if area < 0.0 {
            corners.swap(1, 2);
            at.swap(1, 2);
            area = -area;
        }
        if area.is_nan() || area == 0.0 {
            return;
        }
        let bounds = Rect::from_points(&at);
        let first = |low: f32, least: usize| ((low - 0.5).ceil().max(0.0) as usize).max(least);
        let last = |high: f32, most: usize| ((high - 0.5).floor().max(-1.0) + 1.0).min(most as f32) as usize;
        let edges = [(at[1], at[2]), (at[2], at[0]), (at[0], at[1])];
        let owns = edges.map(|(from, to)| to.y < from.y || (to.y == from.y && to.x > from.x));
        // Most triangles have one colour and no texture.
        let is_plain = corners.iter().all(|c| (c.color, c.uv) == (corners[0].color, corners[0].uv));
        let plain = is_plain.then(|| self.shade(corners, [1.0, 0.0, 0.0]));
        let whole = (first(bounds.left(), columns.start), last(bounds.right(), columns.end));
        for y in first(bounds.top(), rows.start)..last(bounds.bottom(), rows.end) {
            let (from, to) = span(edges, y, whole);
            for x in from..to {
                let middle = Pos2::new(x as f32 + 0.5, y as f32 + 0.5);
                let weights = edges.map(|(from, to)| cross(from, to, middle));
                let inside = weights.iter().zip(owns).all(|(weight, owns)| *weight > 0.0 || (*weight == 0.0 && owns));
                if inside {
                    let color = plain.unwrap_or_else(|| self.shade(corners, weights.map(|weight| weight / area)));
                    self.blend(x, y, color);
                }
            }
        }
    }

    /// The colour at a point with these weights of the corners, multiplied by the texture.
    fn shade(&self, corners: [&Vertex; 3], weights: [f32; 3]) -> [f32; 4] {
        let mixed = |value: &dyn Fn(&Vertex) -> f32| -> f32 {
            corners.iter().zip(weights).map(|(corner, weight)| value(corner) * weight).sum()
        };
        let texel = self.texel(mixed(&|v| v.uv.x), mixed(&|v| v.uv.y));
        std::array::from_fn(|i| mixed(&|v| f32::from(v.color.to_array()[i])) * texel[i])
    }

    /// The texture between its texels, each from 0 to 1.
    fn texel(&self, u: f32, v: f32) -> [f32; 4] {
        let [width, height] = self.glyphs.size;
        if width == 0 || height == 0 {
            return [1.0; 4];
        }
        let (x, y) = (u * width as f32 - 0.5, v * height as f32 - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let (right_share, low_share) = (x - left, y - top);
        let of = |dx: f32, dy: f32| -> Color32 {
            let x = (left + dx).clamp(0.0, (width - 1) as f32) as usize;
            let y = (top + dy).clamp(0.0, (height - 1) as f32) as usize;
            self.glyphs.pixels[y * width + x]
        };
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(dx, dy)| of(dx, dy).to_array());
        std::array::from_fn(|i| {
            let [a, b, c, d] = corners.map(|corner| f32::from(corner[i]) / 255.0);
            (a + (b - a) * right_share) * (1.0 - low_share) + (c + (d - c) * right_share) * low_share
        })
    }

    /// Lays a colour, multiplied by its opacity, over a pixel.
    fn blend(&mut self, x: usize, y: usize, [r, g, b, a]: [f32; 4]) {
        let below = 1.0 - a / 255.0;
        if let Some(color) = self.colors.get_mut(y * self.width + x) {
            *color = [r + color[0] * below, g + color[1] * below, b + color[2] * below];
        }
    }
}

/// The columns of a row that may be inside three edges, with one to spare at either end.
fn span(edges: [(Pos2, Pos2); 3], y: usize, (mut first, mut last): (usize, usize)) -> (usize, usize) {
    let begin = Pos2::new(first as f32 + 0.5, y as f32 + 0.5);
    let start = first as f32;
    for (from, to) in edges {
        let (weight, per_column) = (cross(from, to, begin), from.y - to.y);
        let crossing = start - weight / per_column;
        if per_column > 0.0 {
            first = first.max((crossing - 1.0).max(0.0) as usize);
        } else if per_column < 0.0 {
            last = last.min((crossing + 2.0).max(0.0) as usize);
        }
    }
    (first, last)
}

/// Twice the area of a triangle, positive if it goes round clockwise on screen.
fn cross(a: Pos2, b: Pos2, c: Pos2) -> f32 {
    (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blank(width: usize, height: usize) -> Pixels {
        Pixels::new(width, height, ColorImage::filled([1, 1], Color32::WHITE))
    }

    fn rectangle(rect: Rect, color: Color32) -> Mesh {
        let mut mesh = Mesh::default();
        mesh.add_colored_rect(rect, color);
        mesh
    }

    #[test]
    fn every_pixel_of_two_triangles_is_filled_once() {
        let mut pixels = blank(8, 6);
        // Half transparent: a pixel that was filled twice would be darker.
        let half = Color32::from_rgba_premultiplied(0, 0, 0, 128);
        let rect = Rect::from_min_max(Pos2::new(1.0, 1.0), Pos2::new(6.0, 5.0));
        pixels.mesh(&rectangle(rect, half), Rect::EVERYTHING, 1.0);
        for y in 0..6 {
            for x in 0..8 {
                let inside = (1..6).contains(&x) && (1..5).contains(&y);
                let expected = if inside { 127 } else { 255 };
                assert_eq!(pixels.bytes()[3 * (y * 8 + x)], expected, "{x}, {y}");
            }
        }
    }

    #[test]
    fn nothing_is_drawn_beyond_the_limits_or_the_picture() {
        let mut pixels = blank(4, 4);
        let large = Rect::from_min_max(Pos2::new(-100.0, -100.0), Pos2::new(100.0, 100.0));
        let limits = Rect::from_min_max(Pos2::new(1.0, 0.0), Pos2::new(2.0, 9.0));
        pixels.mesh(&rectangle(large, Color32::BLACK), limits, 2.0);
        let row: Vec<u8> = pixels.bytes().chunks(3).take(4).map(|pixel| pixel[0]).collect();
        assert_eq!(row, [255, 255, 0, 0]);
    }

    #[test]
    fn colours_are_mixed_between_corners() {
        let mut mesh = Mesh::default();
        for (x, y, color) in [(0.0, 0.0, Color32::BLACK), (9.0, 0.0, Color32::WHITE), (0.0, 9.0, Color32::BLACK)] {
            mesh.colored_vertex(Pos2::new(x, y), color);
        }
        mesh.add_triangle(0, 1, 2);
        let mut pixels = blank(9, 9);
        pixels.mesh(&mesh, Rect::EVERYTHING, 1.0);
        let row: Vec<u8> = pixels.bytes().chunks(3).take(8).map(|pixel| pixel[0]).collect();
        assert!(row.windows(2).all(|pair| pair[0] < pair[1]), "{row:?}");
        assert!(row[0] < 30 && row[7] > 200, "{row:?}");
    }
}
