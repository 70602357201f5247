//! Makes the README's moving picture: the first scenario plays, drawn as a window draws it, without a window. The file is an animated
//! PNG with a palette: each picture has only the pixels that differ from the picture before it.
//!
//! ```sh
//! cargo run --example film -- docs/film.png
//! ```

use std::error::Error;

use egui::{Theme, Vec2};
use egui_kittest::Harness;
use kalmanscope::App;
use kalmanscope::film::{Change, Color, Shades, UNCHANGED};
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
    let mut shades = Shades::of(pictures.iter().map(Vec::as_slice));
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, SIZE.x as u32, SIZE.y as u32);
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::Eight);
    let mut alpha = vec![255; shades.colors.len()];
    alpha[usize::from(UNCHANGED)] = 0;
    encoder.set_palette(shades.colors.as_flattened().to_vec());
    encoder.set_trns(alpha);
    encoder.set_compression(Compression::High);
    encoder.set_filter(Filter::NoFilter);
    encoder.set_animated(pictures.len() as u32, 0)?;
    encoder.set_blend_op(BlendOp::Over)?;
    let mut writer = encoder.write_header()?;
    let mut before: Option<Vec<u8>> = None;
    for (picture, to_come) in pictures.iter().zip((0..pictures.len()).rev()) {
        let now = shades.places(picture);
        let Change { corner, size, pixels } = Change::between(before.as_deref(), &now, SIZE.x as usize);
        let [[left, top], [width, height]] = [corner, size].map(|pair| pair.map(|side| side as u32));
        writer.reset_frame_position()?;
        writer.set_frame_dimension(width, height)?;
        writer.set_frame_position(left, top)?;
        writer.set_frame_delay(if to_come == 0 { REST * RATE } else { 1 }, RATE)?;
        writer.write_image_data(&pixels)?;
        before = Some(now);
    }
    writer.finish()?;
    Ok(file)
}
