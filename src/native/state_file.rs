//! The picture of the last use, as a file in the program's folder.
//!
//! The toolkit's own storage keeps the place of the window only: it writes its file in place, so that a crash tears it, and
//! begins with an empty one where it cannot be read.

use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use kalmanscope::app::state::LastPicture;
use kalmanscope::share::SavedPicture;
use kalmanscope_cli::output;

pub(super) const NAME: &str = "state.json";

/// The name of the file from its opening to the first save: a start that ends before may have failed because of it.
const OPENED: &str = "state-opened.json";

#[derive(Debug)]
pub(super) struct StateFile {
    pub(super) folder: PathBuf,
    text: String,
    trouble: Option<String>,
}

impl StateFile {
    /// Renames a file that cannot be read, or that has ended a start before its save. Fails where none can be kept.
    pub(super) fn open(folder: &Path) -> Result<(Self, LastPicture), String> {
        fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
        let [path, opened] = [NAME, OPENED].map(|name| folder.join(name));
        let is_lost = !path.exists() && opened.exists();
        let (path, last) = if is_lost {
            (opened, Err("the program has stopped soon after it was opened".to_owned()))
        } else {
            let last = read(&path);
            if matches!(last, Ok(Some(_))) {
                fs::rename(&path, opened).map_err(|error| format!("{}: {error}", path.display()))?;
            }
            (path, last)
        };
        let last = match last {
            Ok(picture) => Ok(picture),
            Err(reason) => {
                let place = set_aside(&path).map_err(|error| format!("{}: {reason}, and {error}", path.display()))?;
                Err(format!("The last session cannot be opened: {reason}. It is kept as {}.", place.display()))
            }
        };
        Ok((Self { folder: folder.to_owned(), text: String::new(), trouble: None }, last))
    }

    /// Writes another picture beside the file, then replaces that. Returns why it fails, but not twice the same reason.
    pub(super) fn save(&mut self, picture: &SavedPicture) -> Option<String> {
        let text = picture.lines().map_err(|error| error.to_string());
        let saved = text.and_then(|text| {
            if text != self.text {
                let path = self.folder.join(NAME);
                let written = output::write(&path, |file| file.write_all(text.as_bytes()));
                // The error names a file beside it, which is another one each time.
                written.map_err(|error| format!("{}: {}", path.display(), error.kind()))?;
                self.text = text;
            }
            Ok(())
        });
        let before = std::mem::replace(&mut self.trouble, saved.err());
        self.trouble.clone().filter(|_| self.trouble != before)
    }
}

fn read(path: &Path) -> Result<Option<SavedPicture>, String> {
    match fs::read_to_string(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        text => text
            .map_err(|error| error.to_string())
            .and_then(|text| SavedPicture::of_text(&text).map(Some).map_err(|error| error.to_string())),
    }
}

fn set_aside(path: &Path) -> std::io::Result<PathBuf> {
    let mut places = (1_u32..).map(|number| path.with_file_name(format!("state-kept-{number}.json")));
    let place = places.find(|place| !place.exists()).ok_or(ErrorKind::AlreadyExists)?;
    fs::rename(path, &place).map(|()| place)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(speed: f64) -> SavedPicture {
        SavedPicture { speed, ..SavedPicture::default() }
    }

    #[test]
    fn the_last_picture_comes_back_and_is_written_where_it_differs() {
        let folder = tempfile::tempdir().expect("a folder can be made");
        let inner = folder.path().join("not/yet");
        let (mut file, last) = StateFile::open(&inner).expect("there is a place");
        assert_eq!(last, Ok(None));
        for speed in [0.5, 2.0] {
            assert_eq!(file.save(&picture(speed)), None);
            assert_eq!(StateFile::open(&inner).expect("there is a place").1, Ok(Some(picture(speed))));
        }
        assert_eq!(file.save(&picture(2.0)), None);
        assert!(!inner.join(NAME).exists(), "the same picture is not written again");
    }

    #[test]
    fn a_session_with_which_a_start_has_ended_is_not_opened_again() {
        let folder = tempfile::tempdir().expect("a folder can be made");
        let open = || StateFile::open(folder.path()).expect("there is a place");
        assert_eq!(open().0.save(&picture(3.0)), None);
        assert_eq!(open().1, Ok(Some(picture(3.0))));
        let said = open().1.expect_err("nothing was saved since");
        assert!(said.contains("stopped soon after it was opened") && said.contains("state-kept-1.json"), "{said}");
        assert_eq!(open().1, Ok(None), "it is said once");
        let kept = fs::read_to_string(folder.path().join("state-kept-1.json")).expect("it is kept");
        assert!(kept.contains("\"speed\": 3.0"), "it can be dropped on the window");
    }

    #[test]
    fn a_file_that_cannot_be_read_is_said_and_kept() {
        let folder = tempfile::tempdir().expect("a folder can be made");
        let path = folder.path().join(NAME);
        for (place, (bytes, reason)) in
            [(vec![0xff; 20], "UTF-8"), ("[".repeat(100_000).into_bytes(), "recursion limit")].into_iter().enumerate()
        {
            fs::write(&path, &bytes).expect("it can be written");
            let (_, last) = StateFile::open(folder.path()).expect("there is a place");
            let said = last.expect_err(reason);
            assert!(said.contains(reason) && said.contains("It is kept as ") && !said.contains('\n'), "{said}");
            let kept = folder.path().join(format!("state-kept-{}.json", place + 1));
            assert_eq!(fs::read(kept).expect("it is kept"), bytes);
        }
    }

    #[test]
    fn a_save_that_fails_is_said_once_and_tried_again() {
        let folder = tempfile::tempdir().expect("a folder can be made");
        let inner = folder.path().join("gone");
        let (mut file, _) = StateFile::open(&inner).expect("there is a place");
        fs::remove_dir(&inner).expect("it can be removed");
        assert!(file.save(&picture(2.0)).is_some_and(|reason| reason.contains(NAME)));
        assert_eq!(file.save(&picture(2.0)), None);
        fs::create_dir(&inner).expect("it can be made");
        assert_eq!(file.save(&picture(2.0)), None);
        assert!(inner.join(NAME).exists());
    }
}
