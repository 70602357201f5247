//! The posterior of a filter's parameters.

use crate::Folder;

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
