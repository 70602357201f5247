//! The record's file in the folder of the saved state.

use std::fs;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use egui::Context;
use kalmanscope::drop::{file_name, read_path};
use kalmanscope::inbox::{Arrival, Inbox};
use kalmanscope::shelf::Shelf;

use super::slot::Slot;

/// A folder with at most one file.
pub(super) struct Folder(PathBuf);

impl Folder {
    /// The folder of an instance, beside its saved state.
    pub(super) fn of(slot: &Slot) -> Self {
        Self(slot.path("record").with_extension(""))
    }

    fn files(&self) -> impl Iterator<Item = PathBuf> {
        let entries = fs::read_dir(&self.0).into_iter().flatten().flatten();
        entries.map(|entry| entry.path()).filter(|path| path.is_file())
    }
}

impl Shelf for Folder {
    fn keep(&self, name: &str, bytes: Rc<[u8]>) {
        // The name alone: a path in it leads nowhere else.
        let path = self.0.join(file_name(Path::new(name)));
        let kept = fs::create_dir_all(&self.0).and_then(|()| {
            self.files().filter(|other| *other != path).try_for_each(fs::remove_file)?;
            fs::write(&path, &bytes)
        });
        if let Err(error) = kept {
            log::warn!("{}: {error}", path.display());
        }
    }

    fn fetch(&self, ctx: &Context, inbox: &Inbox) {
        let Some(path) = self.files().next() else { return };
        match read_path(&path) {
            Ok(bytes) => inbox.put(Arrival::Kept(file_name(&path), bytes), ctx),
            Err(error) => log::warn!("{}: {error}", path.display()),
        }
    }

    fn forget(&self) {
        for path in self.files() {
            if let Err(error) = fs::remove_file(&path) {
                log::warn!("{}: {error}", path.display());
            }
        }
    }

    fn place(&self) -> &'static str {
        "the folder of the saved state"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_file_is_kept_and_comes_back() {
        let folder = std::env::temp_dir().join(format!("kalmanscope-shelf-{}", std::process::id()));
        let shelf = Folder(folder.join("record"));
        shelf.keep("../../a.csv", (*b"1,2").into());
        shelf.keep("b.csv", (*b"3,4").into());
        assert_eq!(shelf.files().map(|path| file_name(&path)).collect::<Vec<_>>(), ["b.csv"]);
        assert!(!folder.join("a.csv").exists() && !folder.parent().is_some_and(|above| above.join("a.csv").exists()));
        let (ctx, inbox) = (Context::default(), Inbox::default());
        shelf.fetch(&ctx, &inbox);
        shelf.forget();
        assert_eq!(shelf.files().count(), 0);
        fs::remove_dir_all(&folder).ok();
    }
}
