//! Draws shapes into pixels without a screen or a graphics card.

use std::collections::HashMap;

use egui::epaint::{ClippedPrimitive, Primitive, Vertex};
use egui::{Color32, ColorImage, ImageData, TextureId, TexturesDelta};

use super::changes::Color;

#[derive(Default)]
pub(super) struct Textures(HashMap<TextureId, ColorImage>);

impl Textures {
    pub(super) fn take(&mut self, mut delta: TexturesDelta) {
        for (id, change) in
            std::mem::take(&mut delta.set).iter().flat_map(|(id, all)| all.iter().map(move |one| (id, one)))
        {
            let ImageData::Color(image) = &change.image;
            let Some(([left, top], whole)) = change.pos.zip(self.0.get_mut(id)) else {
                self.0.insert(*id, (**image).clone());
                continue;
            };
            for (row, pixels) in image.pixels.chunks_exact(image.size[0].max(1)).enumerate() {
                let begin = (top + row) * whole.size[0] + left;
                whole.pixels[begin..begin + pixels.len()].copy_from_slice(pixels);
            }
        }
        std::mem::take(&mut delta.free).iter().for_each(|id| _ = self.0.remove(id));
    }
}

/// Vertices stand at whole numbers of this part of a pixel: two triangles with a common side then share no pixel and leave none out.
const PART: i64 = 256;

/// Limits the places of corners \[pixels\]: a plot that is enlarged has some far away, and products of larger numbers overflow.
const FAR: f32 = 1e6;

/// A picture of `[width, height]` pixels of shapes with one pixel per point.
pub(super) fn drawn(
    primitives: &[ClippedPrimitive],
    textures: &Textures,
    ground: Color32,
    [width, height]: [usize; 2],
) -> Vec<Color> {
    let mut pixels = vec![ground.to_array(); width * height];
    for ClippedPrimitive { clip_rect: clip, primitive } in primitives {
        let Primitive::Mesh(mesh) = primitive else { continue };
        let Some(texture) = textures.0.get(&mesh.texture_id) else { continue };
        let limits = [(clip.x_range(), width), (clip.y_range(), height)]
            .map(|(range, most)| [range.min, range.max].map(|end| end.round().clamp(0.0, most as f32) as i64));
        for corners in mesh.indices.as_chunks::<3>().0 {
            let corners = corners.map(|at| &mesh.vertices[at as usize]);
            triangle(corners, texture, limits, |[x, y], source| {
                let pixel = &mut pixels[y * width + x];
                let rest = 255 - u16::from(source[3]);
                let over = |i: usize| u16::from(source[i]) + (u16::from(pixel[i]) * rest + 127) / 255;
                *pixel = std::array::from_fn(|i| over(i).min(255) as u8);
            });
        }
    }
    pixels.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect()
}

/// By the signs of the cross products of each side and the way from its beginning to a pixel's centre.
fn triangle(
    mut corners: [&Vertex; 3],
    texture: &ColorImage,
    limits: [[i64; 2]; 2],
    mut put: impl FnMut([usize; 2], [u8; 4]),
) {
    let cross = |[a, b]: [[i64; 2]; 2], p: [i64; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
    let mut places =
        corners.map(|corner| [corner.pos.x, corner.pos.y].map(|x| (x.clamp(-FAR, FAR) * PART as f32).round() as i64));
    if cross([places[0], places[1]], places[2]) < 0 {
        corners.swap(1, 2);
        places.swap(1, 2);
    }
    let area = cross([places[0], places[1]], places[2]);
    let [across, down] = [0, 1].map(|axis| {
        let [a, b, c] = places.map(|place| place[axis].div_euclid(PART));
        a.min(b).min(c).max(limits[axis][0])..(a.max(b).max(c) + 1).min(limits[axis][1])
    });
    let sides = [[1, 2], [2, 0], [0, 1]].map(|side| side.map(|corner: usize| places[corner]));
    // A centre on a side belongs to the triangle of which this is an upper or a left one.
    let least = sides.map(|[a, b]| i64::from(!(b[1] < a[1] || (b[1] == a[1] && b[0] > a[0]))));
    let is_plain = corners.iter().all(|corner| corner.uv == corners[0].uv && corner.color == corners[0].color);
    let plain = shade(corners, [1.0, 0.0, 0.0], texture);
    for y in down.filter(|_| area > 0) {
        for x in across.clone() {
            let weights = sides.map(|side| cross(side, [x, y].map(|at| at * PART + PART / 2)));
            if weights.iter().zip(least).all(|(weight, least)| *weight >= least) {
                let shares = || weights.map(|weight| weight as f32 / area as f32);
                let source = if is_plain { plain } else { shade(corners, shares(), texture) };
                put([x as usize, y as usize], source);
            }
        }
    }
}

/// The colour between the corners, times that of the texture there.
fn shade(corners: [&Vertex; 3], shares: [f32; 3], texture: &ColorImage) -> [u8; 4] {
    let mean = |of: &dyn Fn(&Vertex) -> f32| (0..3).map(|i| shares[i] * of(corners[i])).sum::<f32>();
    let place = |share: f32, count: usize| ((share * count as f32) as usize).min(count.saturating_sub(1));
    let [across, down] = texture.size;
    let (u, v) = (place(mean(&|corner| corner.uv.x), across), place(mean(&|corner| corner.uv.y), down));
    let texel = texture.pixels.get(v * across + u).copied().unwrap_or_default().to_array();
    let color = |i: usize| mean(&|corner| f32::from(corner.color.to_array()[i])) * f32::from(texel[i]) / 255.0;
    std::array::from_fn(|i| color(i).round() as u8)
}

#[cfg(test)]
mod tests {
    use egui::epaint::Mesh;
    use egui::{Pos2, Rect, pos2};

    use super::*;

    #[test]
    fn the_triangles_of_a_quad_share_no_pixel_and_leave_none_out() {
        let textures = Textures([(TextureId::default(), ColorImage::filled([1, 1], Color32::WHITE))].into());
        // Half of white over black, once: 128. Pixels of the diagonal that were drawn twice would be 192.
        let half = Color32::from_rgba_premultiplied(128, 128, 128, 128);
        let clip_rect = Rect::from_min_max(Pos2::ZERO, pos2(5.0, 9.0));
        for [from, to] in [[0.0, 8.0], [1.0, 6.0], [-50.0, 70.0], [-1e30, 1e30]] {
            let (rect, mut mesh) = (Rect::from_min_max(pos2(from, from), pos2(to, to)), Mesh::default());
            mesh.add_colored_rect(rect, half);
            let primitive = ClippedPrimitive { clip_rect, primitive: Primitive::Mesh(mesh) };
            for (at, pixel) in drawn(&[primitive], &textures, Color32::BLACK, [8, 6]).iter().enumerate() {
                let centre = pos2((at % 8) as f32 + 0.5, (at / 8) as f32 + 0.5);
                let is_inside = rect.intersect(clip_rect).contains(centre);
                assert_eq!(pixel[0], if is_inside { 128 } else { 0 }, "{centre}");
            }
        }
    }
}
