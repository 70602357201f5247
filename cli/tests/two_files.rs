//! Two files with their own clocks are imported as one record.

use kalmanscope_core::{Channel, Force, Hold, Quantity, Scenario, Sensor, simulate};

use crate::{Folder, value};

/// The files of two loggers: the force in steps of 4 ms, and the displacement in steps of 15 ms, whose clock is 2.5 s behind.
fn loggers() -> [String; 2] {
    let force = Force::Chirp { amplitude: 3.0, from: 1.0, to: 20.0, sweep: 50.0 };
    let mut scenario = Scenario { dt: 0.001, duration: 50.0, hold: Hold::First, force, ..Scenario::default() };
    scenario.plant.set(Channel::NATURAL_FREQUENCY, 8.0);
    scenario.plant.set(Channel::DAMPING_RATIO, 0.04);
    scenario.sensors.clear();
    scenario.add_sensor(Sensor::new(Quantity::DISPLACEMENT, 0.001));
    let record = simulate(&scenario);
    let input = record.input().iter().enumerate().step_by(4);
    let input = input.map(|(k, value)| format!("{:.3},{value}\n", k as f64 * 0.001));
    let readings = record.measured(0).iter().enumerate().skip(3000).step_by(15);
    let readings = readings.map(|(k, value)| format!("{};{}\n", k as f64 - 2500.0, 1000.0 * value));
    [
        "t [s],force over mass [m/s²]\n".to_owned() + &input.collect::<String>(),
        "time [ms];displacement [mm]\n".to_owned() + &readings.collect::<String>(),
    ]
}

const IMPORT: [&str; 6] = ["import", "force.csv", "--with", "sensor.csv", "--joined", "both.csv"];

fn folder() -> Folder {
    let folder = Folder::new();
    let [force, sensor] = loggers();
    folder.file("force.csv", &force);
    folder.file("sensor.csv", &sensor);
    folder
}

#[test]
fn two_loggers_are_one_record() {
    let folder = folder();
    let (_, said) = folder.succeeds(&[&IMPORT[..], &["--out", "both.toml", "--offset", "2.5"]].concat());
    assert!(said.contains("s in common; each keeps its times"), "{said}");
    let (_, table, _) = folder.call(&["run", "both.toml"]);
    assert!((value(&table, "natural frequency") / 8.0 - 1.0).abs() < 0.003, "{table}");
}

#[test]
fn numbers_that_are_no_readings_are_not_moved_into_others() {
    let folder = folder();
    let sensor: String = folder
        .read("sensor.csv")
        .lines()
        .enumerate()
        .map(|(k, line)| match line.split_once(';') {
            Some((time, _)) if k > 0 && k % 40 == 0 => format!("{time};-9999\n"),
            _ => format!("{line}\n"),
        })
        .collect();
    folder.file("sensor.csv", &sensor);
    let (_, said) = folder.succeeds(&[&IMPORT[..], &["--offset", "2.5"]].concat());
    assert!(said.contains("-9999 in 78 cells of `displacement` counts as missing"), "{said}");
    let text = folder.read("both.csv");
    let readings = text.lines().skip(1).filter_map(|line| line.rsplit(',').next()?.parse::<f64>().ok());
    let largest = readings.map(f64::abs).fold(0.0, f64::max);
    assert!(largest > 10.0 && largest < 500.0, "{largest}");
}
