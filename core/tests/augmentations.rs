//! Filters identify properties of input and sensors besides the plant's, and inputs that are linear between samples.

use kalmanscope_core::filter::{Matrix, Propagation, Step, Vector};
use kalmanscope_core::signal::Sine;
use kalmanscope_core::{
    Aspect, Channel, Estimates, FilterKind, FilterSettings, Force, Hold, Model, PlantKind, Quantity, Scenario, Sensor,
    Signal,
};

use crate::numbers::{DETERMINISTIC, exponential, mean};
use crate::run::{finished, last, oscillator, plants};

fn scenario(sensors: &[Quantity], kind: FilterKind, augment: &[Channel]) -> Scenario {
    let filter = FilterSettings { kind, augment: augment.to_vec(), ..FilterSettings::default() };
    let plant = oscillator(6.0, 0.05);
    let mut scenario = Scenario { duration: 40.0, plant, filters: vec![filter], ..Scenario::default() };
    scenario.set_sensors(sensors);
    if kind == FilterKind::KF {
        scenario.filters[0].initial_mean[Channel::NATURAL_FREQUENCY] = 6.0;
        scenario.filters[0].initial_mean[Channel::DAMPING_RATIO] = 0.05;
    }
    scenario
}

fn assert_found(scenario: &Scenario, channel: Channel, std: f64) {
    let run = finished(scenario);
    let estimates = &run.estimates()[0];
    let what = format!("{channel:?} by {:?}, {:?}", estimates.kind, estimates.stop());
    assert_eq!(estimates.len(), run.samples(), "{what}");
    let truth = run.record().truth(channel).unwrap()[estimates.len() - 1];
    let (mean, found) = last(estimates, channel);
    assert!((mean - truth).abs() < 3.5 * found, "{what}: {mean} ± {found}, {truth}");
    assert!(found < std, "{what}: ± {found}");
}

#[test]
fn gain_and_bias_of_each_kind_of_sensor_are_found() {
    for kind in [FilterKind::KF, FilterKind::EKF, FilterKind::UKF, FilterKind::SR_UKF, FilterKind::IEKF] {
        for quantity in PlantKind::SDOF.quantities() {
            for gain in [1.3, -0.8] {
                let sensors = [Quantity::DISPLACEMENT, Quantity::VELOCITY, Quantity::ACCELERATION, quantity];
                let mut scenario = scenario(&sensors, kind, &[quantity.gain(), quantity.bias()]);
                let noise = quantity.aspect().info().usual_noise;
                scenario.plant.set(quantity.gain(), gain);
                scenario.plant.set(quantity.bias(), 2.0 * noise);
                scenario.filters[0].initial_mean[quantity.gain()] = gain.signum();
                assert_found(&scenario, quantity.gain(), 0.02);
                assert_found(&scenario, quantity.bias(), 0.5 * noise);
            }
        }
    }
}

/// Readings and noise are both multiplied.
#[test]
fn a_known_gain_is_another_unit() {
    let quantity = Quantity::VELOCITY;
    for kind in FilterKind::ALL {
        let mut right = scenario(&[Quantity::DISPLACEMENT, quantity], kind, &[quantity.gain()]);
        (right.duration, right.filters[0].ensemble_size) = (5.0, 50);
        right.filters[0].initial_std[quantity.gain()] = 0.0;
        let mut other = right.clone();
        other.plant.set(quantity.gain(), 4.0);
        other.filters[0].initial_mean[quantity.gain()] = 4.0;
        other.sensors[1].noise_std *= 4.0;
        other.filters[0].sensor_std[1] *= 4.0;
        let [one, two] = [&right, &other].map(finished);
        let [one, two] = [&one, &two].map(|run| &run.estimates()[0]);
        assert_eq!(one.len(), right.samples(), "{kind:?}: {:?}", one.stop());
        for k in 1..one.len() {
            for place in 0..4 {
                let off = (one.mean(k)[place] - two.mean(k)[place]).abs() / one.std(k, place).max(1e-9);
                assert!(off < 1e-6, "{kind:?}, sample {k}, component {place}: {off}");
            }
            let nis = (one.nis()[k] - two.nis()[k]).abs() / one.nis()[k];
            assert!(nis < 1e-6, "{kind:?}, sample {k}: {nis}");
        }
    }
}

