//! Pictures of the app, against those of `tests/snapshots`; `UPDATE_SNAPSHOTS=1 cargo test --test looks` makes them anew.

use egui::{Theme, Vec2};
use egui_kittest::{Harness, SnapshotOptions, SnapshotResults};
use kalmanscope::App;
use kalmanscope::session::Mode;

const DESKTOP: Vec2 = Vec2::new(1280.0, 800.0);
const PHONE: Vec2 = Vec2::new(390.0, 844.0);

#[test]
fn it_looks_as_it_did() {
    // Text is drawn alike on every machine, lines differ by a grey level at their edges.
    let options = SnapshotOptions::new().threshold(2.0).max_failed_pixels(400_usize);
    let mut results = SnapshotResults::new();
    for (name, size, theme, mode, time) in [
        ("live-light", DESKTOP, Theme::Light, Mode::Live, 8.0),
        ("live-dark", DESKTOP, Theme::Dark, Mode::Live, 34.0),
        ("whole-dark", DESKTOP, Theme::Dark, Mode::Whole, 40.0),
        ("phone-light", PHONE, Theme::Light, Mode::Live, 8.0),
    ] {
        let mut screen = Harness::builder()
            .with_size(size)
            .with_theme(theme)
            .wgpu()
            .build_eframe(|creation| App::new(creation).expect("the default scenario can be run"));
        let session = screen.state_mut().session_mut();
        session.toggle_play();
        session.set_mode(mode);
        session.seek(time);
        screen.run_steps(8);
        screen.snapshot_options(name, &options);
        results.extend_harness(&mut screen);
    }
    results.unwrap();
}
