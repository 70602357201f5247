//! A note about a crash, which the next start shows.

use std::fs;
use std::io::ErrorKind;
use std::panic::{self, PanicHookInfo};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{SystemTime, UNIX_EPOCH};

use kalmanscope_cli::output;
use kalmanscope_core::Document;
use serde::{Deserialize, Serialize};

use super::keeper::Kept;

/// The newest format.
const VERSION: u64 = 1;

/// A crash.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Crash {
    /// The format of the note.
    kalmanscope_crash: u64,
    /// The program's version.
    pub(super) version: String,
    /// The program's own words.
    pub(super) message: String,
    /// The place in the source.
    pub(super) place: String,
    /// The name of the thread.
    pub(super) thread: String,
    /// Seconds since 1970, by the machine's clock.
    time: u64,
    /// The file of the saved state.
    pub(super) state: String,
    /// The state at the crash, if it could be read.
    pub(super) session: Option<String>,
}

impl Crash {
    fn new(info: &PanicHookInfo<'_>, kept: &Kept, state: &Path) -> Self {
        let time = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_secs());
        Self {
            kalmanscope_crash: VERSION,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            message: info.payload_as_str().unwrap_or("no words").to_owned(),
            place: info.location().map_or_else(|| "an unknown place".to_owned(), ToString::to_string),
            thread: thread::current().name().unwrap_or("without a name").to_owned(),
            time,
            state: state.display().to_string(),
            session: kept.text(),
        }
    }

    /// The note at a path, if there is one.
    ///
    /// # Errors
    /// The reason in words where it cannot be read.
    pub(super) fn read(path: &Path) -> Result<Option<Self>, String> {
        let text = match fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(error.to_string()),
        };
        let crash: Self = Document::read_json(&text).map_err(|error| error.to_string())?;
        Ok(Some(crash))
    }

    fn write(&self, path: &Path) -> Result<(), String> {
        let text = Document::json_lines(self).map_err(|error| error.to_string())?;
        output::write(path, |file| file.write_all(text.as_bytes())).map_err(|error| error.to_string())
    }
}

/// Notes the first panic of any thread from now on at `note`, before the usual message about it.
pub(super) fn note_panics(note: &Path, state: &Path, kept: &Kept) {
    let (note, state, kept) = (note.to_owned(), state.to_owned(), kept.clone());
    let (is_noted, usual) = (AtomicBool::new(false), panic::take_hook());
    panic::set_hook(Box::new(move |info| {
        // Writing the note may crash too.
        if !is_noted.swap(true, Ordering::SeqCst)
            && let Err(reason) = Crash::new(info, &kept, &state).write(&note)
        {
            eprintln!("error: the crash cannot be noted in {}: {reason}", note.display());
        }
        usual(info);
    }));
}

/// Keeps the note of a crash that the user has seen, for a report, in place of an older one.
pub(super) fn put_aside(note: &Path, told: &Path) {
    if let Err(error) = fs::rename(note, told) {
        log::error!("The note about the crash cannot be kept: {error}");
        fs::remove_file(note).ok();
    }
}

#[cfg(test)]
mod tests {
    use std::env;
    use std::path::PathBuf;
    use std::process::Command;

    use kalmanscope::App;
    use kalmanscope_core::Scenario;

    use super::super::keeper::Keeper;
    use super::super::slot::Slot;
    use super::super::state_file::StateFile;
    use super::*;

    /// The folder of the state, for the program that this test starts: itself.
    const FOLDER: &str = "KALMANSCOPE_TEST_CRASHES_IN";

    /// A panic that cannot unwind ends the program, as each does in a release.
    extern "C" fn end_by_a_panic() {
        panic!("the device is lost");
    }

    fn crash_in(folder: &Path) {
        let slot = Slot::take(folder).expect("there is a place");
        let keeper = Keeper::new(StateFile::open(&slot).0);
        note_panics(&slot.path("crash"), &slot.path("state"), keeper.kept());
        let scenario = Scenario { seed: 77, ..Scenario::default() };
        keeper.follow(App::with_scenario(scenario).expect("it can be run").saved());
        end_by_a_panic();
    }

    #[test]
    fn a_crash_is_noted_before_the_program_is_gone() {
        if let Some(folder) = env::var_os(FOLDER) {
            return crash_in(&PathBuf::from(folder));
        }
        let folder = tempfile::tempdir().expect("a folder can be made");
        let name = format!("{}::a_crash_is_noted_before_the_program_is_gone", module_path!());
        let (_, name) = name.split_once("::").expect("it has a crate");
        let program = env::current_exe().expect("it is known");
        let output = Command::new(program).args(["--exact", name]).env(FOLDER, folder.path()).output();
        let output = output.expect("it can be started");
        assert!(!output.status.success() && output.status.code() != Some(101), "it is aborted: {output:?}");
        assert!(!folder.path().join("state.json").exists(), "there was no time to save");

        let crash = Crash::read(&folder.path().join("crash.json")).expect("it can be read").expect("it is there");
        assert_eq!((crash.message.as_str(), crash.version.as_str()), ("the device is lost", env!("CARGO_PKG_VERSION")));
        assert!(crash.place.contains("crash.rs:") && crash.state.ends_with("state.json"), "{crash:?}");
        assert!(crash.session.is_some_and(|session| session.contains("seed = 77")));
    }

    #[test]
    fn a_note_that_cannot_be_read_is_no_silence() {
        let folder = tempfile::tempdir().expect("a folder can be made");
        let path = folder.path().join("crash.json");
        assert_eq!(Crash::read(&path), Ok(None));
        for text in ["", "{", "{}"] {
            fs::write(&path, text).expect("it can be written");
            assert!(Crash::read(&path).is_err(), "{text}");
        }
        put_aside(&path, &folder.path().join("last-crash.json"));
        assert_eq!(Crash::read(&path), Ok(None));
    }
}
