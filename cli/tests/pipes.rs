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

#[test]
fn only_short_texts_in_files_and_pipes_are_read() {
    let folder = Folder::of(SCENARIO);
    folder.file("long.toml", &format!("{SCENARIO}#{}", " ".repeat(1_000_000)));
    folder.file("device.toml", "[record]\nfile = \"/dev/zero\"\n[record.sensors.displacement]\ncolumn = \"x\"\n");
    for (arguments, sentence) in [
        (&["run", "long.toml"][..], "more than 1 MB"),
        (&["run", "/dev/zero"], "neither a file nor a pipe"),
        (&["run", "."], "neither a file nor a pipe"),
        (&["run", "scenario.toml", "--record", "/dev/zero"], "neither a file nor a pipe"),
        (&["run", "scenario.toml", "--record", "scenario.toml", "--map", "/dev/zero"], "neither a file nor a pipe"),
        (&["run", "device.toml"], "neither a file nor a pipe"),
    ] {
        let error = folder.refused(arguments);
        assert!(error.contains(sentence) && error.lines().count() == 1, "{arguments:?}: {error}");
    }
}

#[test]
fn a_record_in_place_of_a_scenario_is_known_as_one() {
    let folder = Folder::new();
    folder.measured();
    for file in ["plain.csv", "sheet.csv"] {
        let error = folder.refused(&["run", file]);
        assert!(error.contains("this is a record") && error.contains("import"), "{error}");
    }
}
