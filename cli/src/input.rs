//! Reading input, and the reasons why it cannot be used.

use std::fs::File;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

use kalmanscope_core::import::ImportError;
use kalmanscope_core::{RunError, ScenarioError};
use kalmanscope_lessons::LessonError;
use thiserror::Error;

/// Limits the size of a record's file \[bytes\].
pub(crate) const LARGEST: u64 = 1_000_000_000;

/// Errors of the input.
#[derive(Debug, Error)]
pub(crate) enum InputError {
    #[error("{}: {error}", shown(.file))]
    Read { file: PathBuf, error: io::Error },
    #[error("{}: {error}", shown(.file))]
    Scenario { file: PathBuf, error: ScenarioError },
    #[error("{}: {error}", shown(.file))]
    Lesson { file: PathBuf, error: LessonError },
    #[error("{}: {error}", shown(.file))]
    Import { file: PathBuf, error: ImportError },
    #[error("{}: {reason}", shown(.file))]
    Laboratory { file: PathBuf, reason: String },
    #[error("{}: it has {megabytes} MB, but at most {} MB are read; cut it before", shown(.file), LARGEST / 1_000_000)]
    TooLarge { file: PathBuf, megabytes: u64 },
    #[error("{}: {error}", shown(.file))]
    Run { file: PathBuf, error: RunError },
    #[error("{}: `duration` is {most} times dt or more, but every sample is kept here", shown(.file))]
    TooLong { file: PathBuf, most: usize },
}

/// The text of a file, or of standard input where the file is `-`.
pub(crate) fn read_text(file: &Path) -> Result<String, InputError> {
    let mut text = String::new();
    let read = if is_standard_input(file) {
        io::stdin().read_to_string(&mut text)
    } else {
        File::open(file).and_then(|mut file| file.read_to_string(&mut text))
    };
    read.map_err(|error| InputError::Read { file: file.to_owned(), error })?;
    Ok(text)
}

fn is_standard_input(file: &Path) -> bool {
    file.as_os_str() == "-"
}

fn shown(file: &Path) -> String {
    if is_standard_input(file) { "standard input".to_owned() } else { file.display().to_string() }
}
