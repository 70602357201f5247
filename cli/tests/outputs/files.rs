//! Files are written whole or not at all, and never over an input.

use std::fs;
use std::os::unix::fs::symlink;
use std::process::Command;

use super::folder::{Folder, SCENARIO, read};

#[test]
fn an_output_is_never_an_input() {
    let folder = Folder::new();
    let (record, scenario) = folder.measured();
    let (sheet, settings) = (read(&record), read(&scenario));
    symlink("sheet.csv", folder.path("link.csv")).unwrap();
    fs::hard_link(&record, folder.path("hard.csv")).unwrap();
    let before = folder.names();
    for arguments in [
        &["run", "truth.toml", "--record", "sheet.csv", "--out", "sheet.csv"][..],
        &["run", "sheet.toml", "--out", "./sheet.csv"],
        &["run", "sheet.toml", "--svg", "link.csv"],
        &["run", "sheet.toml", "--record-out", "hard.csv"],
        &["run", "sheet.toml", "--holdout", "plain.csv", "--out", "plain.csv"],
        &["run", "sheet.toml", "--out", "sheet.toml"],
        &["run", "sheet.toml", "--out", "new.csv", "--svg", "new.csv"],
        &["run", "sheet.toml", "--out", "-", "--svg", "-"],
        &["report", "sheet.toml", "--out", "sheet.toml"],
        &["import", "sheet.csv", "--out", "sheet.csv"],
        &["sweep", "sheet.toml", "--out", "sheet.csv"],
        &["tune", "sheet.toml", "--turn", "filters.EKF.fading", "--out", "sheet.toml"],
    ] {
        let (code, out, error) = folder.call(arguments, b"");
        assert_eq!((code, out.as_str()), (2, ""), "{arguments:?}: {error}");
        assert!(error.contains(" would overwrite ") && error.lines().count() == 1, "{arguments:?}: {error}");
    }
    assert_eq!((read(&record), read(&scenario), folder.names()), (sheet, settings, before));
    let (code, _, error) = folder.call(&["run", "-", "--record", "-"], SCENARIO.as_bytes());
    assert!(code == 2 && error.contains("standard input is named twice"), "{error}");
}

#[cfg(target_os = "linux")]
#[test]
fn a_result_that_cannot_be_written_is_told_by_each_command() {
    let folder = Folder::new();
    folder.measured();
    folder.file("scenario.toml", SCENARIO);
    for arguments in [
        &["run", "scenario.toml", "--out", "/dev/full"][..],
        &["run", "scenario.toml", "--svg", "/dev/full"],
        &["run", "scenario.toml", "--record-out", "/dev/full"],
        &["report", "scenario.toml", "--out", "/dev/full"],
        &["import", "sheet.csv", "--out", "/dev/full"],
        &["import", "sheet.csv", "--out", "nowhere/new.toml"],
        &["tune", "scenario.toml", "--turn", "filters.one.fading=1:1.1", "--out", "/dev/full"],
        &["sweep", "scenario.toml", "--out", "nowhere/new.csv"],
    ] {
        let (code, _, error) = folder.call(arguments, b"");
        let is_told = error.lines().any(|line| line.starts_with("error: "));
        assert!(code == 1 && is_told, "{arguments:?}: {code} {error}");
    }
    for arguments in [
        &["import", "sheet.csv"][..],
        &["run", "scenario.toml"],
        &["tune", "scenario.toml", "--turn", "filters.one.fading=1:1.1"],
    ] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_kalmanscope-cli"));
        let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
        let output = command.current_dir(folder.0.path()).args(arguments).stdout(full).output().unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(1) && error.contains("standard output: "), "{arguments:?}: {error}");
    }
}

#[test]
fn a_measured_record_runs_again_with_its_scenario() {
    let folder = Folder::new();
    folder.measured();
    let first = folder.call(&["run", "sheet.toml", "--out", "a.csv", "--record-out", "again.csv"], b"");
    assert_eq!(first.0, 0, "{}", first.2);
    let second = folder.call(&["run", "sheet.toml", "--record", "again.csv", "--out", "b.csv"], b"");
    assert_eq!(second.0, 0, "{}", second.2);
    assert!(read(&folder.path("a.csv")).lines().count() > 1000);
    assert_eq!(read(&folder.path("a.csv")), read(&folder.path("b.csv")));
}

#[test]
fn a_file_of_others_is_no_part_of_a_sweep() {
    let folder = Folder::new();
    folder.file("scenario.toml", SCENARIO);
    folder.file("table.csv.part", "my own notes\n");
    let sweep = ["sweep", "scenario.toml", "--vary", "filters.one.fading=1:1.1:3", "--out", "table.csv"];
    let (code, _, error) = folder.call(&sweep, b"");
    assert!(code == 2 && error.contains("table.csv.part") && error.contains("stays as it is"), "{error}");
    assert_eq!(read(&folder.path("table.csv.part")), "my own notes\n");
    folder.file("table.csv.part", "# sweep 0123456789abcdef\na,b\n1,2\n");
    let (code, _, error) = folder.call(&sweep, b"");
    assert!(code == 0 && error.contains("of another sweep, and is begun anew"), "{error}");
    assert_eq!((read(&folder.path("table.csv")).lines().count(), folder.names().len()), (4, 2));
}

#[test]
fn extreme_axes_are_drawn() {
    let folder = Folder::new();
    let record: String =
        (0..40).map(|k| format!("{k},0,{}\n", if k % 2 == 0 { "1.7e308" } else { "-1.7e308" })).collect();
    folder.file("record.csv", &format!("t,force,displacement\n{record}"));
    folder.file("scenario.toml", "[[sensors]]\nmeasures = \"displacement\"\nnoise_std = 1.0\n");
    let (code, _, error) =
        folder.call(&["run", "scenario.toml", "--record", "record.csv", "--quiet", "--svg", "a.svg"], b"");
    assert!(code < 2, "{code} {error}");
    assert!(read(&folder.path("a.svg")).ends_with("</svg>\n"));
}
