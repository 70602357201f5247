//! Pipes, standard input and output, and unread output.

use std::fs;
use std::process::Command;

use super::folder::{Folder, SCENARIO, read};

#[test]
fn records_come_through_pipes_and_are_read_once() {
    let folder = Folder::new();
    let (record, scenario) = folder.measured();
    let bytes = fs::read(&record).unwrap();
    let line = |text: &str, key: &str| text.lines().find(|line| line.starts_with(key)).map(str::to_owned);
    for file in ["-", "/dev/stdin"] {
        let (code, out, error) = folder.call(&["import", file], &bytes);
        assert_eq!(code, 0, "{error}");
        assert_eq!(line(&out, "hash = "), line(&read(&scenario), "hash = "));
        assert_eq!(line(&out, "file = "), None);
    }
    let plain = folder.call(&["run", "sheet.toml", "--out", "a.csv"], b"");
    let piped = folder.call(&["run", "sheet.toml", "--record", "-", "--out", "b.csv"], &bytes);
    assert_eq!((plain.0, piped.0), (0, 0), "{}", piped.2);
    assert_eq!(read(&folder.path("a.csv")), read(&folder.path("b.csv")));
    let (code, out, error) = folder.call(&["run", "sheet.toml", "--holdout", "-"], &bytes);
    assert!(code == 0 && out.contains("free run of the final models over "), "{error}");
    let made = Command::new("mkfifo").arg(folder.path("pipe")).status().unwrap();
    assert!(made.success());
    let (pipe, sent) = (folder.path("pipe"), bytes.clone());
    let writer = std::thread::spawn(move || fs::write(pipe, sent).unwrap());
    let (code, out, error) = folder.call(&["import", "pipe"], b"");
    writer.join().unwrap();
    assert!(code == 0 && line(&out, "hash = ") == line(&read(&scenario), "hash = "), "{error}");
}

#[test]
fn a_dash_is_standard_output_and_the_table_goes_beside() {
    let folder = Folder::new();
    folder.file("scenario.toml", SCENARIO);
    let (code, out, error) = folder.call(&["run", "scenario.toml", "--out", "-"], b"");
    assert_eq!(code, 0, "{error}");
    assert!(out.starts_with("filter,k,t,") && !out.contains("mean NIS") && error.contains("mean NIS"), "{out}{error}");
    assert_eq!(folder.names(), ["scenario.toml"]);
}

#[test]
fn only_short_texts_in_files_and_pipes_are_read() {
    let folder = Folder::new();
    folder.file("scenario.toml", SCENARIO);
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
        let (code, _, error) = folder.call(arguments, b"");
        assert!(code == 2 && error.contains(sentence) && error.lines().count() == 1, "{arguments:?}: {error}");
    }
}

#[test]
fn a_record_in_place_of_a_scenario_is_known_as_one() {
    let folder = Folder::new();
    folder.measured();
    for file in ["plain.csv", "sheet.csv"] {
        let (code, _, error) = folder.call(&["run", file], b"");
        assert!(code == 2 && error.contains("this is a record") && error.contains("import"), "{error}");
    }
}
