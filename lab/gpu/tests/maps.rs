//! Maps by the graphics processor have the classes and, where filters converge, the scores of the processor's.

mod common;

use common::{compare, map, scenario};

fn tuning(kind: &str, side: usize) -> [String; 2] {
    [
        format!("filters.{kind}.process_std=0.01:100:{side}:log"),
        format!("filters.{kind}.sensor_std=0.05:20:{side}:log"),
    ]
}

fn guesses(kind: &str, side: usize) -> [String; 2] {
    [
        format!("filters.{kind}.initial_mean.natural_frequency=0.5:40:{side}"),
        format!("filters.{kind}.initial_std.natural_frequency=0.1:20:{side}:log"),
    ]
}

#[test]
#[ignore = "explore"]
fn explore() {
    let side: usize = std::env::var("SIDE").map_or(32, |side| side.parse().unwrap());
    let samples: usize = std::env::var("SAMPLES").map_or(2000, |side| side.parse().unwrap());
    for kind in ["EKF", "UKF"] {
        for axes in [tuning(kind, side), guesses(kind, side)] {
            let comparison = compare(&map(scenario(kind, samples), &axes));
            println!("{kind} {}: same {:.4} close {:.4}\n   {comparison:?}", axes[0], comparison.same_share(), comparison.close_share());
        }
    }
}
