use kalmanscope_filters::engine::builder::Notes;
use kalmanscope_filters::engine::level::Baseline;
use kalmanscope_filters::engine::list::Node;
use kalmanscope_filters::engine::model::read;
use kalmanscope_filters::engine::runge_kutta::classical;
use kalmanscope_filters::filter::{States, Step, System as _};
use kalmanscope_filters::{Hold, Reading};

use super::dynamics::ShearChain;
use super::*;
use crate::channel::augment;
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
        let full = Model::new(kind.clone()).augmented(kind.augmentations()).decaying(0.02);
        let shaken = full.clone().driven_by(InputKind::GroundAcceleration);
        [Model::new(kind), full.clone(), full.with_logarithms(true), shaken]
    })
}

#[test]
fn all_channels_begin_with_those_of_plants() {
    let mut of_plants: Vec<Channel> = Vec::new();
    for channel in PlantKind::ALL.iter().flat_map(PlantKind::channels) {
        if !of_plants.contains(channel) {
            of_plants.push(*channel);
        }
    }
    assert_eq!(Channel::all()[..of_plants.len()], of_plants);
    assert!(Channel::all()[of_plants.len()..].iter().all(|channel| channel.is_augmentation()));
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
            assert!(error < 1e-5, "{:?}: {error}", model.plant());
        }
    }
}

#[test]
fn gradients_of_readings_agree_with_differences() {
    for model in models() {
        let at = state(&model, 3);
        for quantity in model.plant().quantities() {
            let reading = model.reading(quantity).unwrap();
            let gradient = model.state.gradients(&[&reading], &at, 2.0.into());
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

#[test]
fn plants_of_the_registry_have_their_sizes_in_the_engine() {
    assert!(matches!(PlantKind::SHEAR_10.dynamics(), EnginePlant::ShearChain(ShearChain { masses: 10 })));
    for kind in PlantKind::ALL {
        let plant = kind.dynamics();
        let (n, motion) = (kind.channels().len(), kind.motion());
        assert_eq!(plant.sizes(), [n, motion], "{kind:?}");
        let velocities = kind.channels()[..motion].iter().map(|channel| channel.rate().is_none());
        let by_force: Vec<f64> = velocities.map(|is_velocity| f64::from(u8::from(is_velocity))).collect();
        let by_force = by_force.iter().enumerate().map(|(i, by)| if motion == 3 && i == 2 { 0.0 } else { *by });
        assert_eq!(plant.by_force(), by_force.collect::<Vec<_>>(), "{kind:?}");
    }
}

#[test]
fn notes_give_the_rates_and_readings_of_the_model() {
    for kind in PlantKind::ALL.into_iter().filter(|kind| kind.channels().len() <= 16) {
        let quantities: Vec<Quantity> = kind.quantities().collect();
        let augmentations = augment::OF_INPUT.into_iter().chain([Channel::UNKNOWN_FORCE, quantities[0].bias()]);
        let book = Model::new(kind.clone()).augmented(augmentations).decaying(0.01);
        let readings: Vec<Reading> = quantities.iter().filter_map(|&quantity| book.reading(quantity)).collect();
        let model = &book.state;
        let Notes { builder, rates, readings: noted, .. } = Notes::of(model, &readings).expect("a built-in plant");
        let outputs: Vec<(usize, Node)> = rates.iter().chain(&noted).copied().enumerate().collect();
        let list = builder.list(model.size + 1, &outputs).expect("a short list");
        let state: Vec<f64> = (0..model.size).map(|i| libm::sin((7 * i + 3) as f64) * 2.0).collect();
        let (mut out, mut rate) = (vec![0.0; outputs.len()], vec![0.0; model.moving()]);
        list.run(&state, 0.7, |place, value| out[place] = value);
        let mut plain = vec![0.0; model.size];
        model.rate(Baseline, &state, 0.7.into(), &mut plain, &mut rate);
        let read = readings.iter().map(|reading| read(model, reading, &state, &rate, 0.7));
        let known: Vec<f64> = rate.iter().copied().chain(read).collect();
        for (found, known) in out.iter().zip(&known) {
            assert!((found - known).abs() <= 1e-12 * known.abs().max(1.0), "{kind:?}: {found} and {known}");
        }
    }
}

#[test]
fn many_equations_are_read_and_each_is_freed_with_its_last_plant() {
    let read = |guess: f64| {
        let mut settings = EquationSettings::new("x'' + k x = f");
        settings.parameter_mut("k").guess = Some(guess);
        PlantKind::of_equation(&settings).expect("it is an equation")
    };
    for guess in (0..10_000).map(f64::from) {
        let (kind, same) = (read(guess), read(guess));
        let typed = Arc::downgrade(&kind.own_equation().expect("it has one").typed);
        let other = kind.clone();
        drop(kind);
        assert_eq!((typed.strong_count(), other.channels()[2].usual().mean), (1, guess));
        assert!(other == same && std::ptr::eq(other.channels()[2].info(), same.channels()[2].info()));
        drop(other);
        assert!(typed.upgrade().is_none());
    }
}

#[test]
fn each_state_moves_and_is_measured_as_if_it_were_alone() {
    for plant in [PlantKind::SDOF, PlantKind::DUFFING, PlantKind::BOUC_WEN, PlantKind::SHEAR_3] {
        for eta in [0.0, 0.02] {
            for count in 1..=9 {
                let model = Model::new(plant.clone()).augmented([Channel::INPUT_GAIN]).decaying(eta);
                let n = model.size();
                let begin: Vec<f64> = (0..n * count).map(|i| 0.2 + 0.7 * libm::sin(i as f64).abs()).collect();
                let step = Step { inputs: [0.7.into(), (-0.4).into()], hold: Hold::First, dt: 0.01 };
                let (mut states, mut engine) = (begin.clone(), States::new(model.state.clone()));
                engine.advance(&mut states, step);
                let quantities = [Quantity::DISPLACEMENT, Quantity::ACCELERATION];
                let readings: Vec<_> = quantities.iter().map(|&q| model.reading(q).unwrap()).collect();
                let mut values = vec![0.0; 2 * count];
                engine.read(&states, (-0.4).into(), &readings.iter().collect::<Vec<_>>(), &mut values);
                for place in 0..count {
                    let mut moved = begin[place * n..(place + 1) * n].to_vec();
                    let rate = |y: &[f64], force: f64, rate: &mut [f64]| {
                        rate.copy_from_slice(model.rate(y, force).as_slice());
                    };
                    let mut memory: [Vec<f64>; 5] = std::array::from_fn(|_| vec![0.0; n]);
                    let memory = memory.each_mut().map(Vec::as_mut_slice);
                    classical(rate, &mut moved, [0.7, 0.15, -0.4], 0.01, memory);
                    for i in 0..n {
                        let (own, other) = (states[place * n + i], moved[i]);
                        assert!((own - other).abs() <= 1e-13 * other.abs().max(1.0), "{plant:?} {i}: {own} {other}");
                    }
                    let state = &states[place * n..(place + 1) * n];
                    for (value, reading) in values[2 * place..].iter().zip(&readings) {
                        let alone = model.read(reading, state, -0.4);
                        assert!((value - alone).abs() <= 1e-12 * alone.abs().max(1.0), "{plant:?}");
                    }
                }
            }
        }
    }
}
