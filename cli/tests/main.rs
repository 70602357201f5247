//! The built command, called as from a script.
#![expect(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

mod columns;
mod decay;
mod fix;
mod hostile;
mod import;
#[cfg(unix)]
mod outputs;
mod population;
mod posterior;
mod records;
mod refused;
mod report;
mod run;
mod stream;
mod sweep;
mod tune;
mod two_files;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

const SAMPLE: &str = include_str!("../../core/tests/sample.toml");

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn file(folder: &TempDir, name: &str, text: &str) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    path
}

fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_kalmanscope-cli"))
}

fn command() -> Command {
    let mut command = program();
    command.arg("run");
    command
}

/// Runs a command; returns its exit code, its standard output and its standard error.
fn ended(command: &mut Command) -> (Option<i32>, String, String) {
    let Output { status, stdout, stderr } = command.output().unwrap();
    (status.code(), text(&stdout), text(&stderr))
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Runs a command that must succeed with nothing on standard error; returns its standard output.
#[track_caller]
fn succeeds(command: &mut Command) -> String {
    let (code, stdout, stderr) = ended(command);
    assert_eq!((code, stderr.as_str()), (Some(0), ""), "{command:?}");
    stdout
}

/// Runs a command that must fail with this code; returns standard output and standard error.
#[track_caller]
fn fails(command: &mut Command, code: i32) -> (String, String) {
    let (found, stdout, stderr) = ended(command);
    assert_eq!(found, Some(code), "{command:?}: {stderr}");
    (stdout, stderr)
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap()
}
