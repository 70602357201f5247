//! Makes the README's moving picture: the first scenario plays, drawn as a window draws it, without a window.
//!
//! ```sh
//! cargo run --example film -- docs/film.png
//! ```

mod animation;
mod palette;

use std::error::Error;

use egui::{Theme, Vec2};
use egui_kittest::Harness;
use kalmanscope::App;
use kalmanscope::session::{Budget, Mode};

use animation::Animation;

/// The picture's size \[pixels\].
const SIZE: Vec2 = Vec2::new(840.0, 540.0);

/// Pictures in a second.
const RATE: u16 = 12;

/// Simulated seconds per second.
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
