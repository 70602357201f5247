//! The posterior of a filter's parameters by the built command.

use crate::program;

const SCENARIO: &str = "duration = 4.0\n[plant]\nnatural_frequency = 6.0\n[[sensors]]\nmeasures = \"displacement\"\n\
                        noise_std = 0.01\n[[filters]]\nname = \"one\"\nkind = \"ekf\"\n[[filters]]\nname = \"other\"\nkind = \"ukf\"\n\
                        robust = \"huber\"\n";

fn posterior(arguments: &[&str]) -> (i32, String, String) {
    let folder = tempfile::tempdir().unwrap();
    let scenario = folder.path().join("scenario.toml");
    std::fs::write(&scenario, SCENARIO).unwrap();
    let output = program().arg("posterior").arg(scenario).args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

#[test]
fn points_are_written_and_told_beside_the_filter() {
    let (code, table, told) = posterior(&["--out", "-"]);
    assert_eq!(code, 0, "{told}");
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("natural_frequency,damping_ratio"));
    let frequencies: Vec<f64> = lines.map(|line| line.split(',').next().unwrap().parse().unwrap()).collect();
    assert!(frequencies.len() >= 128 && frequencies.iter().all(|frequency| (5.5..6.5).contains(frequency)));
    assert!(told.contains(&format!("{} points of the posterior", frequencies.len())), "{told}");
    assert!(told.contains("natural_frequency: ") && told.contains(" times as wide"), "{told}");
    assert!(!told.contains("two solutions"), "{told}");
}

#[test]
fn what_has_no_posterior_says_why() {
    for (arguments, reason) in [
        (&["--filter", "other"][..], "there is no posterior: the filter weighs its readings"),
        (&["--filter", "third"], "the scenario has no filter `third`"),
    ] {
        let (code, _, told) = posterior(arguments);
        assert_eq!(code, 2);
        assert!(told.contains(reason), "{told}");
    }
}
