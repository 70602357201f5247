//! The saved state as a file. It is written to a temporary file, synced and renamed, and the last good one stays as a
//! copy; a checksum shows whether it is whole.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use kalmanscope_cli::output;
use kalmanscope_core::Document;
use kalmanscope_core::import::Hash;
use serde::{Deserialize, Serialize};

use super::slot::Slot;

/// The newest format.
const VERSION: u64 = 1;

/// Limits the size of a file that is read \[bytes\].
const LARGEST: u64 = 64_000_000;

/// Texts with names, as the toolkit's own storage has them.
type Entries = BTreeMap<String, String>;

/// The saved state.
#[derive(Debug)]
pub(super) struct StateFile {
    path: PathBuf,
    /// The file before the last one.
    copy: PathBuf,
    entries: Entries,
}

/// The format.
#[derive(Serialize, Deserialize)]
struct Written {
    kalmanscope_state: u64,
    /// A hash of all names and texts.
    check: String,
    entries: Entries,
}

impl StateFile {
    /// The state of an instance, and a sentence if it is not the one that was saved last. A further instance begins
    /// with the state of the first.
    pub(super) fn open(slot: &Slot) -> (Self, Option<String>) {
        let (path, copy) = (slot.path("state"), slot.path("state-before"));
        let (entries, said) = match read(&path) {
            Ok(Some(entries)) => (entries, None),
            Ok(None) => match read(&copy) {
                Ok(Some(entries)) => (entries, Some(of_copy("was being saved when it ended"))),
                _ => (slot.path_of_first("state").and_then(|first| read(&first).ok()?).unwrap_or_default(), None),
            },
            Err(reason) => {
                let place = keep_damaged(&path, &slot.path("state-damaged"));
                let damage = format!("cannot be read ({reason}); {place}");
                match read(&copy) {
                    Ok(Some(entries)) => (entries, Some(of_copy(&damage))),
                    _ => (Entries::new(), Some(format!("The saved state {damage}. There is no good copy of it."))),
                }
            }
        };
        (Self { path, copy, entries }, said)
    }

    /// Writes it. The earlier file stays as a copy, even if the write is interrupted.
    ///
    /// # Errors
    /// The reason in words where it cannot be written.
    pub(super) fn write(&self) -> Result<(), String> {
        let Self { path, copy, entries } = self;
        let written = Written { kalmanscope_state: VERSION, check: check(entries), entries: entries.clone() };
        let text = Document::json_lines(&written).map_err(|error| error.to_string())?;
        let reason = |error: io::Error| format!("{}: {error}", path.display());
        keep_copy(path, copy).map_err(reason)?;
        output::write(path, |file| file.write_all(text.as_bytes())).map_err(reason)?;
        sync_folder(path).map_err(reason)
    }
}

impl eframe::Storage for StateFile {
    fn get_string(&self, key: &str) -> Option<String> {
        self.entries.get(key).cloned()
    }

    fn set_string(&mut self, key: &str, value: String) {
        self.entries.insert(key.to_owned(), value);
    }

    fn remove_string(&mut self, key: &str) {
        self.entries.remove(key);
    }

    fn flush(&mut self) {
        if let Err(reason) = self.write() {
            log::error!("The state is not saved: {reason}");
        }
    }
}

/// The sentence that the copy is taken in place of the state, which has met with something.
fn of_copy(mishap: &str) -> String {
    format!("The saved state {mishap}. The copy before it is taken.")
}

/// The entries of a file, checked. `None` if there is no file.
///
/// # Errors
/// The reason in words where it is not whole.
fn read(path: &Path) -> Result<Option<Entries>, String> {
    let size = match fs::metadata(path) {
        Ok(found) => found.len(),
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(error.to_string()),
    };
    if size > LARGEST {
        return Err(format!("it has {size} bytes"));
    }
    let text = fs::read(path).map_err(|error| error.to_string())?;
    if text.is_empty() {
        return Err("it is empty".to_owned());
    }
    let text = String::from_utf8(text).map_err(|_| "it is not text".to_owned())?;
    let document = Document::from_json(&text).map_err(|_| "it is damaged".to_owned())?;
    let version: u64 = document.get("kalmanscope_state").and_then(|version| version.read().ok()).unwrap_or(0);
    if version > VERSION {
        return Err(format!("it is of version {version}, and this program reads versions up to {VERSION}"));
    }
    let written: Written = document.read().map_err(|_| "it is damaged".to_owned())?;
    if written.check == check(&written.entries) { Ok(Some(written.entries)) } else { Err("it is damaged".to_owned()) }
}

fn check(entries: &Entries) -> String {
    let mut hash = Hash::default();
    for text in entries.iter().flat_map(|(key, value)| [key, value]) {
        hash.add(&(text.len() as u64).to_le_bytes());
        hash.add(text.as_bytes());
    }
    hash.text()
}

/// Puts a file that cannot be read where nothing overwrites it; says where.
fn keep_damaged(path: &Path, place: &Path) -> String {
    match fs::rename(path, place) {
        Ok(()) => format!("it is kept as {}", place.display()),
        Err(error) => format!("it cannot be kept: {error}"),
    }
}

/// Makes the present file the copy. There is a good file of one of both names at every moment.
fn keep_copy(path: &Path, copy: &Path) -> io::Result<()> {
    if !path.exists() {
        return Ok(());
    }
    match fs::remove_file(copy) {
        Err(error) if error.kind() != ErrorKind::NotFound => return Err(error),
        _ => {}
    }
    // Some file systems have no second names for a file.
    fs::hard_link(path, copy).or_else(|_| fs::rename(path, copy))
}

