//! The shear chains' truth against modes of vibration and matrix exponentials.

use kalmanscope_core::signal::Step;
use kalmanscope_core::simulate;
use kalmanscope_core::{Channel, Force, PlantKind, Record, Scenario, Signal};

use super::matrix::{Matrix, along};
use super::plants::{Dual, Plant, jacobian, values};

const CHAINS: [(PlantKind, usize); 3] = [(PlantKind::SHEAR_2, 2), (PlantKind::SHEAR_3, 3), (PlantKind::SHEAR_4, 4)];

fn chain(kind: PlantKind) -> Scenario {
    let mut scenario = Scenario { duration: 20.0, ..Scenario::default() };
    scenario.set_plant(kind);
    scenario
}

fn truth(record: &Record, kind: PlantKind, k: usize) -> Vec<f64> {
    kind.channels().iter().map(|&c| record.truth(c).unwrap()[k]).collect()
}

fn largest(record: &Record, channel: Channel) -> f64 {
    record.truth(channel).unwrap().iter().fold(0.0, |most, x| most.max(x.abs()))
}

/// With equal storeys `K = κ T` and `C = c T`, and T has the eigenvalues `4 sin²(θⱼ/2)` and modes `sin(i θⱼ)` with
/// `θⱼ = (2j - 1)π/(2m + 1)`: each mode is a damped oscillator in free vibration.
///
/// Source: Chopra (2017), *Dynamics of Structures*, section 12.
#[test]
fn free_vibration_of_equal_storeys_is_a_sum_of_modes() {
    for (kind, masses) in CHAINS {
        let (stiffness, damping) = (180.0, 0.4);
        let mut scenario = Scenario { force: Force::None, ..chain(kind) };
        for channel in kind.parameters() {
            let value = if channel == Channel::STOREY_DAMPING { damping } else { stiffness };
            *scenario.plant.parameter_mut(channel).unwrap() = Signal::Constant(value);
        }
        scenario.plant.initial.displacement = 0.1;
        scenario.plant.initial.velocity = -0.5;
        let record = simulate(&scenario);
        let expected = |t: f64, mass: usize| -> f64 {
            let one_mode = |j: usize| {
                let angle = (2 * j + 1) as f64 * std::f64::consts::PI / (2 * masses + 1) as f64;
                let shape = |i: usize| ((i + 1) as f64 * angle).sin();
                let norm: f64 = (0..masses).map(|i| shape(i) * shape(i)).sum();
                let eigenvalue = 4.0 * (0.5 * angle).sin().powi(2);
                let (wn, decay) = ((stiffness * eigenvalue).sqrt(), 0.5 * damping * eigenvalue);
                let wd = (wn * wn - decay * decay).sqrt();
                let (x0, v0) = (0.1 * shape(0) / norm, -0.5 * shape(0) / norm);
                let (sin, cos) = (wd * t).sin_cos();
                (-decay * t).exp() * (x0 * cos + (v0 + decay * x0) / wd * sin) * shape(mass)
            };
            (0..masses).map(one_mode).sum()
        };
        for k in 0..record.len() {
            let found = truth(&record, kind, k);
            for (mass, found) in found.iter().enumerate().take(masses) {
                let error = (found - expected(record.time(k), mass)).abs();
                assert!(error < 1e-11, "{kind:?}, mass {mass} at {k}: {error}");
            }
        }
    }
}

#[test]
fn unequal_and_changing_storeys_are_matrix_exponentials() {
    for (kind, masses) in CHAINS {
        let mut scenario = Scenario { dt: 0.02, duration: 10.0, ..chain(kind) };
        scenario.plant.set(Channel::stiffness(1), Signal::Step(Step { from: 180.0, to: 90.0, at: 4.0 }));
        let record = simulate(&scenario);
        let plant = Plant { kind, eta: 0.0, log: false };
        let mut state = truth(&record, kind, 0);
        for k in 0..record.len() - 1 {
            let parameters = truth(&record, kind, k);
            state[2 * masses..].copy_from_slice(&parameters[2 * masses..]);
            let rate = plant.rate(&Dual::state(&state), record.force(k));
            let (rate, a) = (values(&rate), jacobian(&rate));
            let moving = 2 * masses;
            let augmented = Matrix::from_fn(moving + 1, moving + 1, |i, j| match (i < moving, j < moving) {
                (true, true) => a.at(i, j) * record.dt(),
                (true, false) => rate[i] * record.dt(),
                _ => 0.0,
            });
            let shift = augmented.exponential().column(moving);
            let moved = along(&state[..moving], &shift, 1.0);
            state[..moving].copy_from_slice(&moved);
            for (i, &channel) in kind.channels()[..moving].iter().enumerate() {
                let error = (state[i] - record.truth(channel).unwrap()[k + 1]).abs() / largest(&record, channel);
                assert!(error < 1e-10, "{kind:?}, {channel:?} at {k}: {error}");
            }
        }
    }
}
