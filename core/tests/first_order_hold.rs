//! The response to an input that is linear between samples, against scipy's `lsim`.

use kalmanscope_core::{Channel, Force, Hold, PlantKind, Run, Scenario};

/// The rows of a table of numbers without the lines that begin with `#`.
fn rows(text: &str) -> Vec<Vec<f64>> {
    let row = |line: &str| line.split(',').map(|cell| cell.trim().parse().unwrap()).collect();
    text.lines().filter(|line| !line.starts_with('#')).map(row).collect()
}

fn response(kind: PlantKind, dt: f64, hold: Hold) -> Run {
    let force = Force::Chirp { amplitude: 3.0, from: 1.0, to: 25.0, sweep: 10.0 };
    let mut scenario = Scenario { dt, duration: 199.0 * dt, force, hold, filters: vec![], ..Scenario::default() };
    scenario.set_plant(kind);
    scenario.plant.set(Channel::NATURAL_FREQUENCY, 6.0);
    let mut run = Run::new(&scenario).unwrap();
    run.finish();
    run
}

/// The largest difference of any motion from the reference, relative to the largest value of that motion.
fn difference(run: &Run, kind: PlantKind, reference: &[Vec<f64>]) -> f64 {
    let mut worst = 0.0_f64;
    for (place, &channel) in kind.channels()[..kind.motion()].iter().enumerate() {
        let truth = run.record().truth(channel).unwrap();
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
        let run = response(kind, dt, Hold::First);
        for (found, row) in run.record().input().iter().zip(&reference) {
            assert!((found - row[1]).abs() < 1e-12, "the force itself");
        }
        let error = difference(&run, kind, &reference);
        assert!(error < 1e-9, "{kind:?}: {error}");
        // The same input with a zero-order hold gives another response.
        assert!(difference(&response(kind, dt, Hold::Zero), kind, &reference) > 1e-2, "{kind:?}");
    }
}

#[test]
fn a_plant_with_hardly_any_cubic_stiffness_answers_like_a_linear_one() {
    let linear = response(PlantKind::SDOF, 0.05, Hold::First);
    let mut scenario = Scenario { dt: 0.05, duration: 9.95, hold: Hold::First, filters: vec![], ..Scenario::default() };
    scenario.force = Force::Chirp { amplitude: 3.0, from: 1.0, to: 25.0, sweep: 10.0 };
    scenario.set_plant(PlantKind::DUFFING);
    scenario.plant.set(Channel::NATURAL_FREQUENCY, 6.0);
    scenario.plant.set(Channel::CUBIC_STIFFNESS, 0.0);
    let mut run = Run::new(&scenario).unwrap();
    run.finish();
    let [x, reference] = [&run, &linear].map(|run| run.record().truth(Channel::DISPLACEMENT).unwrap());
    let size = reference.iter().fold(0.0_f64, |size, x| size.max(x.abs()));
    assert!(
        x.iter().zip(reference).all(|(a, b)| (a - b).abs() < 1e-9 * size),
        "Runge-Kutta steps against the exact response"
    );
}
