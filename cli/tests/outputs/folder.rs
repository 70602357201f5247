//! A folder for each test, in which the built command runs.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use tempfile::TempDir;

pub(crate) const SCENARIO: &str = "duration = 5.0\n[[filters]]\nname = \"one\"\n";

pub(crate) struct Folder(pub(crate) TempDir);

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn file(&self, name: &str, text: &str) -> PathBuf {
        fs::write(self.path(name), text).unwrap();
        self.path(name)
    }

    pub(crate) fn names(&self) -> Vec<String> {
        let names = fs::read_dir(self.0.path()).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    }

    /// Runs the command in the folder. Returns the exit code, standard output and standard error.
    pub(crate) fn call(&self, arguments: &[&str], input: &[u8]) -> (i32, String, String) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_kalmanscope-cli"));
        command.current_dir(self.0.path()).args(arguments);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().unwrap();
        // A command that does not read its input closes it.
        let _ = child.stdin.take().unwrap().write_all(input);
        let Output { status, stdout, stderr } = child.wait_with_output().unwrap();
        (status.code().unwrap(), String::from_utf8(stdout).unwrap(), String::from_utf8(stderr).unwrap())
    }

    /// A record as a laboratory writes it, and its scenario.
    pub(crate) fn measured(&self) -> (PathBuf, PathBuf) {
        let truth = "duration = 40.0\ndt = 0.04\nhold = \"first\"\n[plant]\nnatural_frequency = 6.0\n\
                     [[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.002\n";
        self.file("truth.toml", truth);
        assert_eq!(self.call(&["run", "truth.toml", "--record-out", "plain.csv"], b"").0, 0);
        let mut sheet = "Zeit [s];Kraft;Weg [mm]\n".to_owned();
        for line in read(&self.path("plain.csv")).lines().skip(1) {
            let cells: Vec<f64> = line.split(',').take(3).map(|cell| cell.parse().unwrap()).collect();
            sheet.push_str(&format!("{:.2};{:.5};{:.4}\n", cells[0], cells[1], 1000.0 * cells[2]).replace('.', ","));
        }
        let record = self.file("sheet.csv", &sheet);
        assert_eq!(self.call(&["import", "sheet.csv", "--out", "sheet.toml"], b"").0, 0);
        (record, self.path("sheet.toml"))
    }
}

pub(crate) fn read(path: &Path) -> String {
    fs::read_to_string(path).unwrap()
}
