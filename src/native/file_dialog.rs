//! The desktop's dialog that chooses a file.

use std::path::PathBuf;
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use kalmanscope::drop;
use kalmanscope::inbox::{Arrival, Choose};
use rfd::AsyncFileDialog;

/// Limits the time of a dialog that has not opened. No user closes one so fast, and the library reports a cancelled
/// dialog like one that could not open.
const FAST: Duration = Duration::from_millis(500);

/// The message if no dialog opens.
const NO_DIALOG: &str = "This desktop opens no dialog for files: neither its portal nor zenity answers. Drop the file on the \
                         window, or start the program with it: kalmanscope FILE.";

/// Asks for a file in a dialog beside the window, which goes on meanwhile. There is one dialog at a time.
pub(super) fn choose() -> Choose {
    let mut open: Option<JoinHandle<()>> = None;
    Box::new(move |ctx, inbox| {
        if open.as_ref().is_some_and(|thread| !thread.is_finished()) {
            return;
        }
        // Made here and not on the thread, because macOS opens dialogs on the main thread only.
        let dialog = AsyncFileDialog::new().set_title("Open a file").pick_file();
        let (answers, window) = (inbox.clone(), ctx.clone());
        let wait = move || {
            let begin = Instant::now();
            let path = pollster::block_on(dialog).map(|file| file.path().to_owned());
            if let Some(arrival) = arrival(path, begin.elapsed()) {
                answers.put(arrival, &window);
            }
        };
        match thread::Builder::new().name("file dialog".to_owned()).spawn(wait) {
            Ok(thread) => open = Some(thread),
            Err(error) => inbox.put(Arrival::Failure(format!("No dialog can be opened: {error}.")), ctx),
        }
    })
}

/// The chosen file, or a sentence if no dialog has opened. `None` if the user has cancelled it.
fn arrival(path: Option<PathBuf>, time: Duration) -> Option<Arrival> {
    match path {
        Some(path) => Some(Arrival::File(drop::file_name(&path), drop::read_path(&path))),
        None if time < FAST => Some(Arrival::Failure(NO_DIALOG.to_owned())),
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
    fn the_chosen_file_is_read() {
        let path = std::env::temp_dir().join(format!("kalmanscope-chosen-{}.csv", std::process::id()));
        std::fs::write(&path, b"t,x\n").expect("a file can be written");
        let read = arrival(Some(path.clone()), Duration::ZERO);
        std::fs::remove_file(&path).expect("it can be removed");
        let Some(Arrival::File(name, Ok(bytes))) = read else { panic!("{read:?}") };
        assert!(path.ends_with(name));
        assert_eq!(bytes, b"t,x\n");
        let gone = arrival(Some(path), Duration::ZERO);
        assert!(matches!(gone, Some(Arrival::File(_, Err(_)))), "{gone:?}");
    }
}
