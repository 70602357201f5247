//! The desktop's dialogs that choose a file to open, and a place for one.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use kalmanscope::export::Deliver;
use kalmanscope::inbox::{self, Arrival, Choose};
use kalmanscope::text::sentence;
use kalmanscope_cli::output;
use rfd::{AsyncFileDialog, FileHandle};

/// Limits the time of a dialog that has not opened. No user closes one so fast, and the library reports a cancelled
/// dialog like one that could not open.
const FAST: Duration = Duration::from_millis(500);

const NO_DIALOG: &str = "this desktop opens no dialog for files: neither its portal nor zenity answers";

pub(super) fn choose() -> Choose {
    let mut open: Option<JoinHandle<()>> = None;
    Box::new(move |ctx, inbox| {
        // A second click must not open a second dialog, which may lie behind the first.
        if open.as_ref().is_some_and(|thread| !thread.is_finished()) {
            return;
        }
        // Made here and not on the thread, because macOS opens dialogs on the main thread only.
        let dialog = AsyncFileDialog::new().set_title("Open a file").pick_file();
        let (answers, window) = (inbox.clone(), ctx.clone());
        let answer = move |path, time| {
            if let Some(arrival) = arrival(path, time) {
                answers.put(arrival, &window);
            }
        };
        match wait(dialog, answer) {
            Ok(thread) => open = Some(thread),
            Err(error) => inbox.put(Arrival::Failure(format!("No dialog can be opened: {error}.")), ctx),
        }
    })
}

pub(super) fn save() -> Deliver {
    Box::new(|file, done| {
        let dialog = AsyncFileDialog::new().set_title("Save a file").set_file_name(&file.name).save_file();
        let written = Arc::clone(&done);
        let answer = move |path, time| {
            if let Some(end) = saved(path, &file.contents, time) {
                written(end);
            }
        };
        if let Err(error) = wait(dialog, answer) {
            done(Err(error.to_string()));
        }
    })
}

fn wait(
    dialog: impl Future<Output = Option<FileHandle>> + Send + 'static,
    answer: impl FnOnce(Option<PathBuf>, Duration) + Send + 'static,
) -> io::Result<JoinHandle<()>> {
    thread::Builder::new().name("file dialog".to_owned()).spawn(move || {
        let begin = Instant::now();
        let path = pollster::block_on(dialog).map(|file| file.path().to_owned());
        answer(path, begin.elapsed());
    })
}

fn saved(path: Option<PathBuf>, contents: &[u8], time: Duration) -> Option<Result<String, String>> {
    let Some(path) = path else { return (time < FAST).then(|| Err(NO_DIALOG.to_owned())) };
    let written = output::write(&path, |file| file.write_all(contents));
    let place = path.display();
    Some(written.map(|()| place.to_string()).map_err(|error: io::Error| format!("{place}: {error}")))
}

fn arrival(path: Option<PathBuf>, time: Duration) -> Option<Arrival> {
    match path {
        Some(path) => Some(Arrival::File(inbox::file_name(&path), inbox::read_path(&path))),
        None if time < FAST => Some(Arrival::Failure(format!(
            "{}. Drop the file on the window, or start the program with it: kalmanscope FILE.",
            sentence(NO_DIALOG)
        ))),
        None => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dialog_that_does_not_open_is_told_from_one_that_is_cancelled() {
        assert!(matches!(arrival(None, Duration::ZERO), Some(Arrival::Failure(_))));
        assert!(arrival(None, Duration::from_secs(1)).is_none());
    }

    #[test]
    fn a_file_is_written_where_the_user_says() {
        let folder = tempfile::tempdir().expect("a folder can be made");
        let path = folder.path().join("a.csv");
        let saved = |path: Option<PathBuf>, seconds| saved(path, b"t,x\n", Duration::from_secs(seconds));
        assert_eq!(saved(Some(path.clone()), 0), Some(Ok(path.display().to_string())));
        assert_eq!(std::fs::read(path).expect("it is there"), b"t,x\n");
        let nowhere = saved(Some(folder.path().join("none/a.csv")), 5);
        assert!(matches!(&nowhere, Some(Err(reason)) if reason.contains("a.csv: ")), "{nowhere:?}");
        assert_eq!((saved(None, 5), saved(None, 0)), (None, Some(Err(NO_DIALOG.to_owned()))));
    }
}
