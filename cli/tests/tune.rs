//! Tuning by the built command.

use std::path::Path;
use std::process::Output;

use kalmanscope_core::Scenario;

use crate::program;

/// A filter that takes its sensor for five times as noisy as it is.
const SCENARIO: &str = "duration = 20.0\n[plant]\nnatural_frequency = 6.0\n[[sensors]]\nmeasures = \"displacement\"\n\
                        noise_std = 0.01\n[[filters]]\nkind = \"ekf\"\nsensor_std = [0.05]\n[filters.initial_mean]\n\
                        natural_frequency = 6.5\n";

fn tune(folder: &Path, arguments: &[&str]) -> Output {
    let scenario = folder.join("scenario.toml");
    std::fs::write(&scenario, SCENARIO).unwrap();
    let mut command = program();
    command.arg("tune").arg(scenario).args(arguments).output().unwrap()
}

#[test]
fn the_noise_of_a_sensor_is_found_and_written() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("tuned.toml");
    let turn = "filters.EKF.sensor_std.displacement";
    let output = tune(folder.path(), &["--turn", turn, "--out", out.to_str().unwrap()]);
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(
        text.starts_with("log likelihood: ") && text.contains(turn) && text.contains("verdict: consistent"),
        "{text}"
    );
    let tuned = Scenario::from_toml(&std::fs::read_to_string(out).unwrap()).unwrap();
    let std = tuned.filters[0].sensor_std[0];
    assert!((std / 0.01 - 1.0).abs() < 0.05, "{std}");
    assert!(text.contains(", ±2σ from 9.") && text.contains(" to 1.0"), "{text}");
}

#[test]
fn wrong_arguments_are_refused_in_a_sentence() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, message) in [
        (&["--turn", "filters.EKF.mass"][..], "the scenario has no number `filters.EKF.mass` to vary"),
        (&["--turn", "filters.EKF.fading=1"], "is not a range"),
        (&["--turn", "plant.damping_ratio=0:1"], "only settings of filters can be varied"),
        (&["--turn", "filters.EKF.fading", "--filter", "UKF"], "the scenario has no filter `UKF`"),
        (&["--turn", "filters.EKF.fading", "--goal", "speed"], "expected likelihood, consistency or free_run.SENSOR"),
        (&[], "--turn"),
    ] {
        let output = tune(folder.path(), arguments);
        let text = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{text}");
        assert!(text.contains(message), "{text}");
    }
}
