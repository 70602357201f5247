//! The files that a command reads and writes, and the reasons why it cannot: none is both.

use std::fs::{self, File};
use std::io::{self, BufWriter, Read as _, StdoutLock, Write};
use std::path::{Path, PathBuf};
use std::string::FromUtf8Error;

use kalmanscope_cli::output;
use kalmanscope_core::import::ImportError;
use kalmanscope_core::{RunError, ScenarioError, scenario};
use thiserror::Error;

/// Limits the size of a record's file \[bytes\].
pub(crate) const LARGEST: u64 = 1_000_000_000;

/// Limits the size of a scenario or a map \[bytes\].
const LARGEST_TEXT: u64 = 1_000_000;

#[derive(Debug, Error)]
pub(crate) enum InputError {
    #[error("{}: {error}", shown(.file))]
    Read { file: PathBuf, error: io::Error },
    #[error("{}: {error}", shown(.file))]
    Scenario { file: PathBuf, error: ScenarioError },
    #[error("{}: no start values could be found: {error}", shown(.file))]
    StartValues { file: PathBuf, error: ScenarioError },
    #[error("{}: {error}", shown(.file))]
    Import { file: PathBuf, error: ImportError },
    #[error("{}: {reason}", shown(.file))]
    Laboratory { file: PathBuf, reason: String },
    #[error("{}: it has {megabytes} MB, more than the {} MB that are read; cut it first", shown(.file), LARGEST / 1_000_000)]
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
    #[error("{}: the simulation has more than {most} samples; shorten `duration` or enlarge `dt`", shown(.file))]
    TooLong { file: PathBuf, most: usize },
}

impl InputError {
    pub(crate) fn bad(file: &Path, reason: &dyn ToString) -> Self {
        Self::Laboratory { file: file.to_owned(), reason: reason.to_string() }
    }

    pub(crate) fn unwritten(file: &Path, reason: &dyn ToString) -> Self {
        Self::Output { file: file.to_owned(), reason: reason.to_string() }
    }

    /// The exit code: 1 for a result that could not be written, 2 for the rest.
    pub(crate) fn code(&self) -> u8 {
        if matches!(self, Self::Output { .. }) { 1 } else { 2 }
    }
}

pub(crate) fn read_text(file: &Path) -> Result<String, InputError> {
    to_text(file, read_short(file)?)
}

pub(crate) fn to_text(file: &Path, bytes: Vec<u8>) -> Result<String, InputError> {
    let bad = |error: FromUtf8Error| io::Error::new(io::ErrorKind::InvalidData, error.utf8_error());
    String::from_utf8(bytes).map_err(|error| InputError::Read { file: file.to_owned(), error: bad(error) })
}

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

pub(crate) fn is_standard_input(file: &Path) -> bool {
    ["-", "/dev/stdin"].iter().any(|name| file.as_os_str() == *name)
}

fn written(file: &Path) -> String {
    if file.as_os_str() == "-" { "standard output".to_owned() } else { file.display().to_string() }
}

fn shown(file: &Path) -> String {
    if is_standard_input(file) { "standard input".to_owned() } else { file.display().to_string() }
}

/// Files by the words of the arguments that name them.
pub(crate) type Places<'a> = Vec<(&'static str, &'a Path)>;

/// The files of an argument that may be left out.
pub(crate) fn places<'a>(word: &'static str, files: impl IntoIterator<Item = &'a PathBuf>) -> Places<'a> {
    files.into_iter().map(|file| (word, file.as_path())).collect()
}

pub(crate) fn check(inputs: &Places<'_>, outputs: &Places<'_>) -> Result<(), InputError> {
    let mut standard = inputs.iter().filter(|(_, file)| is_standard_input(file));
    if let (Some((first, _)), Some((second, _))) = (standard.next(), standard.next()) {
        return Err(InputError::Twice { first: (*first).to_owned(), second: (*second).to_owned() });
    }
    for (place, (word, file)) in outputs.iter().enumerate() {
        let is_same = |other: &Path| match (is_standard_output(file), is_standard_output(other)) {
            (false, false) => output::is_same(file, other),
            (one, both) => one && both,
        };
        let input = |other: &Path| {
            let other = if is_standard_input(other) { Path::new("/dev/stdin") } else { other };
            !is_standard_output(file) && output::is_same(file, other)
        };
        let read = inputs.iter().find(|(_, other)| input(other)).map(|(other, _)| format!("{other}, which is read"));
        let written = outputs[..place].iter().find(|(_, other)| is_same(other));
        let written = written.map(|(other, _)| format!("what {other} writes"));
        if let Some(other) = read.or(written) {
            return Err(InputError::Overwrites { file: (*file).to_owned(), output: (*word).to_owned(), other });
        }
    }
    Ok(())
}

pub(crate) fn is_standard_output(file: &Path) -> bool {
    ["-", "/dev/stdout"].iter().any(|name| file.as_os_str() == *name)
}

/// Writes a file whole or not at all, or to standard output where its name is `-`.
pub(crate) fn write<E: From<io::Error>>(
    file: &Path,
    fill: impl FnOnce(&mut dyn Write) -> Result<(), E>,
) -> Result<(), E> {
    if !is_standard_output(file) {
        return output::write(file, |file| fill(file));
    }
    let mut output = BufWriter::new(Open(io::stdout().lock()));
    fill(&mut output)?;
    Ok(output.flush()?)
}

pub(crate) fn write_text(file: &Path, text: &str) -> Result<(), InputError> {
    write_bytes(file, text.as_bytes())
}

pub(crate) fn write_bytes(file: &Path, bytes: &[u8]) -> Result<(), InputError> {
    let written: io::Result<()> = write(file, |output| output.write_all(bytes));
    written.map_err(|error| InputError::unwritten(file, &error))
}

/// Prints on standard output, without characters that steer a terminal.
pub(crate) fn print(text: &str) -> Result<(), InputError> {
    write_text(Path::new("-"), &scenario::shown(text))
}

pub(crate) fn print_beside(outputs: &Places<'_>, text: &str) -> Result<(), InputError> {
    if outputs.iter().any(|(_, file)| is_standard_output(file)) {
        say(&text.trim_end());
        return Ok(());
    }
    print(text)
}

pub(crate) fn report_error(error: &dyn std::fmt::Display) {
    say(&format_args!("error: {error}"));
}

/// Prints a line on standard error, without characters that steer a terminal, and ignores that this can fail.
pub(crate) fn say(line: &dyn std::fmt::Display) {
    let _ = writeln!(io::stderr(), "{}", scenario::shown(&line.to_string()));
}

/// Standard output. Output to a closed pipe is dropped without a message.
struct Open<'a>(StdoutLock<'a>);

impl Write for Open<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let Self(output) = self;
        unless_closed(output.write(bytes), bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        let Self(output) = self;
        unless_closed(output.flush(), ())
    }
}

fn unless_closed<T>(done: io::Result<T>, otherwise: T) -> io::Result<T> {
    match done {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(otherwise),
        done => done,
    }
}
