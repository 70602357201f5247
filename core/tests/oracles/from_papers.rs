//! Each filter agrees with a plain implementation of its paper, and sampling filters with the Kalman filter within Monte Carlo error.

use kalmanscope_core::{
    Adaptation, Aspect, Channel, Estimates, FilterKind, FilterSettings, PlantKind, Propagation, Quantity, Run,
    Scenario, Sensor, simulate,
};

use super::plants::written;
use super::textbook::{Sample, filter};
use crate::numbers::{DETERMINISTIC, beliefs, rms};
use crate::run::{finished, finished_on, oscillator, plants, values};

pub(crate) fn scenario(plant: PlantKind, kind: FilterKind) -> Scenario {
    let mut scenario = Scenario { dt: 0.01, duration: 2.5, ..Scenario::default() };
    scenario.set_plant(plant);
    scenario.plant.set(Channel::NATURAL_FREQUENCY, 6.0);
    scenario.sensors = vec![Sensor::new(Quantity::DISPLACEMENT, 0.01), Sensor::new(Quantity::ACCELERATION, 0.5)];
    scenario.filters = vec![FilterSettings {
        name: kind.name().to_owned(),
        kind,
        fading: 1.002,
        sensor_std: vec![0.01, 0.5],
        ..FilterSettings::default()
    }];
    scenario
}

/// The largest deviation of some estimates from the textbook's: means and covariances relative to standard deviations,
/// or to the rounding of the mean where these are smaller; NIS and log likelihood relative to themselves or one.
pub(crate) fn deviation(estimates: &Estimates, expected: &[Sample]) -> f64 {
    assert_eq!((estimates.stop(), estimates.len()), (None, expected.len()), "{}", estimates.name());
    let n = estimates.channels().len();
    let mut worst = 0.0_f64;
    for (k, sample) in expected.iter().enumerate() {
        let scale = |i: usize| sample.cov[(i, i)].max(0.0).sqrt().max(1e-6 * sample.mean[i].abs());
        for i in 0..n {
            worst = worst.max(part(estimates.mean(k)[i] - sample.mean[i], scale(i)));
            for j in 0..n {
                worst = worst.max(part(estimates.cov(k)[n * j + i] - sample.cov[(i, j)], scale(i) * scale(j)));
            }
        }
        let pairs = [(estimates.nis()[k], sample.nis), (estimates.log_likelihood(k), sample.log_likelihood)];
        for (found, expected) in pairs {
            assert_eq!(found.is_nan(), expected.is_nan(), "{} at {k}", estimates.name());
            worst = worst.max((found - expected).abs() / expected.abs().max(1.0));
        }
    }
    worst
}

fn part(x: f64, scale: f64) -> f64 {
    if x == 0.0 { 0.0 } else { (x / scale).abs() }
}

/// Most agree to 1e-11; in the transient of an EKF from a wrong belief, rounding grows to 1e-9.
const TOLERANCE: f64 = 1e-8;

