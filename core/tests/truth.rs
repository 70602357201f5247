//! The simulator against independent solutions, among them scipy's `lsim` for an input that is linear between samples.

use kalmanscope_core::signal::{Ramp, Sine, Step};
use kalmanscope_core::{Channel, Force, Hold, PlantKind, Quantity, Record, Run, Scenario, Sensor, Signal, TruthError};
use nalgebra::Vector2;

use crate::numbers::{largest, mean, rms, transition};
use crate::oracles::truths::deviation;
use crate::run::{finished, oscillator, simulated, truth};

const SDOF: [Channel; 4] =
    [Channel::DISPLACEMENT, Channel::VELOCITY, Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO];

fn steady(wn: f64, zeta: f64, force: Force) -> Scenario {
    Scenario { duration: 20.0, force, plant: oscillator(wn, zeta), ..Scenario::default() }
}

#[test]
fn free_vibration_is_the_closed_form() {
    for (wn, zeta) in [(6.0, 0.05), (6.0, 0.0), (40.0, 0.3), (0.5, 0.9)] {
        let mut scenario = steady(wn, zeta, Force::None);
        scenario.plant.initial.displacement = 0.5;
        scenario.plant.initial.velocity = -1.5;
        let record = simulated(&scenario);
        for k in 0..record.len() {
            let [x, v]: [f64; 2] = (transition([wn, zeta], record.time(k)) * Vector2::new(0.5, -1.5)).into();
            let size = 0.5 + 1.5 / wn;
            assert!((truth(&record, Channel::DISPLACEMENT)[k] - x).abs() < 1e-11 * size, "x at {k} of {wn}, {zeta}");
            assert!((truth(&record, Channel::VELOCITY)[k] - v).abs() < 1e-11 * size * wn, "v at {k} of {wn}, {zeta}");
        }
    }
}

fn time_varying() -> Scenario {
    let mut scenario = steady(6.0, 0.05, Force::WhiteNoise { std: 10.0 });
    scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Sine(Sine { mean: 6.0, amplitude: 2.0, period: 7.0 }));
    scenario.plant.set(Channel::DAMPING_RATIO, Signal::Ramp(Ramp { from: 0.02, to: 0.3, start: 3.0, end: 15.0 }));
    scenario
}

/// Without a disturbance.
fn acceleration(record: &Record, k: usize) -> f64 {
    let [x, v, wn, zeta] = SDOF.map(|channel| truth(record, channel)[k]);
    record.force(k) - 2.0 * zeta * wn * v - wn * wn * x
}

#[test]
fn the_disturbance_pushes_the_mass_and_is_felt_by_the_accelerometer() {
    let mut scenario = time_varying();
    scenario.sensors = vec![Sensor::new(Quantity::ACCELERATION, 0.0)];
    scenario.plant.disturbance_std = 2.0;
    let record = simulated(&scenario);
    let felt: Vec<f64> = (0..record.len()).map(|k| record.measured(0)[k] - acceleration(&record, k)).collect();
    let std = rms(&felt);
    assert!((std - 2.0).abs() < 0.2, "std {std}");
    assert!(deviation(&record, &felt) < 1e-9);
}

#[test]
fn each_sensor_has_its_noise() {
    let mut scenario = Scenario { duration: 200.0, ..steady(6.0, 0.05, Force::WhiteNoise { std: 10.0 }) };
    scenario.add_sensor(Sensor::new(Quantity::ACCELERATION, 0.7));
    let record = simulated(&scenario);
    let mut noise: Vec<Vec<f64>> = Vec::new();
    for (i, sensor) in scenario.sensors.iter().enumerate() {
        let of_state = sensor.measures.channel().and_then(|channel| record.truth(channel));
        let clean = |k: usize| of_state.map_or_else(|| acceleration(&record, k), |truth| truth[k]);
        let errors: Vec<f64> = (0..record.len()).map(|k| record.measured(i)[k] - clean(k)).collect();
        let (n, mean, std) = (errors.len() as f64, mean(&errors), rms(&errors));
        assert!(mean.abs() < 4.0 * sensor.noise_std / n.sqrt(), "mean {mean}");
        assert!((std / sensor.noise_std - 1.0).abs() < 4.0 / (2.0 * n).sqrt(), "std {std}");
        noise.push(errors);
    }
    assert_eq!(noise.len(), 3);
    for (a, b) in [(0, 1), (0, 2), (1, 2)] {
        let covariance: f64 = noise[a].iter().zip(&noise[b]).map(|(a, b)| a * b).sum::<f64>() / record.len() as f64;
        let correlation = covariance / (scenario.sensors[a].noise_std * scenario.sensors[b].noise_std);
        assert!(correlation.abs() < 0.03, "{a} and {b}: {correlation}");
    }
}

