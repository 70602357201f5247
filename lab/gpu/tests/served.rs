//! The table of the crate's README says what the graphics processor serves.

use kalmanscope_core::{Scenario, simulate};
use kalmanscope_gpu::{GpuRun, serves};

#[test]
fn the_table_says_what_is_served() {
    let rows = include_str!("../README.md").lines().filter_map(|line| {
        let (_, rest) = line.strip_prefix("| ")?.split_once(" | `")?;
        rest.strip_suffix(" |")?.split_once("` | ")
    });
    let mut counts = [0; 2];
    for (text, expected) in rows {
        let scenario =
            Scenario::from_toml(&format!("duration = 1.0\n{text}")).unwrap_or_else(|e| panic!("{text}: {e}"));
        let record = simulate(&scenario);
        let is_served = serves(&GpuRun { scenario: &scenario, place: 0, record: &record });
        assert_eq!(if is_served { "yes" } else { "no" }, expected, "{text}");
        counts[usize::from(is_served)] += 1;
    }
    assert!(counts.iter().all(|count| *count >= 9), "{counts:?}");
}
