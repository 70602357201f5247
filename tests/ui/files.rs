//! Files dropped on the window, or chosen in a dialog.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use kalmanscope::inbox::{Arrival, Choose};
use kalmanscope_lessons::BUILT_IN;

use super::*;

const AUTHORS: &str = include_str!("../../lessons/README.md");

#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

pub(super) fn drop_file(screen: &mut Screen, name: &str, contents: &[u8]) {
    /// Tells the folders of tests at the same time apart.
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let folder = std::env::temp_dir().join(format!("kalmanscope-{}-{count}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder can be made");
    let path = folder.join(name);
    std::fs::write(&path, contents).expect("a file can be written");
    drop_path(screen, path);
    std::fs::remove_dir_all(folder).expect("the folder can be removed");
}

pub(super) fn drop_path(screen: &mut Screen, path: PathBuf) {
    screen.input_mut().dropped_files = vec![Arc::new(Dropped(path))];
    screen.step();
    wait(screen);
}

fn wait(screen: &mut Screen) {
    while screen.state().inbox.is_shared() {
        std::thread::yield_now();
    }
    screen.run_steps(4);
}

/// Frames go on while a file is read that takes long: here a pipe into which nobody has written yet.
#[cfg(unix)]
#[test]
fn a_dropped_file_is_read_beside_the_frames() {
    let folder = tempfile::tempdir().expect("a folder can be made");
    let path = folder.path().join("slow.toml");
    let made = std::process::Command::new("mkfifo").arg(&path).status().expect("mkfifo can be run");
    assert!(made.success());
    let mut screen = screen(DESKTOP, Theme::Light);
    screen.input_mut().dropped_files = vec![Arc::new(Dropped(path.clone()))];
    screen.run_steps(5);
    assert!(screen.state().inbox.is_shared());
    std::fs::write(&path, lesson()).expect("the pipe can be written");
    wait(&mut screen);
    screen.get_by_label("A filter that forgets");
}

fn lesson() -> &'static str {
    AUTHORS.split_once("```toml\n").and_then(|(_, rest)| rest.split_once("```")).expect("the page has a lesson").0
}

#[test]
fn a_dropped_lesson_begins() {
    let mut screen = screen(DESKTOP, Theme::Light);
    drop_file(&mut screen, "lesson.toml", lesson().as_bytes());
    screen.get_by_label("A filter that forgets");
    screen.get_by_label("Will the filter notice the loss at once?");
    assert_eq!((screen.state().notice(), screen.state().session().time()), (None, 29.5));
    for label in ["Show me", "Next", "λ = 1.02"] {
        click(&mut screen, label);
    }
    assert!(screen.query_by_label_contains("Next: ").is_none(), "it is not in the menu");
    click(&mut screen, "Done");
    assert!(screen.query_by_label("A filter that forgets").is_none());
}

#[test]
fn a_dropped_scenario_is_played() {
    let mut screen = screen(DESKTOP, Theme::Light);
    drop_file(&mut screen, "scenario.toml", BUILT_IN[2].toml().as_bytes());
    let mut expected = BUILT_IN[2].scenario().expect("it is valid");
    expected.number_filters();
    assert_eq!((screen.state().notice(), scenario(&screen)), (None, &expected));
    assert!(screen.state().session().playing());
}

#[test]
fn a_file_that_cannot_be_opened_is_reported_and_changes_nothing() {
    let mut screen = screen(DESKTOP, Theme::Light);
    let before = scenario(&screen).clone();
    for (contents, reason) in [
        (lesson().replace("answer = 2", "answer = 4").into_bytes(), "the question has the `answer` 4"),
        (b"duration = -1".to_vec(), "duration"),
        (b"look".to_vec(), "TOML"),
        (vec![0xff, 0xfe], "it is not text"),
        (vec![b'#'; 1_000_001], "it is larger than 1 MB"),
    ] {
        drop_file(&mut screen, "bad.toml", &contents);
        let notice = screen.state().notice().expect("it is reported").to_owned();
        assert!(notice.starts_with("“bad.toml” cannot be opened: ") && notice.contains(reason), "{notice}");
        assert_eq!(scenario(&screen), &before);
    }
    drop_path(&mut screen, "none.toml".into());
    let notice = screen.state().notice().expect("it is reported");
    assert!(notice.starts_with("“none.toml” cannot be opened: "), "{notice}");
}

/// A screen on which a file is chosen at once, with the number of times that one was asked for.
fn screen_with_file(size: Vec2, name: &'static str, contents: &'static [u8]) -> (Screen, Arc<AtomicU32>) {
    let asked = Arc::new(AtomicU32::new(0));
    let count = Arc::clone(&asked);
    let choose: Choose = Box::new(move |ctx, inbox| {
        count.fetch_add(1, Ordering::Relaxed);
        inbox.put(Arrival::File(name.to_owned(), Ok(contents.to_vec())), ctx);
    });
    let mut screen = started(size, Theme::Light, |app, _| app.choosing(Some(choose)));
    screen.run_steps(3);
    (screen, asked)
}

#[test]
fn a_file_is_chosen_by_the_button_or_by_its_keys() {
    for (size, by_key) in [(DESKTOP, false), (DESKTOP, true), (PHONE, false)] {
        let (mut screen, asked) = screen_with_file(size, "record.csv", b"t,force,x\n0,1,2\n1,2,3\n2,3,1\n");
        if by_key {
            screen.key_press_modifiers(Modifiers::COMMAND, Key::O);
        } else {
            if size == PHONE {
                click(&mut screen, "Scenario");
            }
            screen.get_by_label("Open a file").click();
        }
        screen.run_steps(6);
        // A phone opens it at once.
        assert_eq!(screen.query_by_label("Open a measured record").is_some(), size == DESKTOP);
        assert_eq!(asked.load(Ordering::Relaxed), 1);
    }
}

#[test]
fn a_file_that_cannot_be_chosen_is_said() {
    let mut screen = screen(DESKTOP, Theme::Light);
    screen.key_press_modifiers(Modifiers::COMMAND, Key::O);
    screen.run_steps(3);
    assert_eq!(screen.state().notice(), Some("A file cannot be chosen here: drop it on the window."));
    let ctx = screen.ctx.clone();
    screen.state().inbox.put(Arrival::Failure("No dialog opens.".to_owned()), &ctx);
    screen.run_steps(3);
    assert_eq!(screen.state().notice(), Some("No dialog opens."));
    let unreadable = Arrival::File("record.csv".to_owned(), Err("it is gone".to_owned()));
    screen.state().inbox.put(unreadable, &ctx);
    screen.run_steps(3);
    screen.get_by_label("“record.csv” cannot be opened: it is gone.");
}
