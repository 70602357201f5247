//! Refused arguments and files, and the ends of failures.

use crate::{Folder, SAMPLE};

#[test]
fn a_scenario_can_come_from_standard_input() {
    let (code, _, error) = Folder::new().fed(&["run", "-"], b"dt = -1");
    assert_eq!(code, 2);
    assert_eq!(error, "error: standard input: `dt` is -1, but must be a finite number above 0\n");
}

#[test]
fn bad_scenarios_are_refused_with_file_and_place() {
    let folder = Folder::new();
    let (table, error) = folder.fails(&["run", "missing.toml"], 2);
    assert!(table.is_empty() && error.starts_with("error: missing.toml: "), "{error}");
    for (toml, message) in [
        ("dt = 0.01\nsped = 3", "line 2: `sped`: unknown field `sped`, expected one of `seed`, `dt`, "),
        ("dt = 0", "`dt` is 0, but must be a finite number above 0"),
        ("duration = 86400", "`duration` is 2000000 times dt or more, but every sample is kept here"),
        ("[[filters]]\nfading = 0.5", "`filters[0].fading` is 0.5, but must be a finite number, at least 1"),
        ("dt = \"a\"", "line 1: `dt`: invalid type: string \"a\", expected f64"),
        ("dt = ", "TOML parse error at line 1, column 6"),
    ] {
        folder.file("bad.toml", toml);
        let (table, error) = folder.fails(&["run", "bad.toml", "--out", "never.csv"], 2);
        assert!(error.starts_with(&format!("error: bad.toml: {message}")), "{error}");
        assert!(table.is_empty() && !folder.has("never.csv"));
    }
}

#[test]
fn bad_records_are_refused_with_file_and_place() {
    let folder = Folder::of(SAMPLE);
    let error = folder.refused(&["run", "scenario.toml", "--record", "missing.csv"]);
    assert!(error.starts_with("error: missing.csv: "), "{error}");
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
            "t,force,displacement,velocity\n0,0,0,0\n1,0,0,0\n1,0,1,0\n",
            "line 4: the time in `t` stands still from 1 s to 1 s: about 2 rows have the same time, as rounded ones: state the sample \
             rate, and the rows count as even\n",
        ),
        ("t,force,displacement,velocity\n0,0,0,0\n", "1 row(s) of numbers remain, but at least 2 are needed\n"),
        ("", "the file is empty\n"),
    ] {
        folder.file("bad.csv", record);
        let (table, error) = folder.fails(&["run", "scenario.toml", "--record", "bad.csv"], 2);
        assert!(error.starts_with(&format!("error: bad.csv: {message}")), "{error}");
        assert!(table.is_empty());
    }
}

#[test]
fn failures_to_write_are_reported_after_everything_else_is_done() {
    let folder = Folder::of(SAMPLE);
    for option in ["--out", "--svg"] {
        let arguments = ["run", "scenario.toml", "-v", option, "no such folder/file", "--record-out", "record.csv"];
        let (table, error) = folder.fails(&arguments, 1);
        assert!(error.starts_with("error: no such folder/file: "), "{error}");
        assert!(table.contains("mean NIS") && folder.has("record.csv"));
        std::fs::remove_file(folder.path("record.csv")).unwrap();
    }
}

#[test]
fn a_closed_pipe_is_not_an_error() {
    let folder = Folder::of(SAMPLE);
    let mut child = folder.command(&["run", "scenario.toml", "--out", "estimates.csv"]).spawn().unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stderr.len()), (Some(0), 0));
    assert_eq!(folder.read("estimates.csv").lines().count(), 6002);
}

#[test]
fn the_command_line_is_checked() {
    let folder = Folder::new();
    for (arguments, word) in [(&["run"][..], "<SCENARIO>"), (&["run", "x.toml", "--speed", "3"], "--speed")] {
        let error = folder.refused(arguments);
        assert!(error.contains(word), "{error}");
    }
    let help = folder.quietly(&["run", "--help"]);
    assert!(
        ["--record", "--seed", "--out", "--record-out", "--svg", "--fail-on"]
            .iter()
            .all(|option| help.contains(option)),
        "{help}"
    );
}
