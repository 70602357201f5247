//! Pipes, standard input and output, and unread output.

use std::fs;
use std::process::Command;

use crate::Folder;
use crate::files::SCENARIO;

#[test]
fn records_come_through_pipes_and_are_read_once() {
    let folder = Folder::new();
    folder.measured();
    let (bytes, scenario) = (fs::read(folder.path("sheet.csv")).unwrap(), folder.read("sheet.toml"));
    let line = |text: &str, key: &str| text.lines().find(|line| line.starts_with(key)).map(str::to_owned);
    for file in ["-", "/dev/stdin"] {
        let (code, out, error) = folder.fed(&["import", file], &bytes);
        assert_eq!(code, 0, "{error}");
        assert_eq!(line(&out, "hash = "), line(&scenario, "hash = "));
        assert_eq!(line(&out, "file = "), None);
    }
    folder.succeeds(&["run", "sheet.toml", "--out", "a.csv"]);
    let (code, _, error) = folder.fed(&["run", "sheet.toml", "--record", "-", "--out", "b.csv"], &bytes);
    assert_eq!(code, 0, "{error}");
    assert_eq!(folder.read("a.csv"), folder.read("b.csv"));
    let (code, out, error) = folder.fed(&["run", "sheet.toml", "--holdout", "-"], &bytes);
    assert!(code == 0 && out.contains("free run of the final models over "), "{error}");
    let made = Command::new("mkfifo").arg(folder.path("pipe")).status().unwrap();
    assert!(made.success());
    let (pipe, sent) = (folder.path("pipe"), bytes.clone());
    let writer = std::thread::spawn(move || fs::write(pipe, sent).unwrap());
    let (out, error) = folder.succeeds(&["import", "pipe"]);
    writer.join().unwrap();
    assert!(line(&out, "hash = ") == line(&scenario, "hash = "), "{error}");
}

#[test]
fn a_dash_is_standard_output_and_the_table_goes_beside() {
    let folder = Folder::of(SCENARIO);
    let (out, error) = folder.succeeds(&["run", "scenario.toml", "--verbose", "--out", "-"]);
    assert!(out.starts_with("filter,k,t,") && !out.contains("mean NIS") && error.contains("mean NIS"), "{out}{error}");
    assert_eq!(folder.names(), ["scenario.toml"]);
}