#[test]
fn a_new_sensor_leaves_all_else_to_the_bit() {
    let mut scenario = time_varying();
    scenario.plant.disturbance_std = 1.0;
    let before = simulated(&scenario);
    scenario.add_sensor(Sensor::new(Quantity::ACCELERATION, 0.7));
    let after = simulated(&scenario);
    assert_eq!(after.sensors().len(), before.sensors().len() + 1);
    assert_eq!(before.input(), after.input());
    for quantity in [Quantity::DISPLACEMENT, Quantity::VELOCITY] {
        assert!(before.measured_quantity(quantity).is_some());
        assert_eq!(before.measured_quantity(quantity), after.measured_quantity(quantity));
    }
    for channel in SDOF {
        assert_eq!(truth(&before, channel), truth(&after, channel));
    }
}

#[test]
fn seeds_differ_in_force_and_noise() {
    let scenario = time_varying();
    let (a, b) = (simulated(&scenario), simulated(&Scenario { seed: 2, ..scenario.clone() }));
    let mut other = scenario.clone();
    other.filters[0].fading = 1.5;
    other.filters.pop();
    assert_eq!((&a, finished(&other).record()), (&simulated(&scenario), &a), "filters do not touch the record");
    assert!((0..a.len()).all(|k| a.force(k) != b.force(k) && a.measured(0)[k] != b.measured(0)[k]));
}

#[test]
fn parameters_follow_their_signals() {
    let signals = [
        Signal::Constant(6.0),
        Signal::Step(Step { from: 6.0, to: 4.8, at: 10.0 }),
        Signal::Ramp(Ramp { from: 6.0, to: 5.0, start: 4.0, end: 9.0 }),
        Signal::Sine(Sine { mean: 6.0, amplitude: 1.0, period: 5.0 }),
    ];
    for signal in signals {
        let mut scenario = time_varying();
        scenario.plant.set(Channel::NATURAL_FREQUENCY, signal);
        scenario.plant.set(Channel::DAMPING_RATIO, signal);
        let record = simulated(&scenario);
        for k in 0..record.len() {
            let expected = signal.at(record.time(k));
            assert_eq!(truth(&record, Channel::NATURAL_FREQUENCY)[k], expected);
            assert_eq!(truth(&record, Channel::DAMPING_RATIO)[k], expected);
        }
    }
}

#[test]
fn a_step_of_force_begins_at_its_time() {
    let record = simulated(&steady(6.0, 0.05, Force::Step { amplitude: 3.0, at: 2.0 }));
    assert!((0..record.len()).all(|k| record.force(k) == if k < 200 { 0.0 } else { 3.0 }));
    assert!(deviation(&record, &[]) < 1e-9);
}

#[test]
fn a_plant_too_fast_for_its_step_does_not_count_as_diverging() {
    let mut scenario = Scenario { dt: 5.0, duration: 500.0, force: Force::None, ..Scenario::default() };
    scenario.set_plant(PlantKind::DUFFING);
    scenario.plant.set(Channel::NATURAL_FREQUENCY, 6.0);
    scenario.plant.set(Channel::DAMPING_RATIO, 0.0);
    scenario.plant.set(Channel::CUBIC_STIFFNESS, 300.0);
    (scenario.plant.initial.displacement, scenario.plant.initial.velocity) = (0.3, 1.0);
    // The energy bounds the motion, so it cannot diverge; but forty radians per step need more halvings than are allowed.
    let run = finished(&scenario);
    let energy = |k: usize| {
        let [x, v] = [Channel::DISPLACEMENT, Channel::VELOCITY].map(|c| truth(run.record(), c)[k]);
        0.5 * v * v + 18.0 * x * x + 75.0 * x * x * x * x
    };
    assert!((0..run.record().len()).all(|k| (energy(k) / energy(0) - 1.0).abs() < 1e-6), "energy is kept");
    if let Some(stop) = run.truth_stop() {
        assert_eq!(stop.reason, TruthError::StepTooLong);
    }
    scenario.dt = 50.0;
    scenario.duration = 5000.0;
    let run = finished(&scenario);
    assert_eq!(run.truth_stop().map(|stop| stop.reason), Some(TruthError::StepTooLong));
}

