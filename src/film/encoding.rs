//! Pictures as an animated GIF that is small enough for a slide.

use std::borrow::Cow;

use gif::{Encoder, EncodingError, Frame, Repeat};
use kalmanscope_core::Work;
use kalmanscope_core::internals::pause;

use super::changes::{Change, Color, Shades, UNCHANGED};

/// Limits the size of a film \[bytes\].
pub const LARGEST: usize = 2_000_000;

/// Keeps one picture of this many: the first of these numbers with which the film is small enough.
const KEPT: [usize; 4] = [1, 2, 4, 6];

pub(crate) struct Pictures {
    pub(crate) size: [usize; 2],
    /// Pictures in a second.
    pub(crate) rate: usize,
    pub(crate) all: Vec<Vec<Color>>,
}

/// The file, and one sentence about what was left out to make it small.
pub(crate) type Gif = Result<(Vec<u8>, Option<String>), String>;

pub(crate) fn encoded(pictures: Pictures) -> Work<Gif> {
    Work::new(|progress| async move {
        for (tried, kept) in KEPT.into_iter().enumerate() {
            progress.set(tried as f64 / KEPT.len() as f64);
            let file = one_file(&pictures, kept).await.map_err(|error| error.to_string())?;
            if let Some(file) = file {
                let rate = pictures.rate / kept;
                let words = format!("It has {rate} pictures a second, so that it fits into 2 MB.");
                return Ok((file, (tried > 0).then_some(words)));
            }
        }
        Err("it would be larger than 2 MB".to_owned())
    })
}

/// `None` as soon as it is too large.
async fn one_file(pictures: &Pictures, kept: usize) -> Result<Option<Vec<u8>>, EncodingError> {
    let Pictures { size: canvas, rate, all } = pictures;
    let (all, rate) = (all.iter().step_by(kept), rate / kept);
    let mut shades = Shades::of(all.clone().map(Vec::as_slice));
    let [width, height] = canvas.map(|side| side as u16);
    let mut encoder = Encoder::new(Vec::new(), width, height, shades.colors.as_flattened())?;
    encoder.set_repeat(Repeat::Infinite)?;
    let mut before: Option<Vec<u8>> = None;
    for (at, picture) in all.enumerate() {
        pause().await;
        let now = shades.places(picture);
        let Change { corner, size, pixels } = Change::between(before.as_deref(), &now, canvas[0]);
        let [[left, top], [width, height]] = [corner, size].map(|pair| pair.map(|side| side as u16));
        // In hundredths of a second, which add up to the true time: 12 pictures a second are 8, 8 and 9 of them in turn.
        let until = |picture: usize| (100 * picture + rate / 2) / rate;
        let delay = (until(at + 1) - until(at)) as u16;
        let buffer = Cow::Owned(pixels);
        let frame = Frame { delay, left, top, width, height, transparent: Some(UNCHANGED), buffer, ..Frame::default() };
        encoder.write_frame(&frame)?;
        if encoder.get_ref().len() > LARGEST {
            return Ok(None);
        }
        before = Some(now);
    }
    let file = encoder.into_inner()?;
    Ok((file.len() <= LARGEST).then_some(file))
}

#[cfg(test)]
mod tests {
    use kalmanscope_core::Task as _;

    use super::*;

    const SIZE: [usize; 2] = [320, 240];

    /// Pictures of which this share of the pixels, in sixteenths, are noise, which no encoder makes smaller.
    fn pictures(share: u64) -> Pictures {
        let mut state = 1_u64;
        let mut pixel = |_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let noise = (state >> 33) as u8;
            if state >> 60 < share { [noise, noise, noise] } else { [20, 40, 60] }
        };
        let all = (0..60).map(|_| (0..SIZE[0] * SIZE[1]).map(&mut pixel).collect()).collect();
        Pictures { size: SIZE, rate: 12, all }
    }

    /// The file and its sentence, its length in hundredths of a second, and its pictures as a player shows them.
    fn shown(pictures: Pictures) -> (Vec<u8>, Option<String>, u16, Vec<Vec<Color>>) {
        let (file, words) = encoded(pictures).run().unwrap();
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::Indexed);
        let mut decoder = options.read_info(&file[..]).unwrap();
        let palette = decoder.global_palette().unwrap().to_vec();
        let (mut canvas, mut all, mut length) = (vec![[0; 3]; SIZE[0] * SIZE[1]], Vec::new(), 0);
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            let width = usize::from(frame.width);
            for (at, &place) in frame.buffer.iter().enumerate().filter(|(_, place)| **place != UNCHANGED) {
                let (x, y) = (usize::from(frame.left) + at % width, usize::from(frame.top) + at / width);
                canvas[y * SIZE[0] + x] = palette.as_chunks::<3>().0[usize::from(place)];
            }
            length += frame.delay;
            all.push(canvas.clone());
        }
        (file, words, length, all)
    }

    #[test]
    fn a_player_shows_the_pictures_in_their_time_and_fewer_where_they_would_be_too_large() {
        let fewer = "It has 3 pictures a second, so that it fits into 2 MB.";
        for (share, kept, expected) in [(1, 1, None), (16, 4, Some(fewer))] {
            let (file, words, length, all) = shown(pictures(share));
            assert_eq!((words.as_deref(), length, all.len()), (expected, 500, 60 / kept));
            assert!(file.len() <= LARGEST, "{}", file.len());
            let off = |(a, b): (&Color, &Color)| (0..3).map(|i| a[i].abs_diff(b[i])).max().unwrap();
            for (picture, expected) in all.iter().zip(pictures(share).all.iter().step_by(kept)) {
                assert!(picture.iter().zip(expected).map(off).max().unwrap() <= 2);
            }
        }
    }
}