/// Asks the system to bring the new name to the disk.
#[cfg(unix)]
fn sync_folder(path: &Path) -> io::Result<()> {
    path.parent().map_or(Ok(()), |folder| fs::File::open(folder)?.sync_all())
}

#[cfg(not(unix))]
fn sync_folder(_: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use eframe::Storage as _;

    use super::*;

    /// A folder with the states `old` and `new`, as two saves have left them.
    fn saved_twice() -> (tempfile::TempDir, Slot) {
        let folder = tempfile::tempdir().expect("a folder can be made");
        let slot = Slot::take(folder.path()).expect("there is a place");
        let (mut file, said) = StateFile::open(&slot);
        assert_eq!((file.get_string("a"), said), (None, None));
        for text in ["old", "new"] {
            file.set_string("a", text.to_owned());
            file.write().expect("it can be written");
        }
        (folder, slot)
    }

    fn opened(slot: &Slot) -> (Option<String>, Option<String>) {
        let (file, said) = StateFile::open(slot);
        (file.get_string("a"), said)
    }

    #[test]
    fn the_last_state_comes_back() {
        let (folder, slot) = saved_twice();
        assert_eq!(opened(&slot), (Some("new".to_owned()), None));
        let mut names: Vec<_> = fs::read_dir(folder.path())
            .expect("it is a folder")
            .map(|entry| entry.expect("it can be listed").file_name().into_string().expect("it is text"))
            .collect();
        names.sort();
        assert_eq!(names, ["state-before.json", "state.json", "state.lock"], "no other file is left");
    }

    #[test]
    fn a_torn_state_is_said_and_kept_and_the_copy_is_taken() {
        let whole = {
            let (_folder, slot) = saved_twice();
            fs::read(slot.path("state")).expect("it is there")
        };
        let half = whole[..whole.len() / 2].to_vec();
        let zeros = vec![0; whole.len()];
        let mut state = 7_u64;
        let random: Vec<u8> = std::iter::repeat_with(|| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 56) as u8
        })
        .take(whole.len())
        .collect();
        let changed = String::from_utf8(whole.clone()).expect("it is text").replace("new", "now").into_bytes();
        let newer = String::from_utf8(whole).expect("it is text").replace("state\": 1", "state\": 2").into_bytes();
        for (bytes, reason) in [
            (half, "it is damaged"),
            (Vec::new(), "it is empty"),
            (zeros, "it is damaged"),
            (random, "it is not text"),
            (changed, "it is damaged"),
            (newer, "it is of version 2"),
            (b"{}".to_vec(), "it is damaged"),
            ("[".repeat(100_000).into_bytes(), "it is damaged"),
        ] {
            let (_folder, slot) = saved_twice();
            fs::write(slot.path("state"), &bytes).expect("it can be written");
            let (text, said) = opened(&slot);
            let said = said.expect("it is said");
            assert!(said.contains(reason) && said.ends_with("The copy before it is taken."), "{said}");
            assert_eq!(text.as_deref(), Some("old"));
            assert_eq!(fs::read(slot.path("state-damaged")).expect("it is kept"), bytes);
            // The next save replaces neither the copy nor what is kept.
            let (mut file, _) = StateFile::open(&slot);
            file.set_string("a", "next".to_owned());
            file.write().expect("it can be written");
            assert_eq!(opened(&slot), (Some("next".to_owned()), None));
            assert_eq!(fs::read(slot.path("state-damaged")).expect("it is kept"), bytes);
            assert!(read(&slot.path("state-before")).is_ok_and(|copy| copy.is_some()));
        }
    }

    #[test]
    fn a_save_that_has_not_ended_leaves_the_copy() {
        let (_folder, slot) = saved_twice();
        fs::rename(slot.path("state"), slot.path("state-before")).expect("it can be renamed");
        let (text, said) = opened(&slot);
        assert_eq!(text.as_deref(), Some("new"));
        assert!(said.is_some_and(|said| said.contains("was being saved when it ended")));
    }

    #[test]
    fn a_torn_state_without_a_copy_is_said_too() {
        let (_folder, slot) = saved_twice();
        fs::write(slot.path("state"), "").expect("it can be written");
        fs::write(slot.path("state-before"), "x").expect("it can be written");
        let (text, said) = opened(&slot);
        assert_eq!(text, None);
        assert!(said.is_some_and(|said| said.contains("it is empty") && said.contains("no good copy")));
    }

    #[test]
    fn two_instances_do_not_overwrite_each_other() {
        let (folder, first) = saved_twice();
        let second = Slot::take(folder.path()).expect("there is a place");
        let (mut file, said) = StateFile::open(&second);
        assert_eq!(
            (file.get_string("a").as_deref(), said),
            (Some("new"), None),
            "it begins with the state of the first"
        );
        file.set_string("a", "of the second".to_owned());
        file.write().expect("it can be written");
        assert_eq!(opened(&first).0.as_deref(), Some("new"));
        drop(second);
        let again = Slot::take(folder.path()).expect("there is a place");
        assert_eq!(opened(&again).0.as_deref(), Some("of the second"));
    }

    #[test]
    fn a_state_that_cannot_be_written_is_said_and_the_old_one_stays() {
        let (_folder, slot) = saved_twice();
        let (mut file, _) = StateFile::open(&slot);
        fs::remove_file(slot.path("state-before")).expect("it can be removed");
        fs::create_dir(slot.path("state-before")).expect("a folder can be made");
        fs::write(slot.path("state-before").join("x"), "").expect("it can be written");
        file.set_string("a", "next".to_owned());
        assert!(file.write().expect_err("there is a folder").contains("state.json"));
        assert_eq!(opened(&slot).0.as_deref(), Some("new"));
    }
}
