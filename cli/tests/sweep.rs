//! Sweeps of the built command: tables, shards, and continuing after an end by force.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use tempfile::TempDir;

use crate::{file, program};

const SCENARIO: &str = "duration = 4.0\n[plant]\nnatural_frequency = 6.0\n";

fn scenario(folder: &TempDir, text: &str) -> PathBuf {
    file(folder, "scenario.toml", text)
}

fn sweep(scenario: &Path, out: &Path, arguments: &[&str]) -> Command {
    let mut command = program();
    command.arg("sweep").arg(scenario).arg("--out").arg(out).args(arguments);
    command
}

#[track_caller]
fn table(scenario: &Path, out: &Path, arguments: &[&str]) -> String {
    let output = sweep(scenario, out, arguments).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(!out.with_extension("csv.part").exists());
    std::fs::read_to_string(out).unwrap()
}

const GRID: [&str; 6] = [
    "--vary",
    "filters.EKF.initial_mean.natural_frequency=2:14:4",
    "--vary",
    "filters.*.process_std=0.1:10:3:log",
    "--score",
    "nis,rmse.natural_frequency,diverged",
];

#[test]
fn a_table_has_a_row_a_cell_in_the_order_of_the_axes() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = scenario(&folder, SCENARIO);
    let text = table(&scenario, &folder.path().join("a.csv"), &GRID);
    let mut lines = text.lines();
    assert_eq!(
        lines.next().unwrap(),
        "filters.EKF.initial_mean.natural_frequency,filters.*.process_std,EKF.nis,EKF.rmse.natural_frequency,\
         EKF.diverged,UKF.nis,UKF.rmse.natural_frequency,UKF.diverged"
    );
    let rows: Vec<Vec<f64>> = lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    let axes: Vec<[f64; 2]> = rows.iter().map(|row| [row[0], (1e6 * row[1]).round() / 1e6]).collect();
    assert_eq!(axes[..4], [[2.0, 0.1], [2.0, 1.0], [2.0, 10.0], [6.0, 0.1]]);
    assert_eq!(rows.len(), 12);
    assert!(rows.iter().flatten().all(|number| number.is_finite()));
    // The UKF does not have the EKF's guess.
    assert_eq!(rows[0][5], rows[3][5]);
    assert_ne!(rows[0][2], rows[3][2]);
}

#[test]
fn threads_and_shards_do_not_change_a_number() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = scenario(&folder, SCENARIO);
    let out = |name: &str| folder.path().join(name);
    let with = |more: &[&'static str]| [&GRID[..], &["--seeds", "3"], more].concat();
    let whole = table(&scenario, &out("whole.csv"), &with(&["--threads", "1"]));
    assert_eq!(table(&scenario, &out("threads.csv"), &with(&["--threads", "3"])), whole);
    let shard = |shard| table(&scenario, &out("shard.csv"), &with(&["--shard", shard]));
    let names = whole.lines().next().unwrap().to_owned() + "\n";
    let shards = ["1/5", "2/5", "3/5", "4/5", "5/5"];
    let shards: String = shards.map(|name| shard(name).strip_prefix(&names).unwrap().to_owned()).concat();
    assert_eq!(names + &shards, whole);
}

#[test]
fn a_sweep_that_was_killed_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = scenario(&folder, SCENARIO);
    let grid = ["--vary", "filters.*.process_std=0.1:10:400:log", "--seeds", "10", "--score", "nis", "--threads", "1"];
    let whole = table(&scenario, &folder.path().join("whole.csv"), &grid);
    let out = folder.path().join("killed.csv");
    let part = folder.path().join("killed.csv.part");
    let rows = || std::fs::read(&part).map_or(0, |bytes| bytes.iter().filter(|&&byte| byte == b'\n').count());
    let mut child = sweep(&scenario, &out, &grid).stderr(Stdio::null()).spawn().unwrap();
    while rows() < 50 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let before = rows();
    assert!(before >= 50 && !out.exists(), "killed in the middle: {before}");
    // A row is torn, as by a full disk.
    let bytes = std::fs::read(&part).unwrap();
    std::fs::write(&part, &bytes[..bytes.len() - 7]).unwrap();
    assert_eq!(table(&scenario, &out, &grid), whole);
    assert!(!part.exists());
}

#[test]
fn rows_of_another_sweep_are_not_taken_for_those_of_this_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = scenario(&folder, SCENARIO);
    let out = folder.path().join("a.csv");
    let expected = table(&path, &out, &GRID);
    let part = folder.path().join("a.csv.part");
    std::fs::write(&part, "# sweep 0123\nfilters\n1,2\n").unwrap();
    assert_eq!(table(&path, &out, &GRID), expected);
}

