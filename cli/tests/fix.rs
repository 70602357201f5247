//! `run --fix`: the scenario with a remedy.

use crate::Folder;

/// Two faults: a gain, and an R that is too small; beside a filter that is right but for the gain, with a longer table in one line.
const WRONG: &str = "seed = 11\ndt = 0.01\nduration = 30.0\nforce = { white_noise = { std = 10.0 } }\n\
    [plant]\nnatural_frequency = 6.0\ndamping_ratio = 0.04\ndisturbance_std = 1.0\ninput_gain = 1.5\n\
    [[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.005\n[[sensors]]\nmeasures = \"velocity\"\nnoise_std = 0.03\n\
    [[filters]]\nname = \"first\"\nkind = \"ekf\"\nsensor_std = [0.0022, 0.0134]\n\
    initial_mean = { natural_frequency = 6.4, damping_ratio = 0.05 }\n\
    initial_std = { natural_frequency = 0.6, damping_ratio = 0.02 }\n\
    process_std = { displacement = 1e-7, velocity = 0.01, natural_frequency = 6e-5, damping_ratio = 4e-7 }\n";

/// The verdict of the only filter in a table, and the first printed remedy.
fn verdict(table: &str) -> &str {
    let (_, rest) = table.split_once("\nfirst (EKF)\n").unwrap();
    rest.lines().next().unwrap().trim().split(':').next().unwrap()
}

#[test]
fn the_repaired_scenario_runs_and_has_the_promised_verdict() {
    let folder = Folder::new();
    folder.file("wrong.toml", WRONG);
    let (before, _) = folder.succeeds(&["run", "wrong.toml"]);
    assert_eq!(verdict(&before), "overconfident", "{before}");
    let cause = before.lines().find(|line| line.starts_with("  cause 1 (")).unwrap();
    assert!(cause.contains("the gain of the input: ") && cause.contains("; and then R of a sensor: "), "{cause}");
    assert!(!before.contains("none of these causes explains it"), "{before}");

    let (then, command) = before.split_once("try it (then ").unwrap().1.split_once("): kalmanscope-cli ").unwrap();
    let command: Vec<&str> = command.lines().next().unwrap().split(' ').collect();
    assert_eq!(command, ["run", "wrong.toml", "--fix", "1", "--out", "fixed.toml"]);
    let (same, said) = folder.succeeds(&command);
    assert_eq!(same, before);
    assert_eq!(said, format!("first: wrote the remedy for the gain of the input and R of a sensor; then {then}\n"));
    let (after, _) = folder.succeeds(&["run", "fixed.toml"]);
    assert!(verdict(&after) == then && then.starts_with("consistent"), "{then}: {after}");
}

#[test]
fn a_record_is_found_from_where_the_repaired_scenario_is() {
    let folder = Folder::new();
    folder.file("wrong.toml", WRONG);
    std::fs::create_dir(folder.path("other")).unwrap();
    folder.succeeds(&["run", "wrong.toml", "--record-out", "record.csv", "--quiet"]);
    let mapped = format!("{WRONG}[record]\nfile = \"record.csv\"\n");
    folder.file("measured.toml", &mapped);
    folder.succeeds(&["run", "measured.toml", "--fix", "1", "--out", "other/fixed.toml", "--quiet"]);
    let (after, _) = folder.succeeds(&["run", "other/fixed.toml"]);
    assert!(verdict(&after).starts_with("consistent"), "{after}");
}
