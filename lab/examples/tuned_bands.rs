//! How often the ±2σ of tuned R and Q hold the truth, over many records.
//!
//! ```text
//! cargo run --release -p kalmanscope-lab --example tuned_bands -- [SEEDS [FIRST]]
//! ```
//!
//! An oscillator is shaken by a force that is recorded and by one that is not; displacement and velocity are read with noise. A
//! KF that knows the plant, and an EKF that does not, are tuned from values that are off by factors of 2 to 3.

use std::sync::Arc;

use kalmanscope_core::{Axis, Channel, FilterKind, Scenario, Task as _, simulate};
use kalmanscope_lab::tune::{Goal, Tuner};
use kalmanscope_lab::{in_parts, processors};

fn main() {
    let mut numbers = std::env::args().skip(1).filter_map(|word| word.parse::<u64>().ok());
    let (seeds, first) = (numbers.next().unwrap_or(200), numbers.next().unwrap_or(1000));
    for kind in [FilterKind::KF, FilterKind::EKF] {
        let seeds: Vec<u64> = (first..first + seeds).collect();
        let all = in_parts(&seeds, processors(), 1, |seeds| seeds.iter().map(|seed| covered(kind, *seed)).collect());
        let known: Vec<[bool; 3]> = all.iter().flatten().copied().collect();
        println!("{}: of {} records {} have bands", kind.name(), all.len(), known.len());
        for (place, name) in NAMES.into_iter().enumerate() {
            let share = known.iter().filter(|inside| inside[place]).count() as f64 / known.len() as f64;
            println!("  truth inside ±2σ of {name}: {:.1} %", 100.0 * share);
        }
    }
}

const NAMES: [&str; 3] = ["σ of the displacement's noise", "σ of the velocity's noise", "σ of the process noise of v"];

fn covered(kind: FilterKind, seed: u64) -> Option<[bool; 3]> {
    let mut scenario = Scenario { seed, duration: 30.0, ..Scenario::default() };
    scenario.plant.set(Channel::NATURAL_FREQUENCY, kalmanscope_core::Signal::Constant(6.0));
    scenario.plant.disturbance_std = 3.0;
    scenario.filters.truncate(1);
    let (sensors, process) = scenario.true_noise();
    let truth = [sensors[0], sensors[1], process[Channel::VELOCITY]];
    let filter = &mut scenario.filters[0];
    (filter.kind, filter.fading) = (kind, 1.0);
    filter.sensor_std = vec![2.0 * truth[0], 0.5 * truth[1]];
    filter.process_std = process;
    filter.process_std[Channel::VELOCITY] = 3.0 * truth[2];
    if kind == FilterKind::KF {
        filter.initial_mean[Channel::NATURAL_FREQUENCY] = 6.0;
        filter.initial_mean[Channel::DAMPING_RATIO] = 0.05;
    }
    let axis = |key: &str, truth: f64| {
        Axis::parse(&format!("filters.*.{key}={}:{}:2:log", truth / 30.0, truth * 30.0)).expect("the axis is right")
    };
    let axes = vec![
        axis("sensor_std.displacement", truth[0]),
        axis("sensor_std.velocity", truth[1]),
        axis("process_std.velocity", truth[2]),
    ];
    let record = Arc::new(simulate(&scenario));
    let tuner = Tuner::new(scenario, 0, record, axes, Goal::Likelihood).expect("it can be tuned");
    let bands = tuner.run().bands?;
    Some([0, 1, 2].map(|place| (bands[place][0]..=bands[place][1]).contains(&truth[place])))
}
