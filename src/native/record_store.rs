//! The record's file in the folder of the saved state.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use egui::Context;
use kalmanscope::inbox::{Arrival, Done, Inbox, file_name, read_path};
use kalmanscope::record_store::RecordStore;
use kalmanscope_cli::output;

pub(super) struct Folder(PathBuf);

impl Folder {
    pub(super) fn of(folder: &Path) -> Self {
        Self(folder.join("record"))
    }

    fn files(&self) -> impl Iterator<Item = PathBuf> {
        let entries = fs::read_dir(&self.0).into_iter().flatten().flatten();
        entries.map(|entry| entry.path()).filter(|path| path.is_file())
    }

    fn place(&self, end: io::Result<()>) -> Result<String, String> {
        let folder = self.0.display();
        end.map(|()| folder.to_string()).map_err(|error| format!("{folder}: {error}"))
    }
}

impl RecordStore for Folder {
    fn keep(&self, name: &str, bytes: Rc<[u8]>, done: Done) {
        // The name alone: a path in it leads nowhere else.
        let path = self.0.join(file_name(Path::new(name)));
        let kept = fs::create_dir_all(&self.0).and_then(|()| {
            // The new file comes before the others go: a full disk must not leave none.
            output::write(&path, |file| file.write_all(&bytes))?;
            self.files().filter(|other| *other != path).try_for_each(fs::remove_file)
        });
        done(self.place(kept));
    }

    fn fetch(&self, ctx: &Context, inbox: &Inbox) {
        let Some(path) = self.files().next() else { return };
        match read_path(&path) {
            Ok(bytes) => inbox.put(Arrival::Kept(file_name(&path), bytes), ctx),
            Err(error) => {
                let sentence = format!("The record that was kept cannot be read: {}: {error}.", path.display());
                inbox.put(Arrival::Failure(sentence), ctx);
            }
        }
    }

    fn forget(&self, done: Done) {
        done(self.place(self.files().try_for_each(fs::remove_file)));
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, Mutex};

    use super::*;

    type Ends = Arc<Mutex<Vec<Result<String, String>>>>;

    fn ends() -> (Done, Ends) {
        let ends = Ends::default();
        let all = Arc::clone(&ends);
        (Arc::new(move |end| all.lock().expect("nobody has it").push(end)), ends)
    }

    #[test]
    fn one_file_is_kept_and_comes_back() {
        let above = tempfile::tempdir().expect("a folder can be made");
        let folder = above.path().join("state");
        let store = Folder::of(&folder);
        let (done, ends) = ends();
        store.keep("../../a.csv", (*b"1,2").into(), Arc::clone(&done));
        store.keep("b.csv", (*b"3,4").into(), Arc::clone(&done));
        assert_eq!(store.files().map(|path| file_name(&path)).collect::<Vec<_>>(), ["b.csv"]);
        assert!(!folder.join("a.csv").exists() && !above.path().join("a.csv").exists());
        store.fetch(&Context::default(), &Inbox::default());
        store.forget(done);
        assert_eq!(store.files().count(), 0);
        let place = folder.join("record").display().to_string();
        assert_eq!(ends.lock().expect("nobody has it").as_slice(), vec![Ok(place); 3]);
    }

    #[test]
    fn a_file_that_cannot_be_kept_leaves_the_one_before_it_and_says_why() {
        let above = tempfile::tempdir().expect("a folder can be made");
        let store = Folder::of(above.path());
        let (done, ends) = ends();
        store.keep("a.csv", (*b"1,2").into(), Arc::clone(&done));
        fs::create_dir(above.path().join("record/b.csv")).expect("a folder can be made");
        store.keep("b.csv", (*b"3,4").into(), done);
        assert_eq!(store.files().map(|path| file_name(&path)).collect::<Vec<_>>(), ["a.csv"]);
        let ends = ends.lock().expect("nobody has it");
        assert!(matches!(&ends[..], [Ok(_), Err(reason)] if reason.contains("record: ")), "{ends:?}");
    }
}
