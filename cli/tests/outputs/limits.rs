//! Limits of threads and memory.

use std::process::Command;

use super::folder::{Folder, SCENARIO, read};

#[test]
fn many_threads_are_cut_to_the_work() {
    let folder = Folder::new();
    folder.file("scenario.toml", SCENARIO);
    let sweep = ["sweep", "scenario.toml", "--vary", "filters.one.fading=1:1.1:3", "--out", "t.csv"];
    let (code, _, error) = folder.call(&[&sweep[..], &["--threads", "100000000"]].concat(), b"");
    assert_eq!((code, read(&folder.path("t.csv")).lines().count()), (0, 4), "{error}");
}

/// 100,000 samples of eight filters have 380 MB of histories.
#[cfg(target_os = "linux")]
#[test]
fn a_long_run_without_outputs_of_its_history_needs_little_memory() {
    let folder = Folder::new();
    let filter = "[[filters]]\nfading = 1.0\n";
    folder.file("long.toml", &format!("duration = 1000.0\n[plant]\nnatural_frequency = 6.0\n{}", filter.repeat(8)));
    // The address space is limited to 260 MB.
    let limited = format!("ulimit -v 260000; exec '{}' run long.toml --json", env!("CARGO_BIN_EXE_kalmanscope-cli"));
    let output = Command::new("sh").args(["-c", &limited]).current_dir(folder.0.path()).output().unwrap();
    let (out, error) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
    assert!(output.status.code() == Some(0) && out.contains("EKF 8"), "{:?} {error}", output.status);
}
