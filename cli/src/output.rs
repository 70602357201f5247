//! Files that are written whole or not at all.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Writes a file: first into a temporary one beside it, which then takes its name, so that an old file stays whole
/// until the new one is. The new one has the permissions of the old one. If the name is a symbolic link, the file that
/// it points to is replaced, not the link. Devices and pipes are written directly.
///
/// # Errors
/// Those of `fill`, and [`io::Error`] where a file cannot be made or written. The old file is then as it was.
pub fn write<E: From<io::Error>>(path: &Path, fill: impl FnOnce(&mut dyn Write) -> Result<(), E>) -> Result<(), E> {
    let old = match fs::metadata(path) {
        Ok(old) => Some(old),
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        Err(error) => return Err(error.into()),
    };
    match &old {
        Some(old) if old.is_dir() => return Err(io::Error::from(ErrorKind::IsADirectory).into()),
        // Standard output may be a file, which must keep what stands in it already.
        Some(old) if !old.is_file() || is_stream(path) => {
            return filled(&OpenOptions::new().append(true).open(path)?, fill);
        }
        // A rename asks the folder for permission only, and would replace a file that is protected.
        Some(old) if old.permissions().readonly() => {
            return Err(io::Error::from(ErrorKind::PermissionDenied).into());
        }
        _ => {}
    }
    let target = resolved(path)?;
    let mut beside = tempfile::Builder::new();
    beside.prefix(".").suffix(".tmp");
    // The default keeps a temporary file from other users, but this one becomes an ordinary one.
    #[cfg(unix)]
    beside.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    // In the same folder, since a rename works within one file system only.
    let temporary = beside.tempfile_in(folder(&target))?;
    filled(temporary.as_file(), fill)?;
    if let Some(old) = old {
        temporary.as_file().set_permissions(old.permissions())?;
        // The old file must not go before the new one is on the disk.
        temporary.as_file().sync_all()?;
    }
    temporary.persist(target).map_err(|error| error.error)?;
    Ok(())
}

fn filled<E: From<io::Error>>(file: &File, fill: impl FnOnce(&mut dyn Write) -> Result<(), E>) -> Result<(), E> {
    let mut output = BufWriter::new(file);
    fill(&mut output)?;
    Ok(output.flush()?)
}

fn is_stream(path: &Path) -> bool {
    ["/dev/stdout", "/dev/stderr", "/dev/fd", "/proc"].iter().any(|own| path.starts_with(own))
}

fn folder(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The file that a name leads to, through symbolic links, whether it exists or not.
fn resolved(path: &Path) -> io::Result<PathBuf> {
    match fs::canonicalize(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => {
            // Links in a circle are another error: this ends.
            let mut path = path.to_owned();
            while let Ok(to) = fs::read_link(&path) {
                path = folder(&path).join(to);
            }
            Ok(path)
        }
        found => found,
    }
}

/// Whether two names lead to the same file: an ordinary one that exists, or one that would be made. Devices and pipes are never
/// the same.
pub fn is_same(a: &Path, b: &Path) -> bool {
    matches!((identity(a), identity(b)), (Some(a), Some(b)) if a == b)
}

#[derive(PartialEq, Eq)]
enum Identity {
    /// The device and the number of a file on it.
    #[cfg(unix)]
    Node(u64, u64),
    /// The path of a file, without links.
    Path(PathBuf),
}

fn identity(path: &Path) -> Option<Identity> {
    if let Ok(found) = fs::metadata(path) {
        #[cfg(unix)]
        return found.is_file().then(|| {
            use std::os::unix::fs::MetadataExt as _;
            Identity::Node(found.dev(), found.ino())
        });
        #[cfg(not(unix))]
        return found.is_file().then(|| fs::canonicalize(path).ok().map(Identity::Path)).flatten();
    }
    let path = resolved(path).ok()?;
    Some(Identity::Path(fs::canonicalize(folder(&path)).ok()?.join(path.file_name()?)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(path: &Path, text: &str) -> io::Result<()> {
        write(path, |file| file.write_all(text.as_bytes()))
    }

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn an_old_file_stays_whole_until_the_new_one_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.csv");
        text(&path, "old").unwrap();
        let failed: io::Result<()> = write(&path, |file| {
            file.write_all(&[b'x'; 100_000])?;
            assert_eq!(fs::read_to_string(&path)?, "old");
            Err(io::Error::other("the disk is full"))
        });
        assert_eq!(failed.unwrap_err().to_string(), "the disk is full");
        assert_eq!(
            (fs::read_to_string(&path).unwrap().as_str(), names(folder.path())),
            ("old", vec!["a.csv".to_owned()])
        );
        text(&path, "new").unwrap();
        assert_eq!((fs::read_to_string(&path).unwrap().as_str(), names(folder.path()).len()), ("new", 1));
        assert_eq!(text(folder.path(), "").unwrap_err().kind(), ErrorKind::IsADirectory);
    }

    #[cfg(unix)]
    #[test]
    fn permissions_and_links_stay() {
        use std::os::unix::fs::{PermissionsExt as _, symlink};
        let folder = tempfile::tempdir().unwrap();
        let [path, link, dangling, far] = ["a", "link", "dangling", "far"].map(|name| folder.path().join(name));
        text(&path, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        symlink("a", &link).unwrap();
        symlink("b", &dangling).unwrap();
        symlink("dangling", &far).unwrap();
        text(&link, "new").unwrap();
        text(&far, "made").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().file_type().is_symlink());
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
        let mode = |name: &str| fs::metadata(folder.path().join(name)).unwrap().permissions().mode() & 0o777;
        fs::write(folder.path().join("plain"), "").unwrap();
        assert_eq!(mode("b"), mode("plain"), "a new file has the permissions of any new file");
        fs::remove_file(folder.path().join("plain")).unwrap();
        assert_eq!(names(folder.path()), ["a", "b", "dangling", "far", "link"]);
        fs::set_permissions(&path, fs::Permissions::from_mode(0o440)).unwrap();
        assert_eq!(text(&path, "x").unwrap_err().kind(), ErrorKind::PermissionDenied);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn devices_are_written_directly() {
        text(Path::new("/dev/null"), "x").unwrap();
        assert_eq!(text(Path::new("/dev/full"), "x").unwrap_err().kind(), ErrorKind::StorageFull);
    }

    #[cfg(unix)]
    #[test]
    fn the_same_file_is_known_by_any_name() {
        let folder = tempfile::tempdir().unwrap();
        let [a, b, hard, link] = ["a", "b", "hard", "link"].map(|name| folder.path().join(name));
        text(&a, "x").unwrap();
        fs::hard_link(&a, &hard).unwrap();
        std::os::unix::fs::symlink("b", &link).unwrap();
        assert!(is_same(&a, &hard) && is_same(&a, &folder.path().join("./a")) && is_same(&link, &b));
        assert!(!is_same(&a, &b) && !is_same(Path::new("/dev/null"), Path::new("/dev/null")));
    }
}
