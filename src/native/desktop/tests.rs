//! The program in a headless window, with its session in a folder.

use egui::{Theme, Vec2};
use egui_kittest::Harness;
use kalmanscope_core::Scenario;

use super::super::state_file::NAME;
use super::*;
use crate::memory::Memory;

type Screen = Harness<'static, Desktop>;

fn started(folder: &Path) -> Screen {
    let folder = folder.to_owned();
    let builder = Harness::builder().with_size(Vec2::new(1000.0, 700.0)).with_theme(Theme::Light);
    let mut screen = builder.build_eframe(move |creation| {
        Desktop::new(&creation.egui_ctx, Ok(&folder), |app| app).expect("the first scenario can be run")
    });
    screen.run_steps(2);
    screen
}

fn save(screen: &mut Screen) {
    eframe::App::save(screen.state_mut(), &mut Memory::default());
}

fn notice(screen: &mut Screen) -> String {
    screen.state_mut().app.notice().unwrap_or_default().to_owned()
}

fn seed(screen: &mut Screen) -> u64 {
    screen.state_mut().app.session().scenario().seed
}

fn set_seed(screen: &mut Screen, seed: u64) {
    let session = screen.state_mut().app.session_mut();
    session.set_scenario(Scenario { seed, ..session.scenario().clone() });
    screen.run_steps(2);
}

#[test]
fn the_session_comes_back() {
    let folder = tempfile::tempdir().expect("a folder can be made");
    let mut screen = started(folder.path());
    assert_eq!(notice(&mut screen), "");
    set_seed(&mut screen, 5);
    save(&mut screen);
    let mut again = started(folder.path());
    assert_eq!((seed(&mut again), notice(&mut again)), (5, String::new()));
}

#[test]
fn a_frame_is_saved_after_two_seconds_and_then_all_rests() {
    let folder = tempfile::tempdir().expect("a folder can be made");
    let mut screen = started(folder.path());
    screen.state_mut().app.session_mut().pause();
    screen.run_steps(2);
    assert_eq!(eframe::App::auto_save_interval(screen.state()), Duration::MAX, "no save in each frame");
    let due = screen.state().due.expect("a frame asks for a save");
    assert!(due > Instant::now() && due <= Instant::now() + SOON);
    std::thread::sleep(due - Instant::now());
    screen.step();
    assert_eq!(eframe::App::auto_save_interval(screen.state()), Duration::ZERO, "the toolkit saves");
    save(&mut screen);
    assert_eq!(screen.state().due, None, "the frame of the save asks for no other");
    screen.step();
    assert_eq!(eframe::App::auto_save_interval(screen.state()), Duration::MAX);
    assert!(screen.state().due.is_some(), "each other frame does");
}

#[test]
fn a_missing_place_is_said_and_the_explorer_starts() {
    let folder = tempfile::tempdir().expect("a folder can be made");
    let file = folder.path().join("file");
    std::fs::write(&file, "").expect("it can be written");
    let mut screen = started(&file);
    assert!(notice(&mut screen).starts_with("This session is not saved when the window closes: "));
    save(&mut screen);
    assert_eq!(std::fs::read(&file).expect("it is there"), b"");
}

#[test]
fn a_save_that_fails_is_said() {
    let folder = tempfile::tempdir().expect("a folder can be made");
    let inner = folder.path().join("gone");
    let mut screen = started(&inner);
    std::fs::remove_dir_all(&inner).expect("it can be removed");
    save(&mut screen);
    let said = notice(&mut screen);
    assert!(said.starts_with("The session is not saved: ") && said.contains(NAME), "{said}");
}
