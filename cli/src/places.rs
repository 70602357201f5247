//! The files that a command reads and writes: none is both.

use std::io::{self, BufWriter, StdoutLock, Write};
use std::path::{Path, PathBuf};

use kalmanscope_cli::output;
use kalmanscope_core::scenario::shown;

use crate::input::{InputError, is_standard_input};

/// Files by the words of the arguments that name them.
pub(crate) type Places<'a> = Vec<(&'static str, &'a Path)>;

/// The files of an argument that may be left out.
pub(crate) fn places<'a>(word: &'static str, files: impl IntoIterator<Item = &'a PathBuf>) -> Places<'a> {
    files.into_iter().map(|file| (word, file.as_path())).collect()
}

/// Refuses outputs that are inputs, or that are the same file, and two inputs that are standard input.
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

/// Whether a file's name stands for standard output.
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

/// [`write()`] for a text.
pub(crate) fn write_text(file: &Path, text: &str) -> Result<(), InputError> {
    write_bytes(file, text.as_bytes())
}

/// [`write()`] for bytes.
pub(crate) fn write_bytes(file: &Path, bytes: &[u8]) -> Result<(), InputError> {
    let written: io::Result<()> = write(file, |output| output.write_all(bytes));
    written.map_err(|error| InputError::Output { file: file.to_owned(), reason: error.to_string() })
}

/// Prints on standard output, without characters that steer a terminal.
pub(crate) fn print(text: &str) -> Result<(), InputError> {
    write_text(Path::new("-"), &shown(text))
}

/// Prints a line on standard error, without characters that steer a terminal, and ignores that this can fail.
pub(crate) fn say(line: &dyn std::fmt::Display) {
    let _ = writeln!(io::stderr(), "{}", shown(&line.to_string()));
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