#[test]
fn every_filter_with_every_option_is_that_of_its_paper() {
    let usual = FilterSettings::default();
    let plain = DETERMINISTIC.map(|kind| FilterSettings { kind, fading: 1.002, ..usual.clone() }).to_vec();
    let mut cases = plain.clone();
    for kind in DETERMINISTIC {
        cases.extend([(0.02, false), (0.0, true), (0.02, true)].map(|(eta, log_parameters)| FilterSettings {
            kind,
            eta,
            log_parameters,
            fading: 1.002,
            ..usual.clone()
        }));
        cases.extend([(true, false), (false, true), (true, true)].map(|(sensor_noise, process_noise)| {
            let adaptation = Adaptation { sensor_noise, process_noise, forgetting: 0.99, training: 0.0 };
            FilterSettings { kind, adaptation, fading: 1.002, ..usual.clone() }
        }));
    }
    for propagation in Propagation::ALL {
        let set = FilterSettings { propagation: Some(propagation), fading: 1.002, ..usual.clone() };
        cases.extend([0.0, 0.02].map(|eta| FilterSettings { eta, ..set.clone() }));
    }
    let iterated = FilterSettings { kind: FilterKind::IEKF, fading: 1.002, ..usual };
    cases.extend([1, 2, 3, 20].map(|iterations| FilterSettings { iterations, ..iterated.clone() }));
    for plant in written() {
        let has_all = [PlantKind::SDOF, PlantKind::DUFFING, PlantKind::SHEAR_2].contains(&plant);
        for settings in if has_all { &cases } else { &plain } {
            let duration = if has_all { 1.2 } else { 0.6 };
            let mut scenario = Scenario { duration, ..scenario(plant.clone(), settings.kind) };
            let sensor_std = scenario.filters[0].sensor_std.clone();
            scenario.filters = vec![FilterSettings { sensor_std, ..settings.clone() }];
            // The residual assumes sensors linear in the state, so that R is compared for these only.
            if settings.adaptation.sensor_noise {
                scenario.remove_sensor(Quantity::ACCELERATION);
                scenario.filters[0].sensor_std = vec![0.02];
            }
            let record = simulate(&scenario);
            // Missing is the first sensor, the second, or both in turn.
            let gaps = record.clone().with_gaps(|sensor, k| (k / 7 + sensor).is_multiple_of(3) || k % 50 < 9);
            for record in std::iter::once(record).chain(Some(gaps).filter(|_| has_all)) {
                let run = finished_on(&scenario, record);
                let deviation = deviation(&run.estimates()[0], &filter(&scenario, 0, run.record()));
                assert!(deviation < TOLERANCE, "{deviation:.1e} of a {}: {settings:?}", plant.name());
            }
        }
    }
}

#[test]
fn a_linear_filter_may_follow_any_truth() {
    for truth in plants() {
        for kind in FilterKind::ALL {
            let mut scenario = Scenario { duration: 3.0, ..scenario(truth.clone(), kind) };
            scenario.filters[0].plant = Some(PlantKind::SDOF);
            let run = finished(&scenario);
            let estimates = &run.estimates()[0];
            assert_eq!((estimates.stop(), estimates.len()), (None, run.len()), "{} on {}", kind.name(), truth.name());
            assert_eq!(estimates.channels(), PlantKind::SDOF.channels());
            if DETERMINISTIC.contains(&kind) {
                let deviation = deviation(estimates, &filter(&scenario, 0, run.record()));
                assert!(deviation < 1e-8, "{} on {}: {deviation}", kind.name(), truth.name());
            }
        }
    }
}

#[test]
fn sensors_that_the_filters_plant_does_not_have_are_ignored() {
    for kind in FilterKind::ALL {
        let mut scenario = Scenario { duration: 3.0, ..scenario(PlantKind::SHEAR_2, kind) };
        scenario.filters[0].plant = Some(PlantKind::SDOF);
        let without = finished(&scenario);
        for measures in [Quantity::new(Aspect::DISPLACEMENT, 1), Quantity::new(Aspect::ACCELERATION, 1)] {
            scenario.add_sensor(Sensor::new(measures, 0.01));
        }
        let with = finished(&scenario);
        let (a, b) = (&without.estimates()[0], &with.estimates()[0]);
        assert_eq!(beliefs(a), beliefs(b), "{}", kind.name());
        assert!((0..b.len()).all(|k| b.innovation(k)[2..].iter().all(|e| e.is_nan())));
    }
}

