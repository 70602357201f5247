//! Refused arguments and files, and the ends of failures.

use std::io::Write as _;
use std::process::Stdio;

use crate::{SAMPLE, command, fails, file, folder, read, succeeds, text};

#[test]
fn a_scenario_can_come_from_standard_input() {
    let mut child =
        command().arg("-").stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(b"dt = -1").unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert_eq!(text(&output.stderr), "error: standard input: `dt` is -1, but must be a finite number above 0\n");
}

#[test]
fn bad_scenarios_are_refused_with_file_and_place() {
    let folder = folder();
    let missing = folder.path().join("missing.toml");
    let (table, error) = fails(command().arg(&missing), 2);
    assert!(table.is_empty() && error.starts_with(&format!("error: {}: ", missing.display())), "{error}");
    for (toml, message) in [
        ("dt = 0.01\nsped = 3", "line 2: `sped`: unknown field `sped`, expected one of `seed`, `dt`, "),
        ("dt = 0", "`dt` is 0, but must be a finite number above 0"),
        ("duration = 86400", "`duration` is 2000000 times dt or more, but every sample is kept here"),
        ("[[filters]]\nfading = 0.5", "`filters[0].fading` is 0.5, but must be a finite number, at least 1"),
        ("dt = \"a\"", "line 1: `dt`: invalid type: string \"a\", expected f64"),
        ("dt = ", "TOML parse error at line 1, column 6"),
    ] {
        let path = file(&folder, "bad.toml", toml);
        let out = folder.path().join("never.csv");
        let (table, error) = fails(command().arg(&path).arg("--out").arg(&out), 2);
        assert!(error.starts_with(&format!("error: {}: {message}", path.display())), "{error}");
        assert!(table.is_empty() && !out.exists());
    }
}

#[test]
fn bad_records_are_refused_with_file_and_place() {
    let folder = folder();
    let sample = file(&folder, "sample.toml", SAMPLE);
    let missing = folder.path().join("missing.csv");
    let (_, error) = fails(command().arg(&sample).arg("--record").arg(&missing), 2);
    assert!(error.starts_with(&format!("error: {}: ", missing.display())), "{error}");
    for (record, message) in [
        (
            "t,force,displacement\n0,0,0\n1,0,0\n",
            "the record does not measure velocity, but the scenario has a sensor for it\n",
        ),
        (
            "t,force,displacement,velocity\n0,0,0,0\n1,0,oops,0\n",
            "line 3, column `displacement`: `oops` is not a number\n",
        ),
        (
            "t,force,displacement,velocity\n0,0,0,0\n1,0,0,0\n1,0,0,0\n",
            "line 4: the time stands still from 1 s to 1 s\n",
        ),
        ("t,force,displacement,velocity\n0,0,0,0\n", "1 row(s) of numbers remain, but at least 2 are needed\n"),
        ("", "the file is empty\n"),
    ] {
        let path = file(&folder, "bad.csv", record);
        let (table, error) = fails(command().arg(&sample).arg("--record").arg(&path), 2);
        assert!(error.starts_with(&format!("error: {}: {message}", path.display())), "{error}");
        assert!(table.is_empty());
    }
}

#[test]
fn failures_to_write_are_reported_after_everything_else_is_done() {
    let folder = folder();
    let sample = file(&folder, "sample.toml", SAMPLE);
    let good = folder.path().join("record.csv");
    for option in ["--out", "--svg"] {
        let nowhere = folder.path().join("no such folder/file");
        let (table, error) = fails(command().arg(&sample).arg(option).arg(&nowhere).arg("--record-out").arg(&good), 1);
        assert!(error.starts_with(&format!("error: {}: ", nowhere.display())), "{error}");
        assert!(table.contains("mean NIS") && good.exists());
        std::fs::remove_file(&good).unwrap();
    }
}

#[test]
fn a_closed_pipe_is_not_an_error() {
    let folder = folder();
    let out = folder.path().join("estimates.csv");
    let sample = file(&folder, "sample.toml", SAMPLE);
    let mut child =
        command().arg(sample).arg("--out").arg(&out).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), text(&output.stderr).as_str()), (Some(0), ""));
    assert_eq!(read(&out).lines().count(), 6002);
}

#[test]
fn the_command_line_is_checked() {
    let (_, error) = fails(&mut command(), 2);
    assert!(error.contains("<SCENARIO>"), "{error}");
    let (_, error) = fails(command().args(["x.toml", "--speed", "3"]), 2);
    assert!(error.contains("--speed"), "{error}");
    let help = succeeds(command().arg("--help"));
    assert!(
        ["--record", "--seed", "--out", "--record-out", "--svg", "--fail-on"]
            .iter()
            .all(|option| help.contains(option)),
        "{help}"
    );
}
