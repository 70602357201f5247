//! Pictures of the app, against those of `tests/snapshots`; `UPDATE_SNAPSHOTS=1 cargo test --test ui looks::` draws them again, and
//! writes the page with a picture of every view.

use std::path::Path;
use std::rc::Rc;

use egui::{Theme, Vec2};
use egui_kittest::kittest::Queryable as _;
use egui_kittest::{Harness, SnapshotOptions, SnapshotResults};
use kalmanscope::App;
use kalmanscope::layout::ViewLayout;
use kalmanscope::request::{Arrangement, ViewKind};
use kalmanscope::session::{Budget, Mode};
use kalmanscope::team::Frames;
use kalmanscope::views::view;
use kalmanscope_core::Scenario;

use crate::{DESKTOP, PHONE};

fn started(size: Vec2, theme: Theme) -> Harness<'static, App> {
    let builder = Harness::builder().with_size(size).with_theme(theme).wgpu();
    builder.build_eframe(|creation| App::new(creation).expect("the default scenario can be run"))
}

/// Text is rendered identically on every machine; edges of lines differ by a grey level.
fn options() -> SnapshotOptions {
    SnapshotOptions::new().threshold(2.0).max_failed_pixels(400_usize)
}

#[test]
fn screens_look_as_they_did() {
    let (options, mut results) = (options(), SnapshotResults::new());
    let teach = Arrangement::Teach;
    for (name, size, theme, mode, time, arrangement) in [
        ("first-light", DESKTOP, Theme::Light, Mode::Live, 10.0, teach),
        ("preview", Vec2::new(1200.0, 630.0), Theme::Light, Mode::Whole, 20.0, teach),
        ("hall-dark", Vec2::new(1920.0, 1080.0), Theme::Dark, Mode::Live, 14.0, teach),
        ("live-light", DESKTOP, Theme::Light, Mode::Live, 8.0, teach),
        ("live-dark", DESKTOP, Theme::Dark, Mode::Live, 34.0, teach),
        ("whole-dark", DESKTOP, Theme::Dark, Mode::Whole, 40.0, teach),
        ("phone-light", PHONE, Theme::Light, Mode::Live, 8.0, teach),
        ("landscape-light", Vec2::new(844.0, 390.0), Theme::Light, Mode::Live, 8.0, teach),
        ("tune-light", DESKTOP, Theme::Light, Mode::Whole, 40.0, Arrangement::Tune),
        ("compare-dark", DESKTOP, Theme::Dark, Mode::Whole, 40.0, Arrangement::Compare),
    ] {
        let mut screen = started(size, theme);
        if !["first-light", "preview"].contains(&name) {
            *screen.state_mut().layout_mut() = ViewLayout::of(arrangement);
        }
        let session = screen.state_mut().session_mut();
        session.toggle_play();
        if !["first-light", "hall-dark", "preview"].contains(&name) {
            session.set_scenario(Scenario::default());
        }
        session.set_mode(mode);
        session.seek(time);
        if name == "hall-dark" {
            screen.key_press(egui::Key::P);
            screen.run_steps(2);
            screen.hover_at(egui::pos2(700.0, 200.0));
        }
        screen.run_steps(8);
        screen.snapshot_options(name, &options);
        results.extend_harness(&mut screen);
    }
    results.unwrap();
}

#[test]
fn marks_look_as_they_did() {
    let mut screen = started(DESKTOP, Theme::Light);
    let session = screen.state_mut().session_mut();
    session.toggle_play();
    session.set_scenario(Scenario::default());
    session.set_mode(Mode::Whole);
    session.seek(12.0);
    screen.run_steps(4);
    screen.key_press(egui::Key::A);
    screen.run_steps(2);
    screen.state_mut().session_mut().seek(38.0);
    screen.key_press(egui::Key::B);
    screen.get_by_label("λ of EKF, in the text").set_value_accesskit(1.0);
    screen.run_steps(4);
    screen.state_mut().session_mut().seek(50.0);
    screen.run_steps(4);
    screen.snapshot_options("marks-light", &options());
}

#[test]
fn views_look_as_they_did() {
    let (options, mut results) = (options(), SnapshotResults::new());
    for kind in ViewKind::ALL {
        let mut screen =
            Harness::builder().with_size(Vec2::new(900.0, 620.0)).with_theme(Theme::Light).wgpu().build_eframe(
                |creation| {
                    let app = App::new(creation).expect("the default scenario can be run");
                    app.working_with(Rc::new(Frames(Budget::Unlimited)))
                },
            );
        let layout = screen.state_mut().layout_mut();
        for shown in layout.shown().into_iter().chain([kind]) {
            layout.toggle(shown);
        }
        if !layout.shown().contains(&kind) {
            layout.toggle(kind);
        }
        let session = screen.state_mut().session_mut();
        session.toggle_play();
        session.set_scenario(Scenario::default());
        session.set_mode(Mode::Whole);
        session.seek(34.0);
        if kind == ViewKind::Sensors {
            // Else the picture shows how far they are compared.
            session.set_budget(Budget::Unlimited);
        }
        screen.run_steps(8);
        screen.snapshot_options(file(kind), &options);
        results.extend_harness(&mut screen);
    }
    results.unwrap();
}

#[test]
fn a_lesson_looks_as_it_did() {
    let mut screen = started(DESKTOP, Theme::Light);
    screen.get_by_label("Lessons").click();
    screen.run_steps(4);
    screen.get_by_label("Fading memory and a sudden loss").click();
    screen.run_steps(4);
    screen.get_by_label("Show me").click();
    screen.run_steps(4);
    screen.get_by_label("Next").click();
    screen.run_steps(4);
    screen.get_by_label("λ = 1.005").click();
    screen.run_steps(8);
    screen.snapshot_options("lesson-light", &options());
}

fn file(kind: ViewKind) -> String {
    format!("view-{}", view(kind).name.replace(' ', "-").to_lowercase())
}

#[test]
fn the_gallery_has_every_view() {
    let part = |kind: ViewKind| {
        let (name, [first, ..]) = (view(kind).name, view(kind).help);
        format!("\n## {name}\n{first}\n\n![{name}](../tests/snapshots/{}.png)\n", file(kind))
    };
    let head = "# All views\n`UPDATE_SNAPSHOTS=1 cargo test --test ui looks::` makes these pictures and this page. The sentence is the first of \
                those\nbehind the `?` of a view.\n";
    let expected = head.to_owned() + &ViewKind::ALL.map(part).concat();
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/gallery.md");
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        std::fs::write(&path, &expected).expect("the page can be written");
    }
    assert_eq!(std::fs::read_to_string(path).expect("there is a gallery"), expected);
}
