//! The commands about one filter: its tuning, and the posterior of its parameters.

use kalmanscope_core::Scenario;

use crate::Folder;

/// A filter that takes its sensor for five times as noisy as it is.
const SCENARIO: &str = "duration = 20.0\n[plant]\nnatural_frequency = 6.0\n[[sensors]]\nmeasures = \"displacement\"\n\
                        noise_std = 0.01\n[[filters]]\nkind = \"ekf\"\nsensor_std = [0.05]\n[filters.initial_mean]\n\
                        natural_frequency = 6.5\n";

#[test]
fn the_noise_of_a_sensor_is_found_and_written() {
    let folder = Folder::of(SCENARIO);
    let turn = "filters.EKF.sensor_std.displacement";
    let (text, _) = folder.succeeds(&["tune", "scenario.toml", "--turn", turn, "--out", "tuned.toml"]);
    assert!(
        text.starts_with("log likelihood: ") && text.contains(turn) && text.contains("verdict: consistent"),
        "{text}"
    );
    let tuned = Scenario::from_toml(&folder.read("tuned.toml")).unwrap();
    let std = tuned.filters[0].sensor_std[0];
    assert!((std / 0.01 - 1.0).abs() < 0.05, "{std}");
    assert!(text.contains(", ±2σ from 0.009") && text.contains(" to 0.010"), "{text}");
}

/// A filter, and one that weighs its readings.
const TWO: &str = "duration = 4.0\n[plant]\nnatural_frequency = 6.0\n[[sensors]]\nmeasures = \"displacement\"\n\
                        noise_std = 0.01\n[[filters]]\nname = \"one\"\nkind = \"ekf\"\n[[filters]]\nname = \"other\"\nkind = \"ukf\"\n\
                        robust = \"huber\"\n";

#[test]
fn points_are_written_and_compared_with_the_filter() {
    let (table, text) = Folder::of(TWO).succeeds(&["posterior", "scenario.toml", "--out", "-"]);
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("natural_frequency,damping_ratio"));
    let frequencies: Vec<f64> = lines.map(|line| line.split(',').next().unwrap().parse().unwrap()).collect();
    assert!(frequencies.len() >= 128 && frequencies.iter().all(|frequency| (5.5..6.5).contains(frequency)));
    assert!(text.contains(&format!("{} points of the posterior", frequencies.len())), "{text}");
    assert!(text.contains("natural frequency: ") && text.contains(" times as wide"), "{text}");
    assert!(!text.contains("two solutions"), "{text}");
}
