//! A note about a crash, which the next start shows.

use std::fs;
use std::panic;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use super::state_file::{self, set_aside};

const NOTES: [&str; 2] = ["crash-at-start.txt", "crash.txt"];

const SEEN: &str = "last-crash.txt";

/// A crash so soon after the start may be due to the session: the user had no time to open another one.
const SOON: Duration = Duration::from_secs(10);

/// Notes the first panic of any thread from now on, before the usual message about it.
pub(super) fn note_panics(folder: &Path) {
    let (folder, begin, is_noted) = (folder.to_owned(), Instant::now(), AtomicBool::new(false));
    let usual = panic::take_hook();
    panic::set_hook(Box::new(move |info| {
        // Writing the note may crash too.
        if !is_noted.swap(true, Ordering::SeqCst) {
            let message = info.payload_as_str().unwrap_or("no words");
            let place = info.location().map_or_else(|| "an unknown place".to_owned(), ToString::to_string);
            note(&folder, &format!("“{message}”, at {place}"), begin.elapsed());
        }
        usual(info);
    }));
}

fn note(folder: &Path, error: &str, after: Duration) {
    let thread = thread::current();
    let (version, seconds) = (env!("CARGO_PKG_VERSION"), after.as_secs());
    let name = thread.name().unwrap_or("without a name");
    let text = format!("{error}, in the thread “{name}” of version {version} after {seconds} s.");
    let file = NOTES[usize::from(after >= SOON)];
    if let Err(error) = fs::write(folder.join(file), text) {
        eprintln!("error: the crash cannot be noted in {}: {error}", folder.display());
    }
}

pub(super) fn last(folder: &Path) -> Option<String> {
    let (name, text) = NOTES.iter().find_map(|name| Some((*name, fs::read(folder.join(name)).ok()?)))?;
    let (note, seen) = (folder.join(name), folder.join(SEEN));
    let note = fs::rename(&note, &seen).map_or(note, |()| seen);
    let (text, note) = (String::from_utf8_lossy(&text), note.display());
    let said = format!("Kalmanscope has stopped with an error: {text} Please add {note} to a report.");
    let aside = if name == NOTES[0] { set_aside(&folder.join(state_file::NAME)).ok() } else { None };
    let aside = aside.map(|place| format!(" The session may be the reason; it is kept as {}.", place.display()));
    Some(said + &aside.unwrap_or_default())
}

/// Forgets the notes: a panic of a thread that has not ended the program was no crash.
pub(super) fn forget(folder: &Path) {
    NOTES.iter().for_each(|name| drop(fs::remove_file(folder.join(name))));
}

#[cfg(test)]
mod tests {
    use std::env;
    use std::process::Command;

    use kalmanscope::share::Picture;

    use super::super::state_file::StateFile;
    use super::*;

    const FOLDER: &str = "KALMANSCOPE_TEST_CRASHES_IN";

    extern "C" fn end_by_a_panic() {
        panic!("the device is lost");
    }

    #[test]
    fn a_crash_is_noted_before_the_program_is_gone() {
        if let Some(folder) = env::var_os(FOLDER) {
            note_panics(Path::new(&folder));
            return end_by_a_panic();
        }
        let folder = tempfile::tempdir().expect("a folder can be made");
        let name = format!("{}::a_crash_is_noted_before_the_program_is_gone", module_path!());
        let (_, name) = name.split_once("::").expect("it has a crate");
        let program = env::current_exe().expect("it is known");
        let output = Command::new(program).args(["--exact", name]).env(FOLDER, folder.path()).output();
        let output = output.expect("it can be started");
        assert!(!output.status.success() && output.status.code() != Some(101), "it is aborted: {output:?}");

        let said = last(folder.path()).expect("there is a note");
        let version = env!("CARGO_PKG_VERSION");
        for part in ["“the device is lost”, at ", "src/native/crash.rs:", version, "last-crash.txt"] {
            assert!(said.contains(part), "no {part}: {said}");
        }
        assert_eq!(last(folder.path()), None, "it is said once");
        assert!(folder.path().join(SEEN).exists());
    }

    #[test]
    fn a_session_that_may_be_the_reason_does_not_end_the_next_start_too() {
        let folder = tempfile::tempdir().expect("a folder can be made");
        let picture = Picture { speed: 3.0, ..Picture::default() };
        for (after, is_there) in [(20, true), (3, false)] {
            let (mut file, _) = StateFile::open(folder.path()).expect("there is a place");
            assert_eq!(file.save(&picture), None);
            note(folder.path(), "“x”, at y", Duration::from_secs(after));
            let said = last(folder.path()).expect("there is a note");
            assert_eq!(said.contains("state-kept-1.json"), !is_there, "{said}");
            let (_, last) = StateFile::open(folder.path()).expect("there is a place");
            assert_eq!(last, Ok(is_there.then(|| picture.clone())));
        }
        let kept = fs::read(folder.path().join("state-kept-1.json")).expect("it is kept");
        assert!(String::from_utf8_lossy(&kept).contains("\"speed\": 3.0"), "it can be dropped on the window");
    }

    #[test]
    fn a_note_of_a_thread_that_has_not_ended_the_program_is_forgotten() {
        let folder = tempfile::tempdir().expect("a folder can be made");
        note(folder.path(), "“x”, at y", SOON);
        forget(folder.path());
        assert_eq!(last(folder.path()), None);
    }
}
