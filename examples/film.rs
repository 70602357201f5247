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

/// The place in the palette of a pixel that has not changed.
const UNCHANGED: u8 = 255;

type Color = [u8; 3];

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
    let mut pictures: Vec<Vec<Color>> = Vec::new();
    while screen.state().session().playing() {
        screen.step();
        let picture = screen.render()?;
        pictures.push(picture.as_raw().chunks_exact(4).map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect());
    }
    let file = encoded(&pictures)?;
    println!("{path}: {} kB", file.len() / 1000);
    std::fs::write(path, file)?;
    Ok(())
}

fn encoded(pictures: &[Vec<Color>]) -> Result<Vec<u8>, EncodingError> {
    let (colors, mut places) = palette(pictures);
    let (width, mut file) = (SIZE.x as usize, Vec::new());
    let mut encoder = Encoder::new(&mut file, SIZE.x as u32, SIZE.y as u32);
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::Eight);
    let mut alpha = vec![255; colors.len()];
    alpha[usize::from(UNCHANGED)] = 0;
    encoder.set_palette(colors.as_flattened().to_vec());
    encoder.set_trns(alpha);
    encoder.set_compression(Compression::High);
    encoder.set_filter(Filter::NoFilter);
    encoder.set_animated(pictures.len() as u32, 0)?;
    encoder.set_blend_op(BlendOp::Over)?;
    let mut writer = encoder.write_header()?;
    let mut before: Option<Vec<u8>> = None;
    for (picture, to_come) in pictures.iter().zip((0..pictures.len()).rev()) {
        let now: Vec<u8> = picture.iter().map(|color| places(*color)).collect();
        let differs = |at: &usize| before.as_ref().is_none_or(|before| before[*at] != now[*at]);
        // The smallest rectangle with all changes; a single pixel where there are none.
        let ends = |of: fn(usize, usize) -> usize| {
            let changed = || (0..now.len()).filter(differs).map(|at| of(at, width));
            (changed().min().unwrap_or(0), changed().max().unwrap_or(0))
        };
        let ((top, bottom), (left, right)) = (ends(|at, width| at / width), ends(|at, width| at % width));
        let inside = (top..=bottom).flat_map(|y| (left..=right).map(move |x| y * width + x));
        let pixels: Vec<u8> = inside.map(|at| if differs(&at) { now[at] } else { UNCHANGED }).collect();
        writer.reset_frame_position()?;
        writer.set_frame_dimension((right - left + 1) as u32, (bottom - top + 1) as u32)?;
        writer.set_frame_position(left as u32, top as u32)?;
        writer.set_frame_delay(if to_come == 0 { REST * RATE } else { 1 }, RATE)?;
        writer.write_image_data(&pixels)?;
        before = Some(now);
    }
    writer.finish()?;
    Ok(file)
}

/// The commonest colours, one of no meaning at [`UNCHANGED`], and the place of the nearest one of a colour.
fn palette(pictures: &[Vec<Color>]) -> (Vec<Color>, impl FnMut(Color) -> u8) {
    let mut counts: HashMap<Color, usize> = HashMap::new();
    pictures.iter().flatten().for_each(|color| *counts.entry(*color).or_default() += 1);
    let mut all: Vec<(usize, Color)> = counts.into_iter().map(|(color, count)| (count, color)).collect();
    all.sort_unstable_by(|a, b| b.cmp(a));
    let mut colors: Vec<Color> = all.iter().map(|(_, color)| *color).take(usize::from(UNCHANGED)).collect();
    let (common, mut known) = (colors.clone(), HashMap::new());
    colors.resize(usize::from(UNCHANGED) + 1, [0; 3]);
    let place = move |color: Color| {
        let far = |other: &Color| (0..3).map(|i| (i32::from(other[i]) - i32::from(color[i])).pow(2)).sum::<i32>();
        let nearest = || (0..UNCHANGED).zip(&common).min_by_key(|(_, other)| far(other)).map_or(0, |(place, _)| place);
        *known.entry(color).or_insert_with(nearest)
    };
    (colors, place)
}