#[test]
fn gain_and_offset_of_the_input_are_found_and_an_unknown_force_is_followed() {
    let wave = Signal::Sine(Sine { mean: 0.0, amplitude: 5.0, period: 4.0 });
    for kind in [FilterKind::KF, FilterKind::EKF, FilterKind::UKF] {
        for (channel, signal, std, holds) in [
            (Channel::INPUT_GAIN, 1.3.into(), 0.02, &[Hold::Zero, Hold::First][..]),
            (Channel::INPUT_OFFSET, 1.5.into(), 0.2, &[Hold::Zero, Hold::First]),
            (Channel::UNKNOWN_FORCE, wave, 1.0, &[Hold::Zero]),
        ] {
            for &hold in holds {
                let mut scenario = scenario(&[Quantity::DISPLACEMENT, Quantity::ACCELERATION], kind, &[channel]);
                scenario.plant.set(channel, signal);
                assert_found(&Scenario { hold, ..scenario }, channel, std);
            }
        }
    }
}

#[test]
fn chains_of_five_to_ten_masses_find_their_stiffness() {
    for (plant, kind) in [
        (PlantKind::SHEAR_5, FilterKind::EKF),
        (PlantKind::SHEAR_5, FilterKind::UKF),
        (PlantKind::SHEAR_7, FilterKind::UKF),
        (PlantKind::SHEAR_10, FilterKind::EKF),
    ] {
        let masses = plant.masses();
        let mut scenario = scenario(&[], kind, &[]);
        scenario.duration = 20.0;
        scenario.set_plant(plant);
        for mass in 0..masses {
            let measures = Quantity::new(Aspect::DISPLACEMENT, mass);
            scenario.add_sensor(Sensor::new(measures, 0.01));
        }
        for mass in [0, masses / 2] {
            assert_found(&scenario, Channel::stiffness(mass), 10.0);
        }
    }
}

#[test]
fn a_first_order_hold_is_the_exponential_of_plant_force_and_slope() {
    for plant in [PlantKind::SDOF, PlantKind::SHEAR_3, PlantKind::SHEAR_6] {
        let model = Model::new(plant.clone()).augmented([Channel::INPUT_GAIN]);
        let (n, motion) = (model.size(), model.motion());
        let gain = model.place(Channel::INPUT_GAIN).unwrap();
        let state = Vector::from_fn(n, |i, _| match model.channels()[i] {
            channel if channel == Channel::INPUT_GAIN => 1.3,
            channel if channel.is_parameter() => channel.usual_truth(),
            _ => 0.1 * libm::sin(1.0 + i as f64),
        });
        let ([begin, end], dt) = ([3.0, -2.0], 0.03);
        // [motion, f, ḟ]
        let mut a = Matrix::zeros(motion + 2, motion + 2);
        let jacobian = model.jacobian(state.as_slice(), begin);
        a.view_mut((0, 0), (motion, motion)).copy_from(&jacobian.view((0, 0), (motion, motion)));
        for i in motion / 2..motion {
            a[(i, motion)] = 1.0;
        }
        a[(motion, motion + 1)] = 1.0;
        let exp = exponential(&(a * dt));
        let after = |motion_before: &[f64], scale: f64| {
            let slope = (end - begin) / dt;
            let rest = [scale * begin, scale * slope];
            &exp * Vector::from_iterator(motion + 2, motion_before.iter().copied().chain(rest))
        };
        let (mean, transition) = Propagation::LocalLinearisation.step(
            &model.state,
            &state,
            Step { inputs: [begin.into(), end.into()], hold: Hold::First, dt },
        );
        let expected = after(&state.as_slice()[..motion], 1.3);
        let by_gain = after(&vec![0.0; motion], 1.0);
        for i in 0..motion {
            assert!((mean[i] - expected[i]).abs() < 1e-12 * expected.amax(), "{plant:?}, component {i}");
            assert!((transition[(i, gain)] - by_gain[i]).abs() < 1e-12 * by_gain.amax(), "{plant:?}, gain, {i}");
            for j in 0..motion {
                assert!((transition[(i, j)] - exp[(i, j)]).abs() < 1e-12, "{plant:?}, transition, {i}, {j}");
            }
        }
    }
}

#[test]
fn transitions_are_derivatives_of_steps() {
    for plant in plants() {
        let model =
            Model::new(plant.clone()).augmented([Channel::INPUT_GAIN, Channel::INPUT_OFFSET, Channel::UNKNOWN_FORCE]);
        let model = model.decaying(0.02).with_logarithms(plant == PlantKind::DUFFING);
        let values: Vec<f64> = (model.channels().iter().enumerate())
            .map(|(i, c)| if c.is_parameter() { c.usual_truth() + 0.01 } else { 0.1 * libm::sin(1.0 + i as f64) })
            .collect();
        let (state, _) = model.to_state(&values);
        let step = Step { inputs: [3.0.into(), (-2.0).into()], hold: Hold::First, dt: 0.01 };
        let (_, transition) = Propagation::RungeKutta.step(&model.state, &state, step);
        for j in 0..model.size() {
            let h = 1e-5 * state[j].abs().max(0.01);
            let [mut high, mut low] = [state.clone(), state.clone()];
            high[j] += h;
            low[j] -= h;
            let [high, low] = [high, low].map(|state| Propagation::RungeKutta.step(&model.state, &state, step).0);
            let difference = (high - low) / (2.0 * h);
            let error = (&difference - transition.column(j)).amax() / transition.column(j).amax();
            assert!(error < 1e-7, "{plant:?}, {:?}: {error}", model.channels()[j]);
        }
    }
}

