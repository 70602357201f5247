//! Makes the README's moving picture: the first scenario plays, drawn as a window draws it, without a window. The file is an animated
//! PNG with a palette: each picture has only the pixels that differ from the picture before it.
//!
//! ```sh
//! cargo run --example film -- docs/film.png
//! ```

use std::collections::HashMap;
use std::error::Error;

use egui::{Theme, Vec2};
use egui_kittest::Harness;
use kalmanscope::App;
use kalmanscope::session::{Budget, Mode};
use png::{BitDepth, BlendOp, ColorType, Compression, Encoder, EncodingError, Filter};

/// The picture's size \[pixels\].
const SIZE: Vec2 = Vec2::new(840.0, 540.0);

const RATE: u16 = 12;

const SPEED: f64 = 2.5;

/// The time for which the last picture stands still \[s\].
const REST: u16 = 3;

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("usage: film FILE.png")?;
    let mut screen = Harness::builder()
        .with_size(SIZE)
        .with_theme(Theme::Light)
        .with_step_dt(1.0 / f32::from(RATE))
        .wgpu()
        .build_eframe(|creation| App::embedded(creation).expect("the first scenario can be run"));
    let session = screen.state_mut().session_mut();
    session.set_budget(Budget::Unlimited);
    session.set_mode(Mode::Live);
    session.set_speed(SPEED);
    session.play_from_start();
    let mut animation = Animation::new(RATE, SIZE.x as usize, REST);
    while screen.state().session().playing() {
        screen.step();
        animation.add(screen.render()?.as_raw());
    }
    let file = animation.encoded()?;
    println!("{path}: {} kB", file.len() / 1000);
    std::fs::write(path, file)?;
    Ok(())
}

/// The place in the palette of a pixel that has not changed.
const UNCHANGED: u8 = 255;

struct Animation {
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
    fn new(rate: u16, width: usize, rest: u16) -> Self {
        Self { rate, width, pictures: Vec::new(), rest: rest * rate }
    }

    /// Adds a picture. A pixel has four bytes: red, green, blue, and one that is ignored.
    fn add(&mut self, pixels: &[u8]) {
        self.pictures.push(pixels.chunks_exact(4).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect());
    }

    fn encoded(&self) -> Result<Vec<u8>, EncodingError> {
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

type Color = [u8; 3];

/// The colours of an indexed picture: groups of similar colours, split where they differ most until there are enough.
struct Palette {
    colors: Vec<Color>,
    places: HashMap<Color, u8>,
}

impl Palette {
    /// At most `most` colours in place of those that are counted, each the mean of a group.
    fn new(counts: HashMap<Color, u64>, most: u8) -> Self {
        let mut all: Vec<(Color, u64)> = counts.into_iter().collect();
        // The same file each time, whatever the order in the map.
        all.sort_unstable();
        let mut groups = vec![Group::new(all)];
        while groups.len() < usize::from(most) {
            let worst = (0..groups.len()).max_by(|a, b| groups[*a].spread.total_cmp(&groups[*b].spread));
            let Some(worst) = worst.filter(|group| groups[*group].spread > 0.0) else { break };
            let above = groups[worst].split();
            groups.push(above);
        }
        let places =
            groups.iter().zip(0..).flat_map(|(group, place)| group.colors.iter().map(move |(c, _)| (*c, place)));
        Self { colors: groups.iter().map(Group::mean).collect(), places: places.collect() }
    }

    fn place(&self, color: Color) -> u8 {
        self.places.get(&color).copied().unwrap_or(0)
    }
}

/// Similar colours with their counts.
struct Group {
    colors: Vec<(Color, u64)>,
    /// The channel in which they differ most, its mean, and the sum of the squared distances from there.
    channel: usize,
    mean: f64,
    spread: f64,
}

impl Group {
    fn new(colors: Vec<(Color, u64)>) -> Self {
        let channels = (0..3).map(|channel| {
            let mean = mean(&colors, channel);
            let spread = colors.iter().map(|(c, n)| (f64::from(c[channel]) - mean).powi(2) * *n as f64).sum::<f64>();
            (channel, mean, spread)
        });
        let widest = channels.max_by(|a, b| a.2.total_cmp(&b.2));
        let (channel, mean, spread) = widest.unwrap_or_default();
        Self { colors, channel, mean, spread }
    }

    /// Keeps the colours below the mean and returns those above.
    fn split(&mut self) -> Self {
        let Self { colors, channel, mean, .. } = self;
        let (above, below) = colors.drain(..).partition(|(color, _)| f64::from(color[*channel]) > *mean);
        *self = Self::new(below);
        Self::new(above)
    }

    fn mean(&self) -> Color {
        [0, 1, 2].map(|channel| mean(&self.colors, channel).round() as u8)
    }
}

fn mean(colors: &[(Color, u64)], channel: usize) -> f64 {
    let all: u64 = colors.iter().map(|(_, count)| count).sum();
    let sum: u64 = colors.iter().map(|(color, count)| u64::from(color[channel]) * count).sum();
    sum as f64 / all.max(1) as f64
}
