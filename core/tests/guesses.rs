//! Filters that begin from several guesses of the natural frequency, side by side.

use kalmanscope_core::{
    Channel, Estimates, FilterKind, FilterSettings, Force, Quantity, Run, Scenario, Sensor, Signal, Values,
};

use crate::run::{finished, last};

const NATURAL_FREQUENCY: Channel = Channel::NATURAL_FREQUENCY;

/// 40 s of an oscillator of 6 rad/s with one sensor, and filters that begin from these natural frequencies [rad/s], each with
/// this share of it as the standard deviation.
fn scenario(
    seed: u64,
    kind: FilterKind,
    sensor: (Quantity, f64),
    means: &[f64],
    share: f64,
    guesses: usize,
) -> Scenario {
    let (measures, noise_std) = sensor;
    let mut scenario = Scenario { seed, duration: 40.0, ..Scenario::default() };
    scenario.force = Force::WhiteNoise { std: 10.0 };
    scenario.plant.set(NATURAL_FREQUENCY, Signal::Constant(6.0));
    scenario.plant.set(Channel::DAMPING_RATIO, Signal::Constant(0.05));
    scenario.sensors = vec![Sensor::new(measures, noise_std)];
    let of = |values: [f64; 4]| {
        let channels = [Channel::DISPLACEMENT, Channel::VELOCITY, NATURAL_FREQUENCY, Channel::DAMPING_RATIO];
        Values::ZERO.with(channels.into_iter().zip(values))
    };
    let filter = |&mean: &f64| FilterSettings {
        kind,
        guesses,
        sensor_std: vec![noise_std],
        initial_mean: of([0.0, 0.0, mean, 0.1]),
        initial_std: of([0.05, 0.3, share * mean, 0.08]),
        process_std: of([1e-5, 1e-3, 1e-5, 1e-6]),
        ..FilterSettings::default()
    };
    scenario.filters = means.iter().map(filter).collect();
    scenario
}

/// The guesses of ωₙ from 1 to 36 rad/s, evenly in their logarithms.
fn means(count: usize) -> Vec<f64> {
    (0..count).map(|i| 36_f64.powf(i as f64 / (count - 1) as f64)).collect()
}

/// Whether the last estimate is within 5 % of the truth.
fn has_arrived(estimates: &Estimates) -> bool {
    estimates.stop().is_none() && (last(estimates, NATURAL_FREQUENCY).0 / 6.0 - 1.0).abs() < 0.05
}

#[test]
fn from_guesses_of_1_to_36_all_arrive() {
    let sensors = [(Quantity::DISPLACEMENT, 0.01), (Quantity::ACCELERATION, 0.5)];
    for kind in [FilterKind::EKF, FilterKind::UKF] {
        for sensor in sensors {
            for share in [0.02, 0.1, 0.3] {
                let (mut arrived, mut alone, mut of) = (0, 0, 0);
                for seed in 701..704 {
                    let (four, one) = (scenario(seed, kind, sensor, &means(12), share, 4), 1);
                    let one = scenario(seed, kind, sensor, &means(12), share, one);
                    let count = |run: &Run| run.estimates().iter().filter(|estimates| has_arrived(estimates)).count();
                    (arrived, alone, of) = (arrived + count(&finished(&four)), alone + count(&finished(&one)), of + 12);
                }
                println!("{kind:?} {sensor:?}, σ₀ {share} of the guess: {arrived} of {of}, with one guess {alone}");
                assert_eq!(arrived, of, "{kind:?} {sensor:?} {share}, with one guess {alone}");
            }
        }
    }
}

#[test]
fn the_likeliest_is_one_of_the_guesses_bit_by_bit_and_keeps_its_errors_bounds() {
    let sensor = (Quantity::DISPLACEMENT, 0.01);
    let mut bank = scenario(711, FilterKind::EKF, sensor, &[11.0], 0.1, 4);
    let run = finished(&bank);
    let chosen = &run.estimates()[0];
    let spread: Vec<f64> = [-2.0, -2.0 / 3.0, 2.0 / 3.0, 2.0].iter().map(|x: &f64| 11.0 * libm::exp(*x)).collect();
    let nearest = spread.iter().copied().min_by(|a, b| (a - 6.0).abs().total_cmp(&(b - 6.0).abs())).unwrap();
    let filter = &mut bank.filters[0];
    filter.guesses = 1;
    filter.initial_mean[NATURAL_FREQUENCY] = nearest;
    filter.initial_std[NATURAL_FREQUENCY] = 0.5 * nearest;
    let alone = finished(&bank);
    let (mean, std) = last(chosen, NATURAL_FREQUENCY);
    let (alone, _) = last(&alone.estimates()[0], NATURAL_FREQUENCY);
    assert!((mean - 6.0).abs() < 4.0 * std, "{mean} ± {std}");
    assert!((mean - alone).abs() < 0.1 * std, "{mean}, alone {alone}");
}

#[test]
fn where_guesses_have_no_meaning_they_are_refused() {
    let refused = |text: &str| Scenario::from_toml(text).unwrap_err().to_string();
    for text in [
        "[[filters]]\nkind = \"kf\"\nguesses = 4",
        "[[filters]]\nsmoother = true\nguesses = 4",
        "[[filters]]\nguesses = 9",
        "[plant]\nkind = \"shear_2\"\n[[filters]]\nguesses = 4",
    ] {
        assert!(refused(text).contains("filters[0].guesses"), "{text}");
    }
    assert_eq!(Scenario::from_toml("[[filters]]\nguesses = 4").unwrap().filters[0].guesses, 4);
}

#[test]
fn a_run_that_is_continued_has_the_bits_of_one_in_one_go() {
    let scenario = scenario(721, FilterKind::UKF, (Quantity::DISPLACEMENT, 0.01), &[20.0], 0.1, 4);
    let whole = finished(&scenario);
    let mut parts = Run::new(&scenario).unwrap();
    while parts.advance_to(parts.done() + 77) > 0 {}
    assert_eq!(parts.checksum(), whole.checksum());
}
