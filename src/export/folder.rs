//! Files in the user's folder of downloads.

use std::env;
use std::fs::OpenOptions;
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};

use super::File;

/// Limits the files of one name.
const MOST: u32 = 10_000;

/// Writes a file into the folder of downloads, and returns its path. It does not replace a file of that name: the new
/// one gets a number.
///
/// # Errors
/// The reason why it cannot be written.
pub fn write(file: &File) -> Result<String, String> {
    write_into(&downloads(), file)
}

/// [`write()`] into another folder.
///
/// # Errors
/// The reason why it cannot be written.
pub fn write_into(folder: &Path, file: &File) -> Result<String, String> {
    for number in 1..=MOST {
        let path = folder.join(numbered(&file.name, number));
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(mut output) => {
                output.write_all(&file.contents).map_err(|error| format!("{}: {error}", path.display()))?;
                return Ok(path.display().to_string());
            }
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            Err(error) => return Err(format!("{}: {error}", path.display())),
        }
    }
    Err(format!("{}: there are {MOST} files of the name {}", folder.display(), file.name))
}

/// The name with a number before its ending, from the second file on.
fn numbered(name: &str, number: u32) -> String {
    match name.rsplit_once('.') {
        _ if number == 1 => name.to_owned(),
        Some((stem, end)) => format!("{stem}-{number}.{end}"),
        None => format!("{name}-{number}"),
    }
}

/// The folder of downloads if there is one, else the user's own, else the present one.
fn downloads() -> PathBuf {
    let home = ["HOME", "USERPROFILE"].iter().find_map(env::var_os).map(PathBuf::from);
    let Some(home) = home else { return PathBuf::from(".") };
    let named = env::var_os("XDG_DOWNLOAD_DIR").map(PathBuf::from).or_else(|| named_download(&home));
    let places = [named, Some(home.join("Downloads")), Some(home)];
    places.into_iter().flatten().find(|place| place.is_dir()).unwrap_or_else(|| PathBuf::from("."))
}

/// The folder that the desktop's configuration names; its name may be in another language.
fn named_download(home: &Path) -> Option<PathBuf> {
    let text = std::fs::read_to_string(home.join(".config/user-dirs.dirs")).ok()?;
    download_of(&text, home)
}

fn download_of(text: &str, home: &Path) -> Option<PathBuf> {
    let value = text.lines().find_map(|line| line.trim().strip_prefix("XDG_DOWNLOAD_DIR="))?.trim_matches('"');
    Some(value.strip_prefix("$HOME/").map_or_else(|| PathBuf::from(value), |inside| home.join(inside)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_desktop_names_the_folder() {
        let home = Path::new("/home/ada");
        let text = "# a comment\nXDG_DESKTOP_DIR=\"$HOME/Bureau\"\nXDG_DOWNLOAD_DIR=\"$HOME/Téléchargements\"\n";
        assert_eq!(download_of(text, home), Some(home.join("Téléchargements")));
        assert_eq!(download_of("XDG_DOWNLOAD_DIR=\"/data/new\"", home), Some(PathBuf::from("/data/new")));
        assert_eq!(download_of("XDG_MUSIC_DIR=\"$HOME/Music\"", home), None);
    }

    #[test]
    fn files_of_the_same_name_are_numbered() {
        assert_eq!([1, 2, 11].map(|n| numbered("a.b.csv", n)), ["a.b.csv", "a.b-2.csv", "a.b-11.csv"]);
        assert_eq!(numbered("name", 3), "name-3");
    }
}
