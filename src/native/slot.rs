//! The files of one instance of the program: two that run at once do not overwrite each other's.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

/// Limits the running instances that keep their state.
const MOST: u32 = 16;

/// The names of the files of one instance, reserved while it runs.
#[derive(Debug)]
pub(super) struct Slot {
    folder: PathBuf,
    number: u32,
    /// The system gives the lock back when the program ends, however it ends.
    _lock: File,
}

impl Slot {
    /// The first names in a folder that no other instance uses.
    ///
    /// # Errors
    /// The reason in words if there are none.
    pub(super) fn take(folder: &Path) -> Result<Self, String> {
        let reason = |error: io::Error| format!("{}: {error}", folder.display());
        fs::create_dir_all(folder).map_err(reason)?;
        for number in 1..=MOST {
            let path = named(folder, "state", number, "lock");
            let lock = OpenOptions::new().write(true).create(true).truncate(false).open(path).map_err(reason)?;
            match lock.try_lock() {
                Err(TryLockError::WouldBlock) => continue,
                Err(TryLockError::Error(error)) => log::warn!("The state is not locked: {error}"),
                Ok(()) => {}
            }
            return Ok(Self { folder: folder.to_owned(), number, _lock: lock });
        }
        Err(format!("{MOST} other windows are open"))
    }

    /// The path of one of its files.
    pub(super) fn path(&self, name: &str) -> PathBuf {
        named(&self.folder, name, self.number, "json")
    }

    /// The path of the file of this name of the first instance, if this is another one.
    pub(super) fn path_of_first(&self, name: &str) -> Option<PathBuf> {
        self.is_further().then(|| named(&self.folder, name, 1, "json"))
    }

    /// The file of the toolkit, with the window's place; that of the first instance is the usual one.
    pub(super) fn window_path(&self) -> Option<PathBuf> {
        self.is_further().then(|| named(&self.folder, "app", self.number, "ron"))
    }

    /// Whether another instance was there first.
    pub(super) fn is_further(&self) -> bool {
        self.number > 1
    }
}

fn named(folder: &Path, name: &str, number: u32, end: &str) -> PathBuf {
    folder.join(if number == 1 { format!("{name}.{end}") } else { format!("{name}-{number}.{end}") })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instances_have_files_of_their_own_and_give_them_back() {
        let folder = tempfile::tempdir().expect("a folder can be made");
        let inner = folder.path().join("not/yet");
        let first = Slot::take(&inner).expect("there is a place");
        let second = Slot::take(&inner).expect("there is a place");
        assert_eq!((first.path("state"), second.path("state")), (inner.join("state.json"), inner.join("state-2.json")));
        assert_eq!((first.window_path(), second.window_path()), (None, Some(inner.join("app-2.ron"))));
        assert_eq!(second.path_of_first("state"), Some(inner.join("state.json")));
        drop(first);
        assert!(!Slot::take(&inner).expect("there is a place").is_further());
        let many: Vec<Slot> = (2..=MOST).map(|_| Slot::take(&inner).expect("there is a place")).collect();
        assert!(Slot::take(&inner).expect_err("all are taken").contains("16 other windows"), "{}", many.len());
    }

    #[test]
    fn a_place_that_is_no_folder_is_said() {
        let folder = tempfile::tempdir().expect("a folder can be made");
        let file = folder.path().join("file");
        fs::write(&file, "").expect("it can be written");
        assert!(Slot::take(&file).expect_err("it is a file").contains("file"));
    }
}
