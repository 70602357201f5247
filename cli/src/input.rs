//! Reading input, and the reasons why it cannot be used.

use std::fs::{self, File};
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};
use std::string::FromUtf8Error;

use kalmanscope_core::import::ImportError;
use kalmanscope_core::{RunError, ScenarioError};
use thiserror::Error;

/// Limits the size of a record's file \[bytes\].
pub(crate) const LARGEST: u64 = 1_000_000_000;

/// Limits the size of a scenario or a map \[bytes\].
const LARGEST_TEXT: u64 = 1_000_000;

/// Errors of the input.
#[derive(Debug, Error)]
pub(crate) enum InputError {
    #[error("{}: {error}", shown(.file))]
    Read { file: PathBuf, error: io::Error },
    #[error("{}: {error}", shown(.file))]
    Scenario { file: PathBuf, error: ScenarioError },
    #[error("{}: no start values can be made of it: {error}", shown(.file))]
    StartValues { file: PathBuf, error: ScenarioError },
    #[error("{}: {error}", shown(.file))]
    Import { file: PathBuf, error: ImportError },
    #[error("{}: {reason}", shown(.file))]
    Laboratory { file: PathBuf, reason: String },
    #[error("{}: it has {megabytes} MB, but at most {} MB are read; cut it before", shown(.file), LARGEST / 1_000_000)]
    TooLarge { file: PathBuf, megabytes: u64 },
    #[error("{}: it has more than 1 MB, too much for a scenario or a map; `import` reads records", shown(.file))]
    LongText { file: PathBuf },
    #[error("{}: it is neither a file nor a pipe", shown(.file))]
    NoFile { file: PathBuf },
    #[error("standard input is named twice, as {first} and as {second}, but can be read once")]
    Twice { first: String, second: String },
    #[error("{}: {output} would overwrite {other}; nothing was done", .file.display())]
    Overwrites { file: PathBuf, output: String, other: String },
    #[error("{}: {reason}", written(.file))]
    Output { file: PathBuf, reason: String },
    #[error("{}: {error}", shown(.file))]
    Run { file: PathBuf, error: RunError },
    #[error("{}: `duration` is {most} times dt or more, but every sample is kept here", shown(.file))]
    TooLong { file: PathBuf, most: usize },
}

impl InputError {
    /// The exit code: 1 for a result that could not be written, 2 for the rest.
    pub(crate) fn code(&self) -> u8 {
        if matches!(self, Self::Output { .. }) { 1 } else { 2 }
    }
}

/// The text of a scenario or a map: a file, or standard input where the file is `-`.
pub(crate) fn read_text(file: &Path) -> Result<String, InputError> {
    to_text(file, read_short(file)?)
}

/// The bytes of a file as text.
pub(crate) fn to_text(file: &Path, bytes: Vec<u8>) -> Result<String, InputError> {
    let bad = |error: FromUtf8Error| io::Error::new(io::ErrorKind::InvalidData, error.utf8_error());
    String::from_utf8(bytes).map_err(|error| InputError::Read { file: file.to_owned(), error: bad(error) })
}

/// The bytes of [`read_text`].
pub(crate) fn read_short(file: &Path) -> Result<Vec<u8>, InputError> {
    read_limited(file, LARGEST_TEXT)?.map_err(|_| InputError::LongText { file: file.to_owned() })
}

/// The bytes of a record: a file, a pipe, or standard input where the file is `-`. Each is read once.
pub(crate) fn read_record(file: &Path) -> Result<Vec<u8>, InputError> {
    let too_large = |size| InputError::TooLarge { file: file.to_owned(), megabytes: size / 1_000_000 };
    read_limited(file, LARGEST)?.map_err(too_large)
}

/// The bytes of a file, or else its size if it has more than `most`; `most` + 1 if the file does not report its size.
fn read_limited(file: &Path, most: u64) -> Result<Result<Vec<u8>, u64>, InputError> {
    let unread = |error| InputError::Read { file: file.to_owned(), error };
    let mut bytes = Vec::new();
    if is_standard_input(file) {
        io::stdin().take(most + 1).read_to_end(&mut bytes).map_err(unread)?;
    } else {
        let kind = fs::metadata(file).map_err(unread)?;
        if kind.is_file() && kind.len() > most {
            return Ok(Err(kind.len()));
        }
        if !kind.is_file() && !is_pipe(&kind) {
            return Err(InputError::NoFile { file: file.to_owned() });
        }
        File::open(file).and_then(|file| file.take(most + 1).read_to_end(&mut bytes)).map_err(unread)?;
    }
    Ok(if bytes.len() as u64 > most { Err(bytes.len() as u64) } else { Ok(bytes) })
}

#[cfg(unix)]
fn is_pipe(kind: &fs::Metadata) -> bool {
    std::os::unix::fs::FileTypeExt::is_fifo(&kind.file_type())
}

#[cfg(not(unix))]
fn is_pipe(_: &fs::Metadata) -> bool {
    false
}

/// Whether a file's name stands for standard input.
pub(crate) fn is_standard_input(file: &Path) -> bool {
    ["-", "/dev/stdin"].iter().any(|name| file.as_os_str() == *name)
}

/// The name of an output in a message.
fn written(file: &Path) -> String {
    if file.as_os_str() == "-" { "standard output".to_owned() } else { file.display().to_string() }
}

/// The name of an input in a message.
fn shown(file: &Path) -> String {
    if is_standard_input(file) { "standard input".to_owned() } else { file.display().to_string() }
}
