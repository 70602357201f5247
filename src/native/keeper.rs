//! Saves the state soon after each change, on a thread of its own, since there are no frames while nothing changes.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, TryLockError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use kalmanscope::saved::Saved;

use super::state_file::StateFile;

/// The time from a change to its save.
const SOON: Duration = Duration::from_secs(2);

/// Keeps the state on the disk.
pub(super) struct Keeper {
    kept: Kept,
    writer: Option<JoinHandle<()>>,
}

/// The state and its file; copies share them, also between threads.
#[derive(Clone)]
pub(super) struct Kept(Arc<Shared>);

struct Shared {
    present: Mutex<Present>,
    changed: Condvar,
    /// Locked while it is written, so that writers take turns.
    file: Mutex<StateFile>,
}

#[derive(Default)]
struct Present {
    state: Option<Saved>,
    /// The time of the first change that is not on the disk.
    since: Option<Instant>,
    /// The reason why the last save has failed, until the user has seen it.
    trouble: Option<String>,
    is_over: bool,
}

impl Keeper {
    /// Keeps a state in a file, from the first [`Self::follow`] on.
    pub(super) fn new(file: StateFile) -> Self {
        Self::with(file, SOON)
    }

    fn with(file: StateFile, soon: Duration) -> Self {
        let (present, changed, file) = (Mutex::default(), Condvar::new(), Mutex::new(file));
        let kept = Kept(Arc::new(Shared { present, changed, file }));
        let writing = kept.clone();
        let writer = thread::Builder::new().name("saved state".to_owned()).spawn(move || writing.write_soon(soon));
        if let Err(error) = &writer {
            kept.present().trouble = Some(error.to_string());
        }
        Self { kept, writer: writer.ok() }
    }

    /// Takes in the state of a frame.
    pub(super) fn follow(&self, state: Saved) {
        let mut present = self.kept.present();
        if present.state.as_ref() != Some(&state) {
            present.state = Some(state);
            present.since.get_or_insert_with(Instant::now);
            self.kept.0.changed.notify_one();
        }
    }

    /// The reason why the last save has failed, once.
    pub(super) fn trouble(&self) -> Option<String> {
        self.kept.present().trouble.take()
    }

    /// The state, for other threads.
    pub(super) fn kept(&self) -> &Kept {
        &self.kept
    }
}

impl Drop for Keeper {
    /// Saves what is not saved.
    fn drop(&mut self) {
        self.kept.present().is_over = true;
        self.kept.0.changed.notify_one();
        if let Some(writer) = self.writer.take() {
            writer.join().ok();
        }
        self.kept.save();
    }
}

impl Kept {
    fn present(&self) -> MutexGuard<'_, Present> {
        self.0.present.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The file.
    pub(super) fn file(&self) -> MutexGuard<'_, StateFile> {
        self.0.file.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Saves what is not saved, at once.
    pub(super) fn save(&self) {
        let mut file = self.file();
        let unsaved = {
            let mut present = self.present();
            present.since.take().and_then(|_| present.state.clone())
        };
        let Some(state) = unsaved else { return };
        let stored = state.store(&mut *file).map_err(|error| error.to_string());
        if let Err(reason) = stored.and_then(|()| file.write()) {
            log::error!("The state is not saved: {reason}");
            self.present().trouble = Some(reason);
        }
    }

    /// The present state as text, even if another thread holds the lock: a crash does not wait.
    pub(super) fn text(&self) -> Option<String> {
        let present = match self.0.present.try_lock() {
            Ok(present) => present,
            Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
            Err(TryLockError::WouldBlock) => return None,
        };
        present.state.as_ref()?.text().ok()
    }

    /// Saves each change after some time, until all is over.
    fn write_soon(&self, soon: Duration) {
        let wait = |present| self.0.changed.wait(present).unwrap_or_else(PoisonError::into_inner);
        loop {
            let mut present = self.present();
            while present.since.is_none() && !present.is_over {
                present = wait(present);
            }
            if present.is_over {
                return;
            }
            let rest = present.since.map_or(Duration::ZERO, |since| soon.saturating_sub(since.elapsed()));
            if rest.is_zero() {
                drop(present);
                self.save();
            } else {
                // Woken early, it waits again for the rest.
                drop(self.0.changed.wait_timeout(present, rest));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use eframe::Storage as _;
    use kalmanscope::App;
    use kalmanscope::saved::KEY;
    use kalmanscope_core::Scenario;

    use super::super::slot::Slot;
    use super::*;

    /// Limits the time until a save, on a slow machine.
    const PATIENCE: Duration = Duration::from_secs(60);

    fn state(seed: u64) -> Saved {
        let scenario = Scenario { seed, duration: 0.1, ..Scenario::default() };
        App::with_scenario(scenario).expect("it can be run").saved()
    }

    fn on_disk(slot: &Slot) -> Option<String> {
        StateFile::open(slot).0.get_string(KEY)
    }

    #[test]
    fn a_change_is_saved_soon_at_rest() {
        let folder = tempfile::tempdir().expect("a folder can be made");
        let slot = Slot::take(folder.path()).expect("there is a place");
        let keeper = Keeper::with(StateFile::open(&slot).0, Duration::from_millis(50));
        keeper.follow(state(1));
        let begin = Instant::now();
        while on_disk(&slot).is_none() {
            assert!(begin.elapsed() < PATIENCE, "nobody saves");
            thread::sleep(Duration::from_millis(5));
        }
        assert!(begin.elapsed() >= Duration::from_millis(50) || cfg!(windows));
        assert_eq!(on_disk(&slot), state(1).text().ok());
        // The same state is not saved again.
        std::fs::remove_file(slot.path("state")).expect("it is there");
        keeper.follow(state(1));
        thread::sleep(Duration::from_millis(200));
        assert!(!slot.path("state").exists());
    }

    #[test]
    fn a_signal_and_an_end_save_at_once() {
        let folder = tempfile::tempdir().expect("a folder can be made");
        let slot = Slot::take(folder.path()).expect("there is a place");
        let keeper = Keeper::with(StateFile::open(&slot).0, PATIENCE);
        keeper.follow(state(1));
        assert_eq!(keeper.kept().text(), state(1).text().ok());
        keeper.kept().save();
        assert_eq!(on_disk(&slot), state(1).text().ok());
        keeper.follow(state(2));
        drop(keeper);
        assert_eq!(on_disk(&slot), state(2).text().ok());
    }

    #[test]
    fn a_save_that_fails_is_told_once() {
        let folder = tempfile::tempdir().expect("a folder can be made");
        let slot = Slot::take(&folder.path().join("gone")).expect("there is a place");
        let keeper = Keeper::with(StateFile::open(&slot).0, PATIENCE);
        std::fs::remove_dir_all(folder.path().join("gone")).expect("it can be removed");
        keeper.follow(state(1));
        keeper.kept().save();
        assert!(keeper.trouble().expect("it is told").contains("state.json"));
        assert_eq!(keeper.trouble(), None);
    }
}
