//! Sweeps of the built command: tables, shards, and continuing after an end by force.

use std::fs::File;
use std::time::Duration;

use crate::Folder;

const SCENARIO: &str = "duration = 4.0\n[plant]\nnatural_frequency = 6.0\n";

fn sweep<'a>(out: &'a str, arguments: &[&'a str]) -> Vec<&'a str> {
    [&["sweep", "scenario.toml", "--out", out], arguments].concat()
}

#[track_caller]
fn table(folder: &Folder, out: &str, arguments: &[&str]) -> String {
    folder.succeeds(&sweep(out, arguments));
    assert!(!folder.has(&format!("{out}.part")));
    folder.read(out)
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
    let folder = Folder::of(SCENARIO);
    let text = table(&folder, "a.csv", &GRID);
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
    let folder = Folder::of(SCENARIO);
    let with = |more: &[&'static str]| [&GRID[..], &["--seeds", "3"], more].concat();
    let whole = table(&folder, "whole.csv", &with(&["--threads", "1"]));
    assert_eq!(table(&folder, "threads.csv", &with(&["--threads", "3"])), whole);
    let shard = |shard| table(&folder, "shard.csv", &with(&["--shard", shard]));
    let names = whole.lines().next().unwrap().to_owned() + "\n";
    let shards = ["1/5", "2/5", "3/5", "4/5", "5/5"];
    let shards: String = shards.map(|name| shard(name).strip_prefix(&names).unwrap().to_owned()).concat();
    assert_eq!(names + &shards, whole);
}

#[test]
fn a_sweep_that_was_killed_goes_on() {
    let folder = Folder::of(SCENARIO);
    let grid = ["--vary", "filters.*.process_std=0.1:10:400:log", "--seeds", "10", "--score", "nis", "--threads", "1"];
    let whole = table(&folder, "whole.csv", &grid);
    let part = folder.path("killed.csv.part");
    let rows = || std::fs::read(&part).map_or(0, |bytes| bytes.iter().filter(|&&byte| byte == b'\n').count());
    let mut child = folder.command(&sweep("killed.csv", &grid)).spawn().unwrap();
    while rows() < 50 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(1));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let before = rows();
    assert!(before >= 50 && !folder.has("killed.csv"), "killed in the middle: {before}");
    // A row is torn, as by a full disk.
    let bytes = std::fs::read(&part).unwrap();
    std::fs::write(&part, &bytes[..bytes.len() - 7]).unwrap();
    assert_eq!(table(&folder, "killed.csv", &grid), whole);
}

#[test]
fn two_programs_do_not_write_one_table() {
    let folder = Folder::of(SCENARIO);
    let held = File::create(folder.path("a.csv.part")).unwrap();
    held.lock().unwrap();
    let error = folder.refused(&sweep("a.csv", &GRID));
    assert!(error.contains("another program is writing this table") && !folder.has("a.csv"), "{error}");
    drop(held);
    assert_eq!(table(&folder, "a.csv", &GRID).lines().count(), 13);
}

#[test]
fn a_dash_is_standard_output_and_the_table_is_that_of_the_file() {
    let folder = Folder::of(SCENARIO);
    let whole = table(&folder, "a.csv", &GRID);
    let before = folder.names();
    for out in ["-", "/dev/stdout"] {
        let (code, text, error) = folder.fed(&[&["sweep", "-", "--out", out], &GRID[..]].concat(), SCENARIO.as_bytes());
        assert_eq!((code, text.as_str(), error.as_str()), (0, whole.as_str(), ""));
    }
    let shards = ["1/2", "2/2"].map(|shard| folder.succeeds(&sweep("-", &[&GRID[..], &["--shard", shard]].concat())).0);
    let heading = whole.lines().next().unwrap();
    assert_eq!(shards[0].clone() + shards[1].strip_prefix(heading).unwrap().trim_start(), whole);
    assert_eq!(folder.names(), before, "no part is left");
}
