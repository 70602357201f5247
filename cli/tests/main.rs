//! The built command, called as from a script.
#![expect(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

mod cases;
mod columns;
mod dialects;
mod figures;
#[cfg(unix)]
mod files;
mod fix;
mod formats;
mod guesses;
mod hostile;
mod import;
mod of_filter;
#[cfg(unix)]
mod pipes;
mod population;
mod records;
mod refused;
mod report;
mod run;
mod stream;
mod sweep;
mod two_files;
#[cfg(unix)]
mod words;

use std::fs;
use std::io::Write as _;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

const SAMPLE: &str = include_str!("../../core/tests/sample.toml");

/// A folder in which the command runs.
struct Folder(TempDir);

/// The exit code of a command, its standard output and its standard error.
type Ended = (i32, String, String);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn of(scenario: &str) -> Self {
        let folder = Self::new();
        folder.file("scenario.toml", scenario);
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn file(&self, name: &str, text: &str) -> PathBuf {
        fs::write(self.path(name), text).unwrap();
        self.path(name)
    }

    #[track_caller]
    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    fn has(&self, name: &str) -> bool {
        self.path(name).exists()
    }

    fn names(&self) -> Vec<String> {
        let names = fs::read_dir(self.0.path()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_kalmanscope-cli"));
        command.current_dir(self.0.path()).args(arguments);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    fn fed(&self, arguments: &[&str], input: &[u8]) -> Ended {
        let mut child = self.command(arguments).spawn().unwrap();
        let (mut to, input) = (child.stdin.take().unwrap(), input.to_owned());
        // A command that does not read its input closes it.
        let feeder = std::thread::spawn(move || drop(to.write_all(&input)));
        let Output { status, stdout, stderr } = child.wait_with_output().unwrap();
        feeder.join().unwrap();
        (status.code().unwrap(), text(&stdout), text(&stderr))
    }

    fn call(&self, arguments: &[&str]) -> Ended {
        self.fed(arguments, b"")
    }

    /// Runs a command that must succeed. Returns its standard output and its standard error.
    #[track_caller]
    fn succeeds(&self, arguments: &[&str]) -> (String, String) {
        let (code, out, said) = self.call(arguments);
        assert_eq!(code, 0, "{arguments:?}: {said}");
        (out, said)
    }

    /// The same with nothing on standard error. Returns its standard output.
    #[track_caller]
    fn quietly(&self, arguments: &[&str]) -> String {
        let (out, said) = self.succeeds(arguments);
        assert_eq!(said, "", "{arguments:?}");
        out
    }

    /// Runs a command that must fail with this code. Returns its standard output and its standard error.
    #[track_caller]
    fn fails(&self, arguments: &[&str], code: i32) -> (String, String) {
        let (found, out, said) = self.call(arguments);
        assert_eq!(found, code, "{arguments:?}: {said}");
        (out, said)
    }

    /// Runs a command whose input must be refused. Returns its standard error.
    #[track_caller]
    fn refused(&self, arguments: &[&str]) -> String {
        self.fails(arguments, 2).1
    }

    /// A record as a laboratory writes it, `sheet.csv`, and its scenario, `sheet.toml`.
    fn measured(&self) {
        let truth = "duration = 40.0\ndt = 0.04\nhold = \"first\"\n[plant]\nnatural_frequency = 6.0\n\
                     [[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.002\n";
        self.file("truth.toml", truth);
        self.succeeds(&["run", "truth.toml", "--record-out", "plain.csv"]);
        self.file("sheet.csv", &("Zeit [s];Kraft [N];Weg [mm]\n".to_owned() + &sheet(&self.read("plain.csv"), 2.0)));
        self.succeeds(&["import", "sheet.csv", "--out", "sheet.toml"]);
    }
}

/// The rows of a record with a mass \[kg\] as a spreadsheet writes them: semicolons, decimal commas, millimetres.
fn sheet(record: &str, mass: f64) -> String {
    let row = |line: &str| {
        let cells: Vec<f64> = line.split(',').take(3).map(|cell| cell.parse().unwrap()).collect();
        format!("{:.2};{:.5};{:.4}\n", cells[0], mass * cells[1], 1000.0 * cells[2]).replace('.', ",")
    };
    record.lines().skip(1).map(row).collect()
}

#[track_caller]
fn value(table: &str, name: &str) -> f64 {
    let line = table.lines().find(|line| line.contains(name)).unwrap_or_else(|| panic!("no {name} in {table}"));
    line.split_once(name).unwrap().1.split_whitespace().next().unwrap().parse().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}
