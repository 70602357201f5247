#![doc = include_str!("../README.md")]

mod area;
mod flatten;

pub use kurbo;

use area::Area;
use kurbo::{Affine, BezPath};

/// Colours: white.
pub mod color {
    use std::marker::PhantomData;

    /// The colour space of screens.
    #[derive(Clone, Copy, Debug)]
    pub struct Srgb;

    /// A colour that hides what is behind it.
    #[derive(Clone, Copy, Debug)]
    pub struct OpaqueColor<Space>(PhantomData<Space>);

    impl OpaqueColor<Srgb> {
        /// White.
        pub const WHITE: Self = Self(PhantomData);
    }
}

/// The memory of a renderer, of which this one needs none.
#[derive(Clone, Copy, Debug, Default)]
pub struct Resources(());

impl Resources {
    /// None.
    pub fn new() -> Self {
        Self(())
    }
}

/// A picture: red, green, blue and opacity of each pixel, row by row, the colours multiplied by the opacity.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixmap {
    bytes: Vec<u8>,
}

impl Pixmap {
    /// An empty picture of this many pixels.
    pub fn new(width: u16, height: u16) -> Self {
        Self { bytes: vec![0; 4 * usize::from(width) * usize::from(height)] }
    }

    /// Its bytes.
    pub fn data_as_u8_slice(&self) -> &[u8] {
        &self.bytes
    }
}

/// Fills paths with white.
#[derive(Clone, Debug)]
pub struct RenderContext {
    area: Area,
    transform: Affine,
}

impl RenderContext {
    /// A picture of this many pixels.
    pub fn new(width: u16, height: u16) -> Self {
        Self { area: Area::new(width.into(), height.into()), transform: Affine::IDENTITY }
    }

    /// Sets the place of the paths that follow.
    pub fn set_transform(&mut self, transform: Affine) {
        self.transform = transform;
    }

    /// Sets the colour, which is white.
    pub fn set_paint(&mut self, _: color::OpaqueColor<color::Srgb>) {}

    /// Fills a path.
    pub fn fill_path(&mut self, path: &BezPath) {
        let Self { area, transform } = self;
        flatten::flatten(path, *transform, |from, to| area.add(from, to));
    }

    /// Draws what has been filled.
    pub fn render(&self, picture: &mut Pixmap, _: &mut Resources) {
        let covered = self.area.covered();
        for (pixel, opacity) in picture.bytes.chunks_exact_mut(4).zip(covered) {
            pixel.fill(opacity);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kurbo::{Circle, Rect, Shape};

    fn filled(path: &BezPath, [width, height]: [u16; 2]) -> Vec<u8> {
        let mut context = RenderContext::new(width, height);
        context.set_paint(color::OpaqueColor::<color::Srgb>::WHITE);
        context.fill_path(path);
        let mut picture = Pixmap::new(width, height);
        context.render(&mut picture, &mut Resources::new());
        picture.data_as_u8_slice().chunks_exact(4).map(|pixel| pixel[3]).collect()
    }

    /// Parts of pixels at the edges, to the nearest of 255.
    #[test]
    fn a_rectangle_covers_parts_of_pixels() {
        let covered = filled(&Rect::new(0.5, 0.25, 2.2, 2.0).to_path(0.1), [4, 3]);
        assert_eq!(covered, [96, 191, 38, 0, 128, 255, 51, 0, 0, 0, 0, 0]);
    }

    fn area(covered: &[u8]) -> f64 {
        covered.iter().map(|&opacity| f64::from(opacity) / 255.0).sum()
    }

    /// Half the product of the diagonals.
    #[test]
    fn slanted_lines_cover_their_area() {
        let mut path = BezPath::new();
        path.move_to((10.3, 0.4));
        [(18.9, 9.6), (10.3, 19.2), (1.1, 9.6)].into_iter().for_each(|to| path.line_to(to));
        let covered = filled(&path, [20, 20]);
        assert!((area(&covered) - 17.8 * 18.8 / 2.0).abs() < 0.1, "{}", area(&covered));
    }

    /// Lines that stray from the curve by a quarter of a pixel at most, inside, the same whichever way round the outline goes.
    #[test]
    fn a_circle_has_nearly_its_area() {
        let circle = Circle::new((10.3, 9.6), 8.0).to_path(1e-3);
        let covered = filled(&circle, [20, 20]);
        let share = area(&covered) / (std::f64::consts::PI * 64.0);
        assert!((0.96..1.0).contains(&share), "{share}");
        assert_eq!(filled(&circle.reverse_subpaths(), [20, 20]), covered);
    }

    /// What two outlines of one direction both cover is covered once; a hole goes the other way round.
    #[test]
    fn outlines_overlap_by_the_non_zero_rule() {
        let mut path = Rect::new(0.0, 0.0, 2.0, 1.0).to_path(0.1);
        path.extend(Rect::new(1.0, 0.0, 4.0, 1.0).to_path(0.1));
        path.extend(Rect::new(3.0, 0.0, 4.0, 1.0).to_path(0.1).reverse_subpaths());
        assert_eq!(filled(&path, [5, 1]), [255, 255, 255, 0, 0]);
    }

    /// An outline that reaches out of the picture fills what is inside.
    #[test]
    fn what_is_outside_is_left_out() {
        let covered = filled(&Rect::new(-3.0, -2.0, 1.5, 9.0).to_path(0.1), [2, 2]);
        assert_eq!(covered, [255, 128, 255, 128]);
    }
}