#[test]
fn logarithms_keep_a_wild_guess_positive() {
    let mut went_negative = 0;
    use FilterKind as Kind;
    for kind in [Kind::EKF, Kind::UKF, Kind::SR_UKF, Kind::CKF, Kind::ENKF, Kind::PF] {
        for seed in 1..=3 {
            let mut scenario = Scenario { seed, duration: 10.0, ..scenario(PlantKind::SDOF, kind) };
            scenario.plant.set(Channel::DAMPING_RATIO, 0.005);
            let settings = &mut scenario.filters[0];
            settings.initial_mean[Channel::DAMPING_RATIO] = 0.05;
            settings.initial_std[Channel::DAMPING_RATIO] = 0.2;
            let log = FilterSettings { log_parameters: true, ..settings.clone() };
            scenario.filters.push(log);
            let run = finished(&scenario);
            let [plain, log] = run.estimates() else { unreachable!("two filters") };
            let lowest = |e: &Estimates| (0..e.len()).map(|k| e.mean(k)[3].min(e.mean(k)[2])).fold(f64::MAX, f64::min);
            went_negative += usize::from(lowest(plain) < 0.0);
            assert!(lowest(log) > 0.0, "{} {seed}", kind.name());
        }
    }
    assert!(went_negative > 6, "{went_negative}");
}

fn linear(kind: FilterKind, sizes: &[usize], seed: u64, fading: f64) -> Scenario {
    let mut scenario = Scenario { seed, dt: 0.02, duration: 4.0, plant: oscillator(6.0, 0.05), ..Scenario::default() };
    scenario.plant.disturbance_std = 3.0;
    let known = FilterSettings {
        fading,
        sensor_std: vec![0.01, 0.06],
        initial_mean: values([0.05, -0.1, 6.0, 0.05]),
        initial_std: values([0.05, 0.2, 0.0, 0.0]),
        process_std: values([1e-3, 0.06, 0.0, 0.0]),
        ..FilterSettings::default()
    };
    let kf = FilterSettings { kind: FilterKind::KF, ..known.clone() };
    let sampled = sizes.iter().map(|&ensemble_size| FilterSettings { kind, ensemble_size, ..known.clone() });
    scenario.filters = std::iter::once(kf).chain(sampled).collect();
    scenario
}

/// Root mean squares, over a record, of a filter's deviation from the KF: means in standard deviations, standard deviations relative
/// to the KF's; and the mean difference of the log likelihoods.
fn error(kf: &Estimates, other: &Estimates) -> [f64; 3] {
    assert_eq!((other.stop(), other.len()), (None, kf.len()), "{}", other.name());
    let each = |of: &dyn Fn(usize, usize) -> f64| -> Vec<f64> {
        (1..kf.len()).flat_map(|k| [0, 1].map(|i| of(k, i))).collect()
    };
    let means = each(&|k, i| (other.mean(k)[i] - kf.mean(k)[i]) / kf.std(k, i));
    let stds = each(&|k, i| other.std(k, i) / kf.std(k, i) - 1.0);
    let log_likelihood = (1..kf.len()).map(|k| other.log_likelihood(k) - kf.log_likelihood(k)).sum::<f64>();
    [rms(&means), rms(&stds), log_likelihood / kf.len() as f64]
}

fn errors(run: &Run) -> Vec<[f64; 3]> {
    let [kf, others @ ..] = run.estimates() else { unreachable!("there is a KF") };
    others.iter().map(|other| error(kf, other)).collect()
}

const SAMPLED: [FilterKind; 2] = [FilterKind::ENKF, FilterKind::PF];

#[test]
fn two_thousand_members_are_nearly_a_kalman_filter() {
    for kind in SAMPLED {
        for (seed, fading) in [(1, 1.0), (2, 1.002), (3, 1.02)] {
            for [mean, std, log_likelihood] in errors(&finished(&linear(kind, &[2000], seed, fading))) {
                let what = format!("{} {seed}: mean {mean}, std {std}, log likelihood {log_likelihood}", kind.name());
                assert!(mean < 0.09 && std < 0.06 && log_likelihood.abs() < 0.02, "{what}");
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
                (square[0], square[1]) = (square[0] + error[0] * error[0], square[1] + error[1] * error[1]);
            }
        }
        for pair in squares.windows(2) {
            let ratios = [0, 1].map(|which| (pair[0][which] / pair[1][which]).sqrt());
            // √10 times smaller for ten times as many.
            assert!(ratios.iter().all(|ratio| (2.2..4.5).contains(ratio)), "{}: {ratios:?}", kind.name());
        }
    }
}
