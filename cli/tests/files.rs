//! Files are written whole or not at all, and never over an input.

use std::fs;
use std::os::unix::fs::symlink;
use std::process::Stdio;

use crate::{Folder, text};

pub(crate) const SCENARIO: &str = "duration = 5.0\n[[filters]]\nname = \"one\"\n";

#[test]
fn an_output_is_never_an_input() {
    let folder = Folder::new();
    folder.measured();
    let contents = || (folder.read("sheet.csv"), folder.read("sheet.toml"), folder.names());
    symlink("sheet.csv", folder.path("link.csv")).unwrap();
    fs::hard_link(folder.path("sheet.csv"), folder.path("hard.csv")).unwrap();
    let before = contents();
    for arguments in [
        &["run", "truth.toml", "--record", "sheet.csv", "--out", "sheet.csv"][..],
        &["run", "sheet.toml", "--out", "./sheet.csv"],
        &["run", "sheet.toml", "--out", "link.csv"],
        &["run", "sheet.toml", "--record-out", "hard.csv"],
        &["run", "sheet.toml", "--holdout", "plain.csv", "--out", "plain.csv"],
        &["run", "sheet.toml", "--fix", "1", "--out", "sheet.toml"],
        &["run", "sheet.toml", "--out", "new.csv", "--out", "new.csv"],
        &["run", "sheet.toml", "--out", "-", "--out", "-"],
        &["import", "sheet.csv", "--out", "sheet.csv"],
        &["import", "sheet.csv", "--decay", "sheet.csv"],
        &["sweep", "sheet.toml", "--out", "sheet.csv"],
        &["tune", "sheet.toml", "--turn", "filters.EKF.fading", "--out", "sheet.toml"],
    ] {
        let (out, error) = folder.fails(arguments, 2);
        let is_one_line = error.lines().count() == 1 && out.is_empty();
        assert!(error.contains(" would overwrite ") && is_one_line, "{arguments:?}: {error}");
    }
    assert_eq!(contents(), before);
    let (code, _, error) = folder.fed(&["run", "-", "--record", "-"], SCENARIO.as_bytes());
    assert!(code == 2 && error.contains("standard input is named twice"), "{error}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_result_that_cannot_be_written_is_reported_by_each_command() {
    let folder = Folder::of(SCENARIO);
    folder.measured();
    for arguments in [
        &["run", "scenario.toml", "--out", "/dev/full"][..],
        &["run", "scenario.toml", "--record-out", "/dev/full"],
        &["import", "sheet.csv", "--out", "/dev/full"],
        &["import", "sheet.csv", "--out", "nowhere/new.toml"],
        &["tune", "scenario.toml", "--turn", "filters.one.fading=1:1.1", "--out", "/dev/full"],
        &["sweep", "scenario.toml", "--out", "nowhere/new.csv"],
    ] {
        let (_, error) = folder.fails(arguments, 1);
        assert!(error.lines().any(|line| line.starts_with("error: ")), "{arguments:?}: {error}");
    }
    for arguments in [
        &["import", "sheet.csv"][..],
        &["run", "scenario.toml"],
        &["tune", "scenario.toml", "--turn", "filters.one.fading=1:1.1"],
    ] {
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = folder.command(arguments).stdin(Stdio::null()).stdout(full).output().unwrap();
        let error = text(&output.stderr);
        assert!(output.status.code() == Some(1) && error.contains("standard output: "), "{arguments:?}: {error}");
    }
}

#[test]
fn a_measured_record_runs_again_with_its_scenario() {
    let folder = Folder::new();
    folder.measured();
    folder.succeeds(&["run", "sheet.toml", "--out", "a.csv", "--record-out", "again.csv"]);
    folder.succeeds(&["run", "sheet.toml", "--record", "again.csv", "--out", "b.csv"]);
    assert!(folder.read("a.csv").lines().count() > 1000);
    assert_eq!(folder.read("a.csv"), folder.read("b.csv"));
}

#[test]
fn a_foreign_file_is_not_part_of_a_sweep() {
    let folder = Folder::of(SCENARIO);
    folder.file("table.csv.part", "my own notes\n");
    let sweep = ["sweep", "scenario.toml", "--vary", "filters.one.fading=1:1.1:3", "--out", "table.csv"];
    let error = folder.refused(&sweep);
    assert!(error.contains("table.csv.part") && error.contains("stays as it is"), "{error}");
    assert_eq!(folder.read("table.csv.part"), "my own notes\n");
    folder.file("table.csv.part", "# sweep 0123456789abcdef\na,b\n1,2\n");
    let (_, error) = folder.succeeds(&sweep);
    assert!(error.contains("belongs to another sweep, so the table begins again"), "{error}");
    assert_eq!((folder.read("table.csv").lines().count(), folder.names().len()), (4, 2));
}