#[test]
fn two_programs_do_not_write_one_table() {
    let folder = tempfile::tempdir().unwrap();
    let path = scenario(&folder, SCENARIO);
    let out = folder.path().join("a.csv");
    let part = folder.path().join("a.csv.part");
    let held = File::create(&part).unwrap();
    held.lock().unwrap();
    let output = sweep(&path, &out, &GRID).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.contains("another program is writing this table") && !out.exists(), "{text}");
    drop(held);
    assert_eq!(table(&path, &out, &GRID).lines().count(), 13);
}

#[test]
fn wrong_arguments_are_refused_in_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = scenario(&folder, SCENARIO);
    for (out, arguments, message) in [
        ("a.csv", &["--vary", "plant.mass=1:2:3"][..], "the scenario has no number `plant.mass` to vary"),
        ("a.csv", &["--vary", "seed=1:2"], "is not an axis"),
        ("a.csv", &["--vary", "seed=1:3:3", "--seeds", "3"], "two axes vary `seed`"),
        ("a.csv", &["--score", "speed"], "is no score; there are nis"),
        ("a.csv", &["--filter", "KF"], "the scenario has no filter `KF`"),
        ("a.csv", &["--shard", "4/3"], "expected I/N"),
        ("a.txt", &[], "a .csv file"),
    ] {
        let output = sweep(&scenario, &folder.path().join(out), arguments).output().unwrap();
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.contains(message), "{text}");
    }
}

/// Runs a command with a text as its standard input. Returns its success, its standard output and its standard error.
fn fed(mut command: Command, text: &[u8]) -> (bool, String, String) {
    use std::io::Write as _;
    let mut child = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // A command that refuses its arguments reads nothing.
    let _ = child.stdin.take().unwrap().write_all(text);
    let output = child.wait_with_output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.success(), text(output.stdout), text(output.stderr))
}

#[test]
fn a_dash_is_standard_output_and_the_table_is_that_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = scenario(&folder, SCENARIO);
    let whole = table(&path, &folder.path().join("a.csv"), &GRID);
    let names = || {
        let entries = std::fs::read_dir(folder.path()).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        names
    };
    let before = names();
    for out in ["-", "/dev/stdout"] {
        let (is_well, text, error) = fed(sweep(Path::new("-"), Path::new(out), &GRID), SCENARIO.as_bytes());
        assert!(is_well && error.is_empty(), "{error}");
        assert_eq!(text, whole);
    }
    let shards = ["1/2", "2/2"].map(|shard| {
        let (is_well, text, error) = fed(sweep(&path, Path::new("-"), &[&GRID[..], &["--shard", shard]].concat()), b"");
        assert!(is_well, "{error}");
        text
    });
    let heading = whole.lines().next().unwrap();
    assert_eq!(shards[0].clone() + shards[1].strip_prefix(heading).unwrap().trim_start(), whole);
    assert_eq!(names(), before, "no part is left");
}

#[test]
fn a_record_comes_from_standard_input() {
    let folder = tempfile::tempdir().unwrap();
    let path = scenario(&folder, SCENARIO);
    let record = folder.path().join("record.csv");
    let mut run = program();
    assert!(run.arg("run").arg(&path).arg("--quiet").arg("--record-out").arg(&record).status().unwrap().success());
    let grid = ["--vary", "filters.*.process_std=0.1:10:3:log", "--score", "nis"];
    let of_file = [&grid[..], &["--record", record.to_str().unwrap()]].concat();
    let expected = table(&path, &folder.path().join("a.csv"), &of_file);
    let piped = [&grid[..], &["--record", "-"]].concat();
    let bytes = std::fs::read(&record).unwrap();
    let (is_well, text, error) = fed(sweep(&path, Path::new("-"), &piped), &bytes);
    assert!(is_well, "{error}");
    assert_eq!(text, expected);
    let (is_well, _, error) = fed(sweep(Path::new("-"), Path::new("-"), &piped), &bytes);
    assert!(!is_well && error.contains("standard input is named twice"), "{error}");
}

#[test]
fn what_is_no_table_and_unknown_filters_are_refused_in_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    let path = scenario(&folder, SCENARIO);
    for (out, arguments, sentence) in [
        ("table.txt", &GRID[..], "must be a .csv file, beside which finished rows are kept to continue from there"),
        ("-", &["--vary", "filters.KF.fading=1:1.1:2"], "`filters.KF.fading` to vary; its filters are `EKF` and `UKF`"),
        ("-", &["--seeds", "2", "--filter", "KF"], "no filter `KF`; its filters are `EKF` and `UKF`"),
        ("-", &["--vary", "filters.EKF.fading=1:1.1:2", "--vary", "filters#1.fading=1:1.2:2"], "`filters#1.fading`"),
    ] {
        let out = if out == "-" { PathBuf::from(out) } else { folder.path().join(out) };
        let (is_well, text, error) = fed(sweep(&path, &out, arguments), b"");
        assert!(!is_well && text.is_empty() && error.contains(sentence), "{error}");
        assert_eq!(error.lines().count(), 1, "{error}");
    }
}
