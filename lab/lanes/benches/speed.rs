//! Nanoseconds per step and lane of filters side by side, beside the single filter without history, in one run.
//!
//! ```text
//! cargo bench -p kalmanscope-lanes
//! ```
//!
//! Every number has NIS, NEES, likelihood and the errors of all channels in it. Measurements take turns, and the least of many
//! counts: whatever else the machine does only adds.

use std::hint::black_box;
use std::time::Instant;

use kalmanscope_core::record::{Clocks, Timed};
use kalmanscope_core::score::Outcome;
use kalmanscope_core::simulate;
use kalmanscope_core::{Channel, PlantKind, Quantity, Record, Scenario};
use kalmanscope_lanes::{LaneRun, Level, outcomes_with};

/// Runs at a time, and samples of a record.
const RUNS: usize = 64;
const SAMPLES: usize = 2001;

/// Runs side by side in one measurement.
const PART: usize = 8;

/// Measurements of each number.
const REPEATS: usize = 400;

fn main() {
    println!("{:<44}{:>10}{:>10}{:>8}", "case", "level", "ns/step", "share");
    let base = Scenario { duration: (SAMPLES - 1) as f64 * 0.01, ..Scenario::default() };
    for (place, name) in [(0, "EKF"), (1, "UKF")] {
        let of = |change: &dyn Fn(&mut Scenario)| {
            let mut scenario = Scenario { filters: vec![base.filters[place].clone()], ..base.clone() };
            change(&mut scenario);
            guesses(&scenario)
        };
        let one = |scenario: &Scenario| vec![simulated(scenario, 1)];
        let report = |what: &str, scenarios: &[Scenario], records: &[Record]| {
            measure(&format!("{name}, {what}"), scenarios, records);
        };
        let usual = of(&|_| {});
        report("displacement and velocity", &usual, &one(&base));
        let own: Vec<Record> = (0..RUNS as u64).map(|seed| simulated(&base, seed)).collect();
        report("a record a lane", &usual, &own);
        let unknown = one(&base)[0].clone().without_truth();
        report("truth unknown", &usual, &[unknown]);
        report("readings at times of their own", &usual, &[with_own_times(one(&base).remove(0))]);
        let displacement = of(&|scenario| scenario.remove_sensor(Quantity::VELOCITY));
        report("displacement", &displacement, &one(&base));
        let decaying = of(&|scenario| scenario.filters[0].eta = 0.01);
        report("parameters that decay", &decaying, &one(&base));
        let accelerated = of(&|scenario| {
            *scenario = Scenario { sensors: vec![], ..scenario.clone() };
            scenario.filters[0].sensor_std.clear();
            let measures = Quantity::ACCELERATION;
            scenario.add_sensor(kalmanscope_core::Sensor::new(measures, 0.1));
        });
        report("acceleration", &accelerated, &one(&accelerated[0]));
        let cubic = |scenario: &mut Scenario| scenario.set_plant(PlantKind::DUFFING);
        let duffing = of(&cubic);
        report("Duffing", &duffing, &one(&duffing[0]));
        let decaying = of(&|scenario| {
            cubic(scenario);
            scenario.filters[0].eta = 0.01;
        });
        report("Duffing, parameters that decay", &decaying, &one(&decaying[0]));
    }
}

/// The scenario with guesses of the natural frequency from 2 to 6.9 rad/s.
fn guesses(scenario: &Scenario) -> Vec<Scenario> {
    let guess = |i: usize| {
        let mut scenario = scenario.clone();
        scenario.filters[0].initial_mean[Channel::NATURAL_FREQUENCY] = 2.0 + 4.9 * i as f64 / RUNS as f64;
        scenario
    };
    (0..RUNS).map(guess).collect()
}

fn simulated(scenario: &Scenario, seed: u64) -> Record {
    simulate(&Scenario { seed, ..scenario.clone() })
}

/// The record with each reading up to half a step early or late.
fn with_own_times(record: Record) -> Record {
    let moved = |k: usize, column: usize| k as f64 + 0.45 * ((7 * k + column) as f64).sin();
    let reading = |column: usize| Timed {
        times: (1..record.len()).map(|k| moved(k, column)).collect(),
        values: record.measured(column)[1..].to_vec(),
    };
    let readings = (0..record.sensors().len()).map(reading).collect();
    record.with_clocks(Clocks { input: None, readings }).expect("the times rise")
}

/// Prints a line for the single filter and one for each instruction set.
fn measure(case: &str, scenarios: &[Scenario], records: &[Record]) {
    let run = |(i, scenario)| LaneRun { scenario, place: 0, record: &records[i % records.len()] };
    let runs: Vec<LaneRun<'_>> = scenarios.iter().enumerate().map(run).collect();
    let levels = Level::available();
    let mut least = vec![f64::INFINITY; levels.len() + 1];
    for repeat in 0..REPEATS {
        // Short pieces: the machine does not interrupt all of them.
        let part = &runs[repeat * PART % RUNS..][..PART];
        let one = &part[repeat / PART % PART];
        let single = time(|| Outcome::of(one.scenario, one.place, one.record));
        least[0] = least[0].min(single / SAMPLES as f64);
        for (place, &level) in levels.iter().enumerate() {
            let abreast = time(|| outcomes_with(level, part, &[]));
            least[place + 1] = least[place + 1].min(abreast / (PART * SAMPLES) as f64);
        }
    }
    println!("{case:<44}{:>10}{:>10.1}{:>8.2}", "single", least[0], 1.0);
    for (level, ns) in levels.iter().zip(&least[1..]) {
        println!("{:<44}{:>10}{ns:>10.1}{:>8.2}", "", format!("{level:?}"), ns / least[0]);
    }
}

/// Nanoseconds that some work takes.
fn time<R>(work: impl FnOnce() -> R) -> f64 {
    let start = Instant::now();
    black_box(work());
    start.elapsed().as_secs_f64() * 1e9
}
