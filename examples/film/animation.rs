//! An animated PNG with a palette: each picture has only the pixels that differ from the picture before it.

use std::collections::HashMap;

use png::{BitDepth, BlendOp, ColorType, Compression, Encoder, EncodingError, Filter};

use super::palette::{Color, Palette};

/// The place in the palette of a pixel that has not changed.
const UNCHANGED: u8 = 255;

/// Pictures of one size.
pub(crate) struct Animation {
    /// Pictures in a second.
    rate: u16,
    width: usize,
    pictures: Vec<Vec<Color>>,
    /// The number of times for which the last picture is shown.
    rest: u16,
}

/// The smallest rectangle with all pixels that have changed.
struct Part {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
    pixels: Vec<u8>,
}

impl Animation {
    /// No picture yet; `rest` is the time for which the last one will stay \[s\].
    pub(crate) fn new(rate: u16, width: usize, rest: u16) -> Self {
        Self { rate, width, pictures: Vec::new(), rest: rest * rate }
    }

    /// Adds a picture of four bytes a pixel, of which the last is not used.
    pub(crate) fn add(&mut self, pixels: &[u8]) {
        self.pictures.push(pixels.chunks_exact(4).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect());
    }

    /// The file.
    pub(crate) fn encoded(&self) -> Result<Vec<u8>, EncodingError> {
        let Self { rate, width, pictures, rest } = self;
        let mut counts = HashMap::new();
        pictures.iter().flatten().for_each(|color| *counts.entry(*color).or_default() += 1);
        let palette = Palette::new(counts, UNCHANGED);
        let mut file = Vec::new();
        let height = pictures.first().map_or(0, Vec::len) / width;
        let mut encoder = Encoder::new(&mut file, *width as u32, height as u32);
        encoder.set_color(ColorType::Indexed);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_palette(with_last(palette.colors.as_flattened(), 3 * usize::from(UNCHANGED), &[0, 0, 0]));
        encoder.set_trns(with_last(&[], usize::from(UNCHANGED), &[0]));
        encoder.set_compression(Compression::High);
        encoder.set_filter(Filter::NoFilter);
        encoder.set_animated(pictures.len() as u32, 0)?;
        encoder.set_blend_op(BlendOp::Over)?;
        let mut writer = encoder.write_header()?;
        let mut before: Option<Vec<u8>> = None;
        for (picture, to_come) in pictures.iter().zip((0..pictures.len()).rev()) {
            let places: Vec<u8> = picture.iter().map(|color| palette.place(*color)).collect();
            let part = Part::changed(before.as_deref(), &places, *width);
            writer.reset_frame_position()?;
            writer.set_frame_dimension(part.width as u32, part.height as u32)?;
            writer.set_frame_position(part.left as u32, part.top as u32)?;
            writer.set_frame_delay(if to_come == 0 { *rest } else { 1 }, *rate)?;
            writer.write_image_data(&part.pixels)?;
            before = Some(places);
        }
        writer.finish()?;
        Ok(file)
    }
}

impl Part {
    /// The part of a picture that differs from the one before it; all of the first one, a single pixel of one that is
    /// the same.
    fn changed(before: Option<&[u8]>, now: &[u8], width: usize) -> Self {
        let differs = |at: &usize| before.is_none_or(|before| before[*at] != now[*at]);
        let rows = (0..now.len()).filter(differs).map(|at| at / width);
        let columns = (0..now.len()).filter(differs).map(|at| at % width);
        let (top, bottom) = (rows.clone().min().unwrap_or(0), rows.max().unwrap_or(0));
        let (left, right) = (columns.clone().min().unwrap_or(0), columns.max().unwrap_or(0));
        let places = (top..=bottom).flat_map(|y| (left..=right).map(move |x| y * width + x));
        let pixels = places.map(|at| if differs(&at) { now[at] } else { UNCHANGED }).collect();
        Self { left, top, width: right - left + 1, height: bottom - top + 1, pixels }
    }
}

/// Some bytes, filled up to a length with 255, and then the last ones.
fn with_last(bytes: &[u8], length: usize, last: &[u8]) -> Vec<u8> {
    let mut filled = bytes.to_vec();
    filled.resize(length, 255);
    filled.extend(last);
    filled
}
