use super::*;
use crate::channel::augment;
use crate::equation::EquationSettings;
use crate::{InputKind, Model};

fn state(model: &Model, seed: usize) -> Vec<f64> {
    let n = model.size();
    let value = |(i, channel): (usize, &Channel)| {
        let number = libm::sin(1.7 * (seed * n + i) as f64 + 0.4);
        let usual = channel.usual();
        if channel.is_parameter() { usual.mean * (1.0 + 0.5 * number) + 0.1 * number } else { usual.std * number }
    };
    let values: Vec<f64> = model.channels().iter().enumerate().map(value).collect();
    model.to_state(&values).0.as_slice().to_vec()
}

fn models() -> impl Iterator<Item = Model> {
    PlantKind::ALL.into_iter().flat_map(|kind| {
        let full = Model::new(kind.clone()).augmented(augment::of(&kind)).decaying(0.02);
        let shaken = full.clone().driven_by(InputKind::GroundAcceleration);
        [Model::new(kind), full.clone(), full.with_logarithms(true), shaken]
    })
}

fn worst(at: &[f64], gradient: impl Fn(usize) -> Vec<f64>, function: impl Fn(&[f64]) -> Vec<f64>) -> f64 {
    let mut worst = 0.0_f64;
    for j in 0..at.len() {
        let step = 1e-6 * at[j].abs().max(1e-3);
        let moved = |by: f64| {
            let mut moved = at.to_vec();
            moved[j] += by;
            function(&moved)
        };
        let analytic = gradient(j);
        let scale = analytic.iter().fold(1.0_f64, |scale, x| scale.max(x.abs()));
        for ((high, low), analytic) in moved(step).iter().zip(&moved(-step)).zip(&analytic) {
            worst = worst.max(((high - low) / (2.0 * step) - analytic).abs() / scale);
        }
    }
    worst
}

#[test]
fn jacobians_agree_with_differences() {
    for model in models() {
        for seed in 0..5 {
            let at = state(&model, seed);
            let jacobian = model.jacobian(&at, 2.0);
            let column = |j: usize| jacobian.column(j).iter().copied().collect();
            let error = worst(&at, column, |y| model.rate(y, 2.0).as_slice().to_vec());
            assert!(error < 3e-6, "{:?}: {error}", model.plant());
        }
    }
}

#[test]
fn gradients_of_readings_agree_with_differences() {
    for model in models() {
        let at = state(&model, 3);
        for quantity in model.plant().quantities() {
            let reading = model.reading(quantity).unwrap();
            let gradient = model.read_gradient(&reading, &at, 2.0);
            let error = worst(&at, |j| vec![gradient[j]], |y| vec![model.read(&reading, y, 2.0)]);
            assert!(error < 3e-6, "{quantity:?} of {:?}: {error}", model.plant());
        }
    }
}

#[test]
fn a_plant_at_rest_takes_the_force_as_its_acceleration() {
    for kind in PlantKind::ALL {
        let model = Model::new(kind.clone());
        let rest = vec![0.0; model.size()];
        for mass in 0..kind.masses() {
            let of = |aspect| model.read(&model.reading(Quantity::new(aspect, mass)).unwrap(), &rest, 3.0);
            assert_eq!(of(crate::Aspect::ACCELERATION), 3.0);
            assert_eq!(of(crate::Aspect::TOTAL_ACCELERATION), 3.0);
        }
        // With its base shaken, a plant at rest stays at rest in an inertial frame.
        let shaken = model.driven_by(InputKind::GroundAcceleration);
        let total = shaken.reading(Quantity::TOTAL_ACCELERATION).unwrap();
        assert_eq!(shaken.read(&total, &rest, InputKind::GroundAcceleration.force(3.0)), 0.0);
    }
}

#[test]
fn forces_and_springs_are_those_of_the_equations() {
    let of =
        |kind: PlantKind| (0..kind.masses()).map(|mass| (kind.is_driven(mass), kind.is_held(mass))).collect::<Vec<_>>();
    let typed = |text: &str| of(PlantKind::of_equation(&EquationSettings::new(text)).expect("an equation"));
    assert_eq!(of(PlantKind::BOUC_WEN), [(true, true)]);
    assert_eq!(of(PlantKind::SHEAR_3), [(true, true); 3]);
    assert_eq!(typed("x1'' + k x1 + q (x1 - x2) = f; x2'' + q (x2 - x1) = 0"), [(true, true), (false, true)]);
    assert_eq!(typed("x1'' + k x1 + g x2' = f; x2'' + k x2 - g x1' = 0"), [(true, true), (false, false)]);
    assert_eq!(typed("x'' = f + z; z' = a x"), [(true, false)]);
    assert_eq!(typed("x'' + z = 0; z' = f - a z + x"), [(false, false)]);
}
