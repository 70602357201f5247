//! The program in a headless window, with its state in a folder.

#[path = "../../../tests/ui/memory.rs"]
mod storage;

use std::path::Path;

use egui::{Theme, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use kalmanscope_core::Scenario;

use super::*;
use storage::Memory as Older;

type Screen = Harness<'static, Desktop>;

/// The program with its state in a folder.
fn started(folder: &Path) -> Screen {
    let folder = folder.to_owned();
    let builder = Harness::builder().with_size(Vec2::new(1000.0, 700.0)).with_theme(Theme::Light);
    let mut screen = builder.build_eframe(move |creation| {
        let memory = Slot::take(&folder).map(|slot| Memory::new(slot, creation.storage));
        Desktop::new(creation, memory, Box::new(App::stored)).expect("the first scenario can be run")
    });
    screen.run_steps(2);
    screen
}

fn seed(screen: &mut Screen) -> u64 {
    app(screen).session().scenario().seed
}

fn app(screen: &mut Screen) -> &mut App {
    screen.state_mut().app().expect("it is there")
}

fn set_seed(screen: &mut Screen, seed: u64) {
    let session = app(screen).session_mut();
    session.set_scenario(Scenario { seed, ..session.scenario().clone() });
    screen.run_steps(2);
}

/// A note about a crash with this seed on screen, and a state with another one.
fn crashed(folder: &Path) {
    let mut screen = started(folder);
    set_seed(&mut screen, 77);
    let session = app(&mut screen).saved().text().expect("it can be written");
    set_seed(&mut screen, 66);
    drop(screen);
    let note = serde_json::json!({
        "kalmanscope_crash": 1, "version": "0.1.0", "message": "the device is lost", "place": "src/main.rs:1:1",
        "thread": "main", "time": 0, "state": "state.json", "session": session,
    });
    std::fs::write(folder.join("crash.json"), note.to_string()).expect("it can be written");
}

#[test]
fn the_state_comes_back_and_two_windows_have_their_own() {
    let folder = tempfile::tempdir().expect("a folder can be made");
    let mut first = started(folder.path());
    assert_eq!(app(&mut first).notice(), None);
    set_seed(&mut first, 5);
    drop(first);
    let mut again = started(folder.path());
    assert_eq!((seed(&mut again), app(&mut again).notice()), (5, None));
    let mut second = started(folder.path());
    let notice = app(&mut second).notice().expect("it is said").to_owned();
    assert!(notice.contains("open in another window") && notice.contains("state-2.json"), "{notice}");
    assert_eq!(seed(&mut second), 5, "it begins with the state of the first");
    set_seed(&mut second, 6);
    drop(second);
    drop(again);
    let mut again = started(folder.path());
    let mut second = started(folder.path());
    assert_eq!((seed(&mut again), seed(&mut second)), (5, 6));
}

#[test]
fn a_crash_is_told_and_its_settings_are_restored() {
    let folder = tempfile::tempdir().expect("a folder can be made");
    crashed(folder.path());
    let mut screen = started(folder.path());
    assert!(screen.state_mut().app().is_none(), "nothing is computed before the user has chosen");
    screen.get_by_label("the device is lost");
    screen.get_by_label_contains("src/main.rs:1:1, version 0.1.0");
    // Closed without a choice, the crash is shown again.
    drop(screen);
    let mut screen = started(folder.path());
    screen.get_by_label("Restore").click();
    screen.run_steps(3);
    assert_eq!(seed(&mut screen), 77);
    drop(screen);
    assert!(folder.path().join("last-crash.json").exists());
    let mut screen = started(folder.path());
    assert_eq!(seed(&mut screen), 77, "it is told once");
}

#[test]
fn a_user_may_start_anew_after_a_crash() {
    let folder = tempfile::tempdir().expect("a folder can be made");
    crashed(folder.path());
    let first = {
        let other = tempfile::tempdir().expect("a folder can be made");
        seed(&mut started(other.path()))
    };
    let mut screen = started(folder.path());
    screen.get_by_label("Start anew").click();
    screen.run_steps(3);
    assert_eq!(seed(&mut screen), first);
    drop(screen);
    crashed(folder.path());
    let screen = started(folder.path());
    screen.get_by_label_contains("at the same place before");
}

#[test]
fn a_note_that_cannot_be_read_restores_the_state_that_was_saved() {
    let folder = tempfile::tempdir().expect("a folder can be made");
    crashed(folder.path());
    std::fs::write(folder.path().join("crash.json"), "{").expect("it can be written");
    let mut screen = started(folder.path());
    screen.get_by_label_contains("The note about the crash cannot be read");
    screen.get_by_label("Restore").click();
    screen.run_steps(3);
    assert_eq!(seed(&mut screen), 66);
}

#[test]
fn a_torn_state_is_said_on_screen() {
    let folder = tempfile::tempdir().expect("a folder can be made");
    for seed in [5, 6] {
        let mut screen = started(folder.path());
        set_seed(&mut screen, seed);
    }
    std::fs::write(folder.path().join("state.json"), "{\"kalmanscope_st").expect("it can be written");
    let mut screen = started(folder.path());
    let notice = app(&mut screen).notice().expect("it is said").to_owned();
    assert!(notice.contains("it is damaged") && notice.contains("The copy before it is taken"), "{notice}");
    assert_eq!(seed(&mut screen), 5);
}

#[test]
fn a_missing_place_is_said_and_the_explorer_starts() {
    let folder = tempfile::tempdir().expect("a folder can be made");
    let file = folder.path().join("file");
    std::fs::write(&file, "").expect("it can be written");
    let mut screen = started(&file);
    assert!(app(&mut screen).notice().is_some_and(|notice| notice.starts_with("Nothing of this session is kept")));
}

#[test]
fn the_state_of_an_older_program_is_taken_over_once() {
    let folder = tempfile::tempdir().expect("a folder can be made");
    let mut older = Older::default();
    let scenario = Scenario { seed: 9, ..Scenario::default() };
    eframe::App::save(&mut App::with_scenario(scenario).expect("it can be run"), &mut older);
    older.set_string("window", "its place".to_owned());
    let slot = Slot::take(folder.path()).expect("there is a place");
    let memory = Memory::new(slot, Some(&older));
    let app = memory.start(&Context::default(), Box::new(App::stored)).expect("it can be run");
    assert_eq!((app.session().scenario().seed, app.notice()), (9, None));
    let state = app.saved();
    let mut desktop = Desktop { stage: Stage::Running(Box::new(app)), memory: Some(memory) };
    eframe::App::save(&mut desktop, &mut older);
    assert!(older.get_string(KEY).is_some(), "it is not yet on the disk");
    desktop.memory.iter().for_each(|memory| memory.keeper.follow(state.clone()));
    eframe::App::on_exit(&mut desktop, None);
    eframe::App::save(&mut desktop, &mut older);
    assert_eq!(older.0.keys().collect::<Vec<_>>(), ["window"]);
}
