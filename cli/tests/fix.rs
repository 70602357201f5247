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
    let (code, before, _) = folder.call(&["run", "wrong.toml", "--verbose"]);
    assert_eq!((code, verdict(&before)), (0, "overconfident"), "{before}");
    let cause = before.lines().find(|line| line.starts_with("  cause 1: ")).unwrap();
    assert!(cause.contains("the gain of the input: ") && cause.contains("; and then R of a sensor: "), "{cause}");
    assert!(before.contains("    or have it written: kalmanscope-cli run ... --fix 1 --out FIXED.toml\n"), "{before}");
    assert!(!before.contains("none of these causes explains it"), "{before}");

    let (code, same, said) = folder.call(&["run", "wrong.toml", "--fix", "1", "--out", "fixed.toml"]);
    assert_eq!(code, 0, "{said}");
    assert_eq!(verdict(&same), "overconfident");
    let promised = said.trim_end().rsplit_once(", then ").unwrap().1;
    assert!(
        said.starts_with("first: the remedy against the gain of the input and then R of a sensor is written, then "),
        "{said}"
    );
    let (code, after, _) = folder.call(&["run", "fixed.toml"]);
    assert_eq!((code, verdict(&after)), (0, promised), "{after}");
    assert!(promised.starts_with("consistent"), "{promised}");

    // The lines that are printed do the same, each in its place.
    let (mut by_hand, mut is_first) = (WRONG.to_owned(), false);
    for line in before.lines() {
        is_first = (is_first || line.starts_with("  cause 1: ")) && !line.starts_with("  cause 2: ");
        let Some(setting) = line.strip_prefix("    write in its [[filters]]: ").filter(|_| is_first) else { continue };
        let key = setting.split(" = ").next().unwrap();
        let kept: Vec<&str> = by_hand.lines().filter(|old| !old.starts_with(&format!("{key} = "))).collect();
        by_hand = format!("{}\n{setting}\n", kept.join("\n"));
    }
    folder.file("by-hand.toml", &by_hand);
    let (code, after, error) = folder.call(&["run", "by-hand.toml"]);
    assert_eq!((code, verdict(&after)), (0, promised), "{by_hand}\n{error}");
}

#[test]
fn a_record_is_found_from_where_the_repaired_scenario_is() {
    let folder = Folder::new();
    folder.file("wrong.toml", WRONG);
    std::fs::create_dir(folder.path("other")).unwrap();
    assert_eq!(folder.call(&["run", "wrong.toml", "--record-out", "record.csv", "--quiet"]).0, 0);
    let mapped = format!("{WRONG}[record]\nfile = \"record.csv\"\n");
    folder.file("measured.toml", &mapped);
    let (code, _, said) = folder.call(&["run", "measured.toml", "--fix", "1", "--out", "other/fixed.toml", "--quiet"]);
    assert_eq!(code, 0, "{said}");
    let (code, after, error) = folder.call(&["run", "other/fixed.toml"]);
    assert_eq!(code, 0, "{error}");
    assert!(verdict(&after).starts_with("consistent"), "{after}");
}

#[test]
fn what_cannot_be_fixed_is_said_and_nothing_is_written() {
    let folder = Folder::new();
    folder.file("wrong.toml", WRONG);
    let right = WRONG.replace("input_gain = 1.5\n", "").replace("sensor_std = [0.0022, 0.0134]\n", "");
    folder.file("right.toml", &right);
    for (arguments, reason) in [
        (&["run", "right.toml", "--fix", "1", "--out", "fixed.toml"][..], "there is nothing to fix"),
        (&["run", "wrong.toml", "--fix", "99", "--out", "fixed.toml"], "--fix 99: first has remedies 1 to "),
        (&["run", "wrong.toml", "--fix", "1"], "--out"),
    ] {
        let error = folder.refused(arguments);
        assert!(error.contains(reason) && !folder.has("fixed.toml"), "{error}");
    }
    let (_, before, _) = folder.call(&["run", "wrong.toml"]);
    assert_eq!(folder.read("wrong.toml"), WRONG);
    assert!(before.contains("cause 1"), "{before}");
}