#[test]
fn matched_noise_is_consistent_where_an_accelerometer_feels_the_disturbance() {
    let text = include_str!("accelerometer-disturbance.toml");
    let mut nis = [0.0; 2];
    const SEEDS: u64 = 20;
    for seed in 0..SEEDS {
        let mut scenario = Scenario::from_toml(text).unwrap();
        scenario.seed = seed;
        let (sensor_std, process_std) = scenario.true_noise();
        scenario.filters.truncate(1);
        scenario.filters[0].process_std = process_std;
        let own = scenario.filters[0].clone();
        scenario.filters.push(FilterSettings { sensor_std, ..own });
        scenario.filters[1].id = scenario.filters[0].id + 1;
        let run = finished(&scenario);
        for (sum, estimates) in nis.iter_mut().zip(run.estimates()) {
            *sum += mean(&estimates.nis()[1..]) / SEEDS as f64;
        }
    }
    let [without, matched] = nis;
    assert!((matched - 2.0).abs() < 0.1, "two sensors: {matched}");
    assert!(without > 10.0, "the disturbance left out: {without}");
}

/// Here the filter's bias is a scalar Kalman filter, and its smoother a scalar one.
///
/// ```text
/// m⁻ = φ m, P⁻ = φ² P + q²,  K = P⁻ / (P⁻ + r²),  backwards G = φ P / P⁻
/// ```
#[test]
fn a_bias_that_is_forgotten_is_a_gauss_markov_process() {
    let (tau, new, white, dt) = (0.05, 0.4, 0.3, 0.01);
    let left = f64::exp(-dt / tau);
    for kind in DETERMINISTIC {
        let mut scenario = scenario(&[Quantity::VELOCITY], kind, &[Quantity::VELOCITY.bias()]);
        (scenario.duration, scenario.sensors[0].noise_std) = (2.0, 0.5);
        scenario.force = Force::None;
        let filter = &mut scenario.filters[0];
        let bias = Quantity::VELOCITY.bias();
        (filter.smoother, filter.sensor_std) = (true, vec![white]);
        for channel in PlantKind::SDOF.channels() {
            (filter.initial_std[*channel], filter.process_std[*channel]) = (0.0, 0.0);
        }
        (filter.initial_std[bias], filter.process_std[bias], filter.correlation_time[bias]) = (1.0, new, tau);
        let run = finished(&scenario);
        let (estimates, readings) = (&run.estimates()[0], run.record().measured(0));
        let place = estimates.place(bias).unwrap();
        let (mut filtered, mut predicted) = (vec![(0.0, 1.0)], vec![(0.0, 1.0)]);
        for reading in &readings[1..] {
            let (mean, variance) = filtered[filtered.len() - 1];
            let (mean, variance) = (left * mean, left * left * variance + new * new);
            predicted.push((mean, variance));
            let gain = variance / (variance + white * white);
            filtered.push((mean + gain * (reading - mean), (1.0 - gain) * variance));
        }
        let assert_near = |estimates: &Estimates, k: usize, (mean, variance): (f64, f64)| {
            let found = (estimates.mean(k)[place], estimates.std(k, place).powi(2));
            assert!((found.0 - mean).abs() < 1e-9 && (found.1 - variance).abs() < 1e-9, "{kind:?}, {k}: {found:?}");
        };
        filtered.iter().enumerate().for_each(|(k, belief)| assert_near(estimates, k, *belief));
        let mut smoothed = filtered[filtered.len() - 1];
        let hindsight = run.smoothed().remove(0);
        for k in (0..filtered.len() - 1).rev() {
            let back = left * filtered[k].1 / predicted[k + 1].1;
            smoothed = (
                filtered[k].0 + back * (smoothed.0 - predicted[k + 1].0),
                filtered[k].1 + back * back * (smoothed.1 - predicted[k + 1].1),
            );
            assert_near(&hindsight, k, smoothed);
        }
    }
}
