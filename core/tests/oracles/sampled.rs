//! Sampling filters agree with the Kalman filter where it is exact, within Monte Carlo error.

use kalmanscope_core::{Channel, Estimates, FilterKind, FilterSettings, Run, Scenario, Signal, Values};

use crate::run::finished;

fn linear(kind: FilterKind, sizes: &[usize], seed: u64, fading: f64) -> Scenario {
    let mut scenario = Scenario { seed, dt: 0.02, duration: 4.0, ..Scenario::default() };
    scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Constant(6.0));
    scenario.plant.disturbance_std = 3.0;
    let known = |_| FilterSettings {
        fading,
        sensor_std: vec![0.01, 0.06],
        initial_mean: Values::ZERO.with([
            (Channel::DISPLACEMENT, 0.05),
            (Channel::VELOCITY, -0.1),
            (Channel::NATURAL_FREQUENCY, 6.0),
            (Channel::DAMPING_RATIO, 0.05),
        ]),
        initial_std: Values::ZERO.with([(Channel::DISPLACEMENT, 0.05), (Channel::VELOCITY, 0.2)]),
        process_std: Values::ZERO.with([(Channel::DISPLACEMENT, 1e-3), (Channel::VELOCITY, 0.06)]),
        ..FilterSettings::default()
    };
    let kf = FilterSettings { kind: FilterKind::KF, ..known(0) };
    let sampled = sizes.iter().map(|&ensemble_size| FilterSettings { kind, ensemble_size, ..known(0) });
    scenario.filters = std::iter::once(kf).chain(sampled).collect();
    scenario
}

/// Root mean squares, over a record, of a filter's deviation from the KF: means in standard deviations, standard
/// deviations relative to the KF's; and the mean difference of the log likelihoods.
struct Error {
    mean: f64,
    std: f64,
    log_likelihood: f64,
}

fn error(kf: &Estimates, other: &Estimates) -> Error {
    assert_eq!((other.stop(), other.len()), (None, kf.len()), "{}", other.name());
    let (mut mean, mut std, mut log_likelihood, mut count) = (0.0, 0.0, 0.0, 0.0);
    for k in 1..kf.len() {
        for i in 0..2 {
            mean += ((other.mean(k)[i] - kf.mean(k)[i]) / kf.std(k, i)).powi(2);
            std += (other.std(k, i) / kf.std(k, i) - 1.0).powi(2);
            count += 1.0;
        }
        log_likelihood += other.log_likelihood(k) - kf.log_likelihood(k);
    }
    Error { mean: (mean / count).sqrt(), std: (std / count).sqrt(), log_likelihood: log_likelihood / kf.len() as f64 }
}

fn errors(run: &Run) -> Vec<Error> {
    let [kf, others @ ..] = run.estimates() else { unreachable!("there is a KF") };
    others.iter().map(|other| error(kf, other)).collect()
}

const SAMPLED: [FilterKind; 2] = [FilterKind::ENKF, FilterKind::PF];

#[test]
fn two_thousand_members_are_nearly_a_kalman_filter() {
    for kind in SAMPLED {
        for (seed, fading) in [(1, 1.0), (2, 1.002), (3, 1.02)] {
            for Error { mean, std, log_likelihood } in errors(&finished(&linear(kind, &[2000], seed, fading))) {
                println!("{} {seed}: mean {mean:.3}, std {std:.3}, log likelihood {log_likelihood:.4}", kind.name());
                assert!(mean < 0.09 && std < 0.06 && log_likelihood.abs() < 0.02, "{}, seed {seed}", kind.name());
            }
        }
    }
}

#[test]
fn the_error_falls_with_the_root_of_the_size() {
    for kind in SAMPLED {
        let sizes = [100, 1000, 10_000];
        let mut squares = [[0.0; 2]; 3];
        for seed in 1..=4 {
            for (square, error) in squares.iter_mut().zip(errors(&finished(&linear(kind, &sizes, seed, 1.0)))) {
                square[0] += error.mean * error.mean;
                square[1] += error.std * error.std;
            }
        }
        for pair in squares.windows(2) {
            let ratios = [0, 1].map(|which| (pair[0][which] / pair[1][which]).sqrt());
            println!("{}: {ratios:.2?} instead of 3.16", kind.name());
            assert!(ratios.iter().all(|ratio| (2.2..4.5).contains(ratio)), "{}: {ratios:?}", kind.name());
        }
    }
}

#[test]
fn the_effective_sample_size_is_that_of_some_weights() {
    for size in [2, 10, 1000] {
        let run = finished(&linear(FilterKind::PF, &[size], 5, 1.0));
        assert!(run.estimates()[0].effective_samples().is_empty());
        let pf = &run.estimates()[1];
        let effective = pf.effective_samples();
        assert_eq!(effective.len(), pf.len());
        assert!(effective[0].is_nan());
        assert!(effective[1..].iter().all(|n| (1.0 - 1e-9..=size as f64 + 1e-9).contains(n)), "{size}");
    }
}

#[test]
fn parameters_that_are_known_do_not_move_with_any_draw() {
    for kind in SAMPLED {
        let run = finished(&linear(kind, &[50], 1, 1.02));
        let sampled = &run.estimates()[1];
        for k in 0..sampled.len() {
            assert_eq!(sampled.mean(k)[2..], [6.0, 0.05]);
            assert_eq!([sampled.std(k, 2), sampled.std(k, 3)], [0.0; 2]);
        }
    }
}