fn rows(text: &str) -> Vec<Vec<f64>> {
    let row = |line: &str| line.split(',').map(|cell| cell.trim().parse().unwrap()).collect();
    text.lines().filter(|line| !line.starts_with('#')).map(row).collect()
}

fn response(kind: PlantKind, dt: f64, hold: Hold) -> Run {
    let force = Force::Chirp { amplitude: 3.0, from: 1.0, to: 25.0, sweep: 10.0 };
    let mut scenario = Scenario { dt, duration: 199.0 * dt, force, hold, filters: vec![], ..Scenario::default() };
    scenario.set_plant(kind);
    scenario.plant.set(Channel::NATURAL_FREQUENCY, 6.0);
    scenario.plant.set(Channel::CUBIC_STIFFNESS, 0.0);
    finished(&scenario)
}

fn from_lsim(run: &Run, kind: &PlantKind, reference: &[Vec<f64>]) -> f64 {
    let mut worst = 0.0_f64;
    for (place, &channel) in kind.channels()[..kind.motion()].iter().enumerate() {
        let truth = truth(run.record(), channel);
        assert_eq!(truth.len(), reference.len());
        let size = reference.iter().map(|row| row[2 + place].abs()).fold(0.0, f64::max);
        for (found, row) in truth.iter().zip(reference) {
            worst = worst.max((found - row[2 + place]).abs() / size);
        }
    }
    worst
}

#[test]
fn a_linear_plant_answers_a_piecewise_linear_input_as_lsim_says() {
    for (kind, dt, text) in [
        (PlantKind::SDOF, 0.05, include_str!("data/first-order-hold-sdof.csv")),
        (PlantKind::SHEAR_5, 0.02, include_str!("data/first-order-hold-shear_5.csv")),
    ] {
        let reference = rows(text);
        let run = response(kind.clone(), dt, Hold::First);
        for (found, row) in run.record().input().iter().zip(&reference) {
            assert!((found - row[1]).abs() < 1e-12, "the force itself");
        }
        let error = from_lsim(&run, &kind, &reference);
        assert!(error < 1e-9, "{kind:?}: {error}");
        // The same input with a zero-order hold gives another response.
        assert!(from_lsim(&response(kind.clone(), dt, Hold::Zero), &kind, &reference) > 1e-2, "{kind:?}");
    }
}

#[test]
fn a_plant_with_hardly_any_cubic_stiffness_answers_like_a_linear_one() {
    let linear = response(PlantKind::SDOF, 0.05, Hold::First);
    let run = response(PlantKind::DUFFING, 0.05, Hold::First);
    let [x, reference] = [&run, &linear].map(|run| truth(run.record(), Channel::DISPLACEMENT));
    let is_near = |(a, b): (&f64, &f64)| (a - b).abs() < 1e-9 * largest(reference);
    assert!(x.iter().zip(reference).all(is_near), "Runge-Kutta steps against the exact response");
}

#[test]
fn values_at_and_around_the_changes() {
    let step = Signal::Step(Step { from: 6.0, to: 4.8, at: 30.0 });
    assert_eq!([step.at(0.0), step.at(29.99), step.at(30.0)], [6.0, 6.0, 4.8]);
    let ramp = Signal::Ramp(Ramp { from: 1.0, to: 3.0, start: 10.0, end: 20.0 });
    assert_eq!([ramp.at(9.0), ramp.at(10.0), ramp.at(15.0), ramp.at(20.0), ramp.at(99.0)], [1.0, 1.0, 2.0, 3.0, 3.0]);
    let sudden = Signal::Ramp(Ramp { from: 1.0, to: 3.0, start: 10.0, end: 10.0 });
    assert_eq!([sudden.at(9.9), sudden.at(10.0)], [1.0, 3.0]);
    let sine = Signal::Sine(Sine { mean: 6.0, amplitude: 0.5, period: 8.0 });
    assert!((sine.at(2.0) - 6.5).abs() < 1e-15 && (sine.at(6.0) - 5.5).abs() < 1e-15);
    assert_eq!(sine.minimum(), 5.5);
}
