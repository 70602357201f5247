//! The files that a command reads and writes, and the reasons why it cannot: none is both.

use std::fs::{self, File};
use std::io::{self, BufWriter, Read as _, StdoutLock, Write};
use std::path::{Path, PathBuf};

use kalmanscope_cli::output;
use kalmanscope_core::scenario;
use thiserror::Error;

/// Limits the size of a record's file \[bytes\].
pub(crate) const LARGEST: u64 = 1_000_000_000;

/// Limits the size of a scenario \[bytes\].
const LARGEST_TEXT: u64 = 1_000_000;

pub(crate) const NO_FILE: &str = "it is neither a file nor a pipe";

/// The reason why a command ends: an input that cannot be used, or an output that cannot be written.
#[derive(Debug, Error)]
#[error("{sentence}")]
pub(crate) struct InputError {
    sentence: String,
    is_of_output: bool,
}

impl InputError {
    pub(crate) fn bad(file: &Path, reason: &dyn ToString) -> Self {
        let name = if is_standard_input(file) { "standard input".into() } else { file.to_string_lossy() };
        Self { sentence: format!("{name}: {}", reason.to_string()), is_of_output: false }
    }

    pub(crate) fn unwritten(file: &Path, reason: &dyn ToString) -> Self {
        let name = if file.as_os_str() == "-" { "standard output".into() } else { file.to_string_lossy() };
        Self { sentence: format!("{name}: {}", reason.to_string()), is_of_output: true }
    }

    /// The exit code: 1 for a result that could not be written, 2 for the rest.
    pub(crate) fn code(&self) -> u8 {
        if self.is_of_output { 1 } else { 2 }
    }
}

pub(crate) fn to_text(file: &Path, bytes: Vec<u8>) -> Result<String, InputError> {
    String::from_utf8(bytes).map_err(|error| InputError::bad(file, &error.utf8_error()))
}

pub(crate) fn read_short(file: &Path) -> Result<Vec<u8>, InputError> {
    let reason = "it has more than 1 MB, too much for a scenario; `import` reads records";
    read_limited(file, LARGEST_TEXT)?.map_err(|_| InputError::bad(file, &reason))
}

/// The bytes of a record: a file, a pipe, or standard input where the file is `-`. Each is read once.
pub(crate) fn read_record(file: &Path) -> Result<Vec<u8>, InputError> {
    let reason = |size| {
        let (megabytes, most) = (size / 1_000_000, LARGEST / 1_000_000);
        format!("it has {megabytes} MB, more than the {most} MB that are read; cut it first")
    };
    read_limited(file, LARGEST)?.map_err(|size| InputError::bad(file, &reason(size)))
}

/// The bytes of a file, or else its size if it has more than `most`; `most` + 1 if the file does not report its size.
fn read_limited(file: &Path, most: u64) -> Result<Result<Vec<u8>, u64>, InputError> {
    let unread = |error: io::Error| InputError::bad(file, &error);
    let mut bytes = Vec::new();
    if is_standard_input(file) {
        // A pipe does not report its size: one byte more shows that it has too much.
        io::stdin().take(most + 1).read_to_end(&mut bytes).map_err(unread)?;
    } else {
        let kind = fs::metadata(file).map_err(unread)?;
        // A file reports its size: none of one that is too large is read.
        if kind.is_file() && kind.len() > most {
            return Ok(Err(kind.len()));
        }
        if !kind.is_file() && !is_pipe(&kind) {
            return Err(InputError::bad(file, &NO_FILE));
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

/// Files by the words of the arguments that name them.
pub(crate) type Places<'a> = Vec<(&'static str, &'a Path)>;

pub(crate) fn places<'a>(word: &'static str, files: impl IntoIterator<Item = &'a PathBuf>) -> Places<'a> {
    files.into_iter().map(|file| (word, file.as_path())).collect()
}

pub(crate) fn check(inputs: &Places<'_>, outputs: &Places<'_>) -> Result<(), InputError> {
    let mut standard = inputs.iter().filter(|(_, file)| is_standard_input(file));
    if let (Some((first, _)), Some((second, _))) = (standard.next(), standard.next()) {
        let sentence = format!("standard input is named twice, as {first} and as {second}, but can be read once");
        return Err(InputError { sentence, is_of_output: false });
    }
    for (place, (word, file)) in outputs.iter().enumerate() {
        let is_same = |other: &Path| match (is_standard_output(file), is_standard_output(other)) {
            (false, false) => output::is_same(file, other),
            (one, both) => one && both,
        };
        let input = |other: &Path| {
            // Standard input may be a file, as in `< record.csv --out record.csv`, which would be overwritten too.
            let other = if is_standard_input(other) { Path::new("/dev/stdin") } else { other };
            !is_standard_output(file) && output::is_same(file, other)
        };
        let read = inputs.iter().find(|(_, other)| input(other)).map(|(other, _)| format!("{other}, which is read"));
        let written = outputs[..place].iter().find(|(_, other)| is_same(other));
        let written = written.map(|(other, _)| format!("what {other} writes"));
        if let Some(other) = read.or(written) {
            let sentence = format!("{}: {word} would overwrite {other}; nothing was done", file.display());
            return Err(InputError { sentence, is_of_output: false });
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
    // `eprintln!` would panic where standard error is closed.
    let _ = writeln!(io::stderr(), "{}", scenario::shown(&line.to_string()));
}

/// `| head` closes the pipe early, which is no failure of a run: the rest is dropped without a message.
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
