//! Start values of forced records and of free decays.

use crate::excitation::Excitation;
use crate::ring_down::right;
use crate::start_values::{SENSORS, grid, shares, worst_of_losses};

/// Prints the shares of right guesses and ends over a grid of records.
pub(crate) fn print_grid() {
    let (all, parts) = grid(400..410, &[(9.0, 200.0), (2.3, 50.0), (35.0, 750.0)], true);
    for (name, counts) in parts.into_iter().chain([("all".to_owned(), all)]) {
        let [right, ends] = shares(counts);
        println!("{name}: {right:.1} % of the guesses and {ends:.1} % of the ends of {} are right", counts[2]);
    }
}

/// Prints the largest change of a start value by lost readings.
pub(crate) fn print_losses() {
    for excitation in Excitation::ALL {
        for sensor in SENSORS {
            let all =
                (200..204).map(|seed| worst_of_losses(sensor, excitation, [0.005, 0.02, 0.1][seed as usize % 3], seed));
            let worst = all.max_by(|a, b| a.0.total_cmp(&b.0)).expect("there are four");
            println!("{excitation:?} {}: {:.1} %, {}", sensor.key(), 100.0 * worst.0, worst.1);
        }
    }
}

/// Prints the share of free decays with right start values.
pub(crate) fn print_decays() {
    println!("{:.1} % of the start values are right", 100.0 * right(5000..5600));
}
