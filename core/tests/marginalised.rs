//! The Rao-Blackwellised particle filter: its parameters do not impoverish.

use kalmanscope_core::{
    Channel, CramerRao, FilterKind, FilterSettings, Force, PlantKind, Quantity, Scenario, Sensor, Signal, Values,
};

use crate::run::finished;

const NATURAL_FREQUENCY: Channel = Channel::NATURAL_FREQUENCY;
const DAMPING_RATIO: Channel = Channel::DAMPING_RATIO;

/// The number of records.
const SEEDS: u64 = 10;

/// Limits the root mean square of ten normal errors over their σ: chance exceeds it in one of a hundred cases. A PF of 300
/// particles has 1.6 to 2.5 here.
const LARGEST: f64 = 1.52;

/// 20 s of an oscillator under white noise, and filters of these kinds and numbers of particles.
fn scenario(seed: u64, sensors: &[(Quantity, f64)], filters: &[(FilterKind, usize)]) -> Scenario {
    let mut scenario = Scenario { seed, duration: 20.0, ..Scenario::default() };
    scenario.force = Force::WhiteNoise { std: 10.0 };
    scenario.plant.set(NATURAL_FREQUENCY, Signal::Constant(6.0));
    scenario.plant.set(DAMPING_RATIO, Signal::Constant(0.05));
    scenario.plant.disturbance_std = 0.5;
    scenario.sensors = sensors.iter().map(|&(measures, noise_std)| Sensor::new(measures, noise_std)).collect();
    let of = |values: [f64; 4]| {
        let channels = [Channel::DISPLACEMENT, Channel::VELOCITY, NATURAL_FREQUENCY, DAMPING_RATIO];
        Values::ZERO.with(channels.into_iter().zip(values))
    };
    let filter = |&(kind, ensemble_size): &(FilterKind, usize)| FilterSettings {
        kind,
        ensemble_size,
        sensor_std: sensors.iter().map(|(_, noise)| *noise).collect(),
        initial_mean: of([0.0, 0.0, 6.8, 0.08]),
        initial_std: of([0.05, 0.3, 1.0, 0.04]),
        process_std: of([2.5e-5, 5e-3, 0.0, 0.0]),
        ..FilterSettings::default()
    };
    scenario.filters = filters.iter().map(filter).collect();
    scenario.number_filters();
    scenario
}

#[test]
fn deviations_are_those_of_the_bound_and_errors_too() {
    let x = (Quantity::DISPLACEMENT, 0.01);
    let sets: [&[(Quantity, f64)]; 2] = [&[x], &[x, (Quantity::VELOCITY, 0.06)]];
    let kinds = [(FilterKind::RBPF, 200), (FilterKind::EKF, 2)];
    for sensors in sets {
        let mut ratios = [[0.0; 2]; 2];
        let mut squares = [[0.0; 2]; 2];
        for seed in 801..801 + SEEDS {
            let scenario = scenario(seed, sensors, &kinds);
            let run = finished(&scenario);
            let mut bound = CramerRao::new(&scenario, 1, scenario.dt).unwrap();
            bound.follow(run.record());
            for (place, estimates) in run.estimates().iter().enumerate() {
                assert_eq!(estimates.stop(), None);
                let last = estimates.len() - 1;
                for (i, (channel, truth)) in [(NATURAL_FREQUENCY, 6.0), (DAMPING_RATIO, 0.05)].into_iter().enumerate() {
                    let at = estimates.place(channel).unwrap();
                    let floor = bound.std(last, bound.place(channel).unwrap());
                    ratios[place][i] += estimates.std(last, at) / floor / SEEDS as f64;
                    squares[place][i] += ((estimates.canonical_mean(last, at) - truth) / floor).powi(2) / SEEDS as f64;
                }
            }
        }
        let errors = squares.map(|square| square.map(f64::sqrt));
        for ((kind, ratios), errors) in kinds.iter().zip(&ratios).zip(&errors) {
            println!("{} sensors, {kind:?}: σ over bound {ratios:.2?}, error over bound {errors:.2?}", sensors.len());
        }
        for i in 0..2 {
            assert!((0.8..1.2).contains(&ratios[0][i]), "σ over bound {:?}", ratios[0]);
            assert!(errors[0][i] < LARGEST, "error over bound {:?}, EKF {:?}", errors[0], errors[1]);
        }
    }
}

#[test]
fn with_known_parameters_it_is_a_kalman_filter() {
    let mut scenario = scenario(821, &[(Quantity::DISPLACEMENT, 0.01)], &[(FilterKind::RBPF, 5), (FilterKind::EKF, 2)]);
    for filter in &mut scenario.filters {
        filter.initial_mean[NATURAL_FREQUENCY] = 6.0;
        filter.initial_mean[DAMPING_RATIO] = 0.05;
        filter.initial_std[NATURAL_FREQUENCY] = 0.0;
        filter.initial_std[DAMPING_RATIO] = 0.0;
    }
    let run = finished(&scenario);
    let [particles, exact] = run.estimates() else { panic!("two filters") };
    for k in (0..exact.len()).step_by(50) {
        for i in 0..4 {
            assert!((particles.mean(k)[i] - exact.mean(k)[i]).abs() <= 1e-9 * exact.mean(k)[i].abs().max(1.0));
            assert!((particles.std(k, i) - exact.std(k, i)).abs() <= 1e-9);
        }
        if k > 0 {
            assert!((particles.log_likelihood(k) - exact.log_likelihood(k)).abs() < 1e-6, "at {k}");
        }
    }
}

#[test]
fn other_plants_augmentations_and_settings_are_served() {
    let mut scenario = scenario(831, &[(Quantity::DISPLACEMENT, 0.01), (Quantity::ACCELERATION, 0.5)], &[]);
    scenario.duration = 4.0;
    for plant in [PlantKind::SDOF, PlantKind::DUFFING, PlantKind::BOUC_WEN, PlantKind::SHEAR_2] {
        scenario.set_plant(plant);
        let plain = FilterSettings {
            kind: FilterKind::RBPF,
            ensemble_size: 40,
            sensor_std: vec![0.01, 0.5],
            fading: 1.001,
            ..FilterSettings::default()
        };
        let mut learning = plain.clone();
        learning.adaptation.sensor_noise = true;
        learning.augment = vec![Channel::INPUT_GAIN];
        let logarithms = FilterSettings { log_parameters: true, eta: 0.01, substeps: 2, jump: true, ..plain.clone() };
        scenario.filters = vec![plain, learning, logarithms];
        scenario.number_filters();
        for estimates in finished(&scenario).estimates() {
            assert_eq!(estimates.stop(), None, "{plant:?}");
            let last = estimates.len() - 1;
            assert!((0..estimates.channels().len()).all(|i| estimates.std(last, i).is_finite()));
        }
    }
}
