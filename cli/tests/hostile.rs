//! Scenarios that broke something, through the built command: each ends in words, with outputs that can be read.

use std::fs;
use std::path::{Path, PathBuf};

use crate::Folder;

fn scenarios() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/hostile");
    let mut files: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|file| file.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|end| end == "toml"));
    files.sort();
    files
}

/// Runs the command, which may say that a filter stopped, or refuse a record without readings, but must not panic. Returns
/// standard output.
#[track_caller]
fn call(folder: &Folder, arguments: &[&str]) -> String {
    let (code, stdout, stderr) = folder.call(arguments);
    let is_refused = code == 2 && stderr.starts_with("error: ") && arguments.contains(&"--record");
    assert!(code < 2 || is_refused, "{arguments:?}: {code}\n{stderr}");
    assert!(!stderr.contains("panicked"), "{arguments:?}: {stderr}");
    stdout
}

/// Whether people can read the numbers of a text.
#[track_caller]
fn check(text: &str, what: &str) {
    for word in text.split(|c: char| !(c.is_alphanumeric() || c == 'σ')) {
        assert!(!["NaN", "nan", "inf", "infσ"].contains(&word), "{what}: {word} in\n{text}");
        assert!(word.len() < 18 || !word.bytes().all(|byte| byte.is_ascii_digit()), "{what}: {word} in\n{text}");
    }
}

#[test]
fn scenarios_that_broke_something_are_run_reported_and_drawn() {
    let folder = Folder::new();
    assert!(scenarios().len() > 10);
    for file in scenarios() {
        let name = file.to_str().unwrap();
        let outputs = ["all.csv", "all.svg", "all.json", "all.html"].map(|file| ["--out", file]).concat();
        check(&call(&folder, &[&["run", name, "--record-out", "record.csv"], &outputs[..]].concat()), name);
        check(&folder.read("all.svg"), name);
        let page = folder.read("all.html");
        check(page.split("<h2>Scenario</h2>").next().unwrap(), name);
        // A record of one sample is none.
        if folder.read("record.csv").lines().count() > 2 {
            check(&call(&folder, &["run", name, "--record", "record.csv", "--out", "all.html"]), name);
        }
    }
}
