//! Files that are written whole or not at all.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write as _};
use std::path::{Path, PathBuf};

/// Limits the symbolic links that are followed from a file's name to the file.
const MOST_LINKS: usize = 40;
/// Limits the names that are tried for a temporary file.
const MOST_NAMES: u32 = 100;

/// Writes a file: first into a temporary one beside it, which then takes its name, so that an old file stays whole
/// until the new one is. The new one has the permissions of the old one. If the name is a symbolic link, the file that
/// it points to is replaced, not the link. Devices and pipes are written directly.
///
/// # Errors
/// Those of `fill`, and [`io::Error`] where a file cannot be made or written. The old file is then as it was.
pub fn write<E: From<io::Error>>(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<File>) -> Result<(), E>,
) -> Result<(), E> {
    if is_stream(path) {
        let mut output = BufWriter::new(OpenOptions::new().append(true).open(path)?);
        fill(&mut output)?;
        return Ok(output.flush()?);
    }
    let target = resolved(path)?;
    let old = match fs::metadata(&target) {
        Ok(old) => Some(old),
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        Err(error) => return Err(error.into()),
    };
    match old {
        Some(old) if old.is_dir() => Err(io::Error::from(ErrorKind::IsADirectory).into()),
        Some(old) if !old.is_file() => {
            let mut output = BufWriter::new(OpenOptions::new().write(true).open(&target)?);
            fill(&mut output)?;
            Ok(output.flush()?)
        }
        Some(old) if old.permissions().readonly() => Err(io::Error::from(ErrorKind::PermissionDenied).into()),
        old => {
            let (file, temporary) = beside(&target)?;
            let written = fill_and_rename(file, &temporary, &target, old.as_ref(), fill);
            if written.is_err() {
                // The error of the writing is the one to report.
                let _ = fs::remove_file(&temporary);
            }
            written
        }
    }
}

fn fill_and_rename<E: From<io::Error>>(
    file: File,
    temporary: &Path,
    target: &Path,
    old: Option<&fs::Metadata>,
    fill: impl FnOnce(&mut BufWriter<File>) -> Result<(), E>,
) -> Result<(), E> {
    if let Some(old) = old {
        file.set_permissions(old.permissions())?;
    }
    let mut output = BufWriter::new(file);
    fill(&mut output)?;
    let file = output.into_inner().map_err(io::IntoInnerError::into_error)?;
    if old.is_some() {
        // The old file must not go before the new one is on the disk.
        file.sync_all()?;
    }
    drop(file);
    Ok(fs::rename(temporary, target)?)
}

/// A new file in the folder of another one, and its name.
fn beside(target: &Path) -> io::Result<(File, PathBuf)> {
    let name = target.file_name().ok_or(ErrorKind::InvalidInput)?;
    let mut last = io::Error::from(ErrorKind::AlreadyExists);
    for number in 0..MOST_NAMES {
        let mut own = std::ffi::OsString::from(".");
        own.push(name);
        own.push(format!(".{}-{number}.tmp", std::process::id()));
        let path = target.with_file_name(own);
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(file) => return Ok((file, path)),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => last = error,
            Err(error) => return Err(error),
        }
    }
    Err(last)
}

/// Whether a name is one of the system for an open file.
fn is_stream(path: &Path) -> bool {
    ["/dev/stdout", "/dev/stderr", "/dev/fd", "/proc"].iter().any(|own| path.starts_with(own))
}

/// The file that a name leads to, through symbolic links, whether it exists or not.
fn resolved(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    for _ in 0..MOST_LINKS {
        match fs::symlink_metadata(&path) {
            Ok(found) if found.file_type().is_symlink() => {
                // A link of the system, such as that of standard output, may point to something without a path.
                let to = fs::read_link(&path)?;
                let to = path.parent().unwrap_or(Path::new("")).join(to);
                if fs::symlink_metadata(&to).is_err() && fs::metadata(&path).is_ok() {
                    return Ok(path);
                }
                path = to;
            }
            Ok(_) => return Ok(path),
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(path),
            Err(error) => return Err(error),
        }
    }
    Err(io::Error::other("too many symbolic links"))
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
    let path = resolved(path).ok()?;
    if let Ok(found) = fs::metadata(&path) {
        #[cfg(unix)]
        return found.is_file().then(|| {
            use std::os::unix::fs::MetadataExt as _;
            Identity::Node(found.dev(), found.ino())
        });
        #[cfg(not(unix))]
        return found.is_file().then(|| fs::canonicalize(&path).ok().map(Identity::Path)).flatten();
    }
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    Some(Identity::Path(fs::canonicalize(folder).ok()?.join(path.file_name()?)))
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
        let [path, link, dangling] = ["a", "link", "dangling"].map(|name| folder.path().join(name));
        text(&path, "old").unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o640)).unwrap();
        symlink("a", &link).unwrap();
        symlink("b", &dangling).unwrap();
        text(&link, "new").unwrap();
        text(&dangling, "made").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().file_type().is_symlink());
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o640);
        assert_eq!(names(folder.path()), ["a", "b", "dangling", "link"]);
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
