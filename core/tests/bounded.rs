//! Filters whose parameters have bounds.

use kalmanscope_core::scenario::{Between, Bounds};
use kalmanscope_core::{
    Channel, EventFilter, FilterKind, FilterSettings, Quantity, Scenario, Sensor, Signal, simulate,
};

use crate::random::Random;
use crate::run::{finished, one_filter};

fn between(least: f64, most: f64) -> Between {
    let end = |end: f64| Some(end).filter(|end| end.is_finite());
    Between { least: end(least), most: end(most) }
}

fn bounds(all: &[(Channel, f64, f64)]) -> Bounds {
    let mut bounds = Bounds::default();
    all.iter().for_each(|&(channel, least, most)| bounds.set(channel, between(least, most)));
    bounds
}

/// The initial belief of a damping that is small, and known not to be negative.
const MEAN: f64 = 0.0;
const STD: f64 = 0.01;
const NOISE: f64 = 0.8;

/// An oscillator whose damping is drawn from the initial belief between its ends, of which ten noisy seconds tell little.
fn still(seed: u64) -> Scenario {
    let mut scenario = Scenario { seed, duration: 10.0, ..Scenario::default() };
    let mut random = Random::new(seed);
    let damping = std::iter::repeat_with(|| MEAN + STD * random.normal()).find(|damping| *damping >= 0.0).unwrap();
    scenario.plant.set(Channel::DAMPING_RATIO, Signal::Constant(damping));
    scenario.sensors = vec![Sensor { noise_std: NOISE, ..scenario.sensors[0] }];
    let filter = FilterSettings {
        initial_mean: scenario.filters[0]
            .initial_mean
            .clone()
            .with([(Channel::DAMPING_RATIO, MEAN), (Channel::NATURAL_FREQUENCY, 6.0)]),
        initial_std: scenario.filters[0]
            .initial_std
            .clone()
            .with([(Channel::DAMPING_RATIO, STD), (Channel::NATURAL_FREQUENCY, 0.02)]),
        sensor_std: vec![NOISE],
        fading: 1.0,
        ..scenario.filters[0].clone()
    };
    let bounded = FilterSettings {
        id: 2,
        name: "bounded".to_owned(),
        bounds: bounds(&[(Channel::DAMPING_RATIO, 0.0, f64::INFINITY)]),
        ..filter.clone()
    };
    scenario.filters = vec![filter, bounded];
    scenario
}

/// A million draws have these moments, and the filter continues as without the ends.
#[test]
fn what_is_told_is_the_belief_between_the_ends() {
    let mut scenario = Scenario { duration: 0.15, ..Scenario::default() };
    let mut filter = FilterSettings {
        kind: FilterKind::KF,
        augment: vec![Channel::INPUT_GAIN],
        initial_mean: scenario.filters[0].initial_mean.clone().with([(Channel::INPUT_GAIN, 1.05)]),
        initial_std: scenario.filters[0].initial_std.clone().with([(Channel::INPUT_GAIN, 0.2)]),
        fading: 1.0,
        ..scenario.filters[0].clone()
    };
    let free = filter.clone();
    (filter.id, filter.name) = (2, "bounded".to_owned());
    filter.bounds = bounds(&[(Channel::INPUT_GAIN, 0.9, 1.15)]);
    scenario.filters = vec![free, filter];
    let run = finished(&scenario);
    let [free, bounded] = [0, 1].map(|place| &run.estimates()[place]);
    let (last, n) = (free.len() - 1, free.channels().len());
    let gain = free.place(Channel::INPUT_GAIN).unwrap();
    let root = nalgebra::DMatrix::from_row_slice(n, n, free.cov(last));
    let moving: Vec<usize> = (0..n).filter(|&i| root[(i, i)] > 0.0).collect();
    let root = root.select_rows(&moving).select_columns(&moving).cholesky().unwrap().l();
    let mut random = Random::new(3);
    let (mut count, mut sums) = (0.0, vec![[0.0; 2]; n]);
    for _ in 0..1_000_000 {
        let normal = nalgebra::DVector::from_fn(moving.len(), |_, _| random.normal());
        let drawn = &root * normal;
        let at = moving.iter().position(|&i| i == gain).unwrap();
        if !(0.9..=1.15).contains(&(free.mean(last)[gain] + drawn[at])) {
            continue;
        }
        count += 1.0;
        for (&i, x) in moving.iter().zip(drawn.iter()) {
            sums[i] = [sums[i][0] + x, sums[i][1] + x * x];
        }
    }
    for &i in &moving {
        let [mean, square] = sums[i].map(|sum| sum / count);
        let std = (square - mean * mean).sqrt();
        let found = (bounded.mean(last)[i] - free.mean(last)[i], bounded.std(last, i));
        assert!(
            (found.0 - mean).abs() < 0.01 * std && (found.1 / std - 1.0).abs() < 0.01,
            "{i}: {found:?}, {mean} {std}"
        );
    }
    assert!(bounded.std(last, gain) < 0.7 * free.std(last, gain), "the ends tell more than the readings here");
    for k in 1..=last {
        assert_eq!(bounded.innovation(k), free.innovation(k), "the filter itself goes on as it was");
    }
}

/// On records that were not looked at, no estimate is beyond the end, errors are smaller, and bands are right.
#[test]
fn a_damping_that_cannot_be_negative_is_better_and_honestly_known() {
    let (mut negative, mut squares, mut inside, mut worst) = (0, [0.0; 2], [0; 2], f64::INFINITY);
    for seed in 201..=400 {
        let scenario = still(seed);
        let truth = scenario.plant.parameter(Channel::DAMPING_RATIO).unwrap().at(0.0);
        let run = finished(&scenario);
        let last = run.record().len() - 1;
        for (place, estimates) in run.estimates().iter().enumerate() {
            let damping = estimates.place(Channel::DAMPING_RATIO).unwrap();
            let error = estimates.canonical_mean(last, damping) - truth;
            squares[place] += error * error;
            inside[place] += usize::from(error.abs() <= 2.0 * estimates.std(last, damping));
            if place == 0 {
                negative += usize::from(estimates.mean(last)[damping] < 0.0);
            } else {
                worst = (0..=last).map(|k| estimates.mean(k)[damping]).fold(worst, f64::min);
            }
        }
    }
    assert!(negative > 25, "{negative}: the records must be hard");
    assert!(worst >= 0.0, "{worst}");
    assert!(squares[1] < 0.8 * squares[0], "{squares:?}");
    assert!(inside[1] >= 186, "{inside:?}");
}

#[test]
fn every_filter_keeps_within_its_bounds() {
    for kind in [FilterKind::EKF, FilterKind::IEKF, FilterKind::UKF, FilterKind::CKF, FilterKind::SR_UKF] {
        let mut scenario = Scenario { duration: 20.0, ..one_filter(FilterKind::EKF) };
        let filter = &mut scenario.filters[0];
        (filter.kind, filter.fading, filter.smoother) = (kind, 1.001, true);
        // The truth, 6 rad/s and 0.05, is outside both.
        filter.bounds = bounds(&[(Channel::NATURAL_FREQUENCY, 6.5, 9.0), (Channel::DAMPING_RATIO, 0.0, 0.03)]);
        filter.initial_mean = filter.initial_mean.clone().with([(Channel::DAMPING_RATIO, 0.02)]);
        let run = finished(&scenario);
        let estimates = &run.estimates()[0];
        assert_eq!(estimates.stop(), None, "{kind:?}");
        for k in 0..estimates.len() {
            let mean = estimates.mean(k);
            assert!((6.5..=9.0).contains(&mean[2]) && (0.0..=0.03).contains(&mean[3]), "{kind:?} {k}: {mean:?}");
            let cov = nalgebra::DMatrix::from_row_slice(4, 4, estimates.cov(k));
            assert!(cov.clone().symmetric_eigenvalues().min() > -1e-12 * cov.amax(), "{kind:?} {k}");
        }
        let smoothed = &run.smoothed()[0];
        for k in 0..smoothed.len() {
            let mean = smoothed.mean(k);
            assert!((6.5..=9.0).contains(&mean[2]) && (0.0..=0.03).contains(&mean[3]), "{kind:?} {k}: {mean:?}");
        }
        // The same by events.
        let record = simulate(&scenario);
        let mut events = EventFilter::new(&scenario, 0).unwrap();
        for k in 0..record.len() {
            let readings = [record.measured(0)[k], record.measured(1)[k]];
            events.take(record.time(k), record.input()[k], &readings).unwrap();
        }
        let last = estimates.len() - 1;
        let far = (0..4).map(|i| (events.sample().mean[i] - estimates.mean(last)[i]).abs() / estimates.std(last, i));
        assert!(far.fold(0.0, f64::max) < 1e-6, "{kind:?}");
    }
}

#[test]
fn bounds_are_written_and_read_and_impossible_ones_refused_in_words() {
    let text = "[[filters]]\nkind = \"ekf\"\nbounds = { damping_ratio = { least = 0.0 }, natural_frequency = { least = 1.0, most = 20.0 } }";
    let scenario = Scenario::from_toml(text).unwrap();
    assert_eq!(scenario.filters[0].bounds.of(Channel::NATURAL_FREQUENCY), between(1.0, 20.0));
    assert_eq!(Scenario::from_toml(&scenario.to_toml().unwrap()).unwrap(), scenario);
    let refused = |filter: &str| Scenario::from_toml(&format!("[[filters]]\n{filter}")).unwrap_err().to_string();
    let zeta = "bounds = { damping_ratio = { least = 0.0 } }";
    for (filter, words) in [
        (format!("kind = \"enkf\"\n{zeta}"), "samples its belief"),
        (format!("kind = \"ekf\"\nlog_parameters = true\n{zeta}"), "logarithms"),
        (format!("kind = \"kf\"\n{zeta}"), "no parameter that the filter does not know"),
        ("kind = \"ekf\"\nbounds = { velocity = { least = 0.0 } }".to_owned(), "no parameter"),
        ("kind = \"ekf\"\nbounds = { damping_ratio = { least = 0.2, most = 0.1 } }".to_owned(), "to a larger one"),
        ("kind = \"ekf\"\nbounds = { damping_ratio = { least = 0.2 } }".to_owned(), "between its bounds"),
        ("kind = \"ekf\"\nbounds = { damping_ratio = { lest = 0.2 } }".to_owned(), "`least`"),
        ("kind = \"ekf\"\nbounds = { damping = { least = 0.2 } }".to_owned(), "damping"),
    ] {
        let error = refused(&filter);
        assert!(error.contains(words), "{filter}: {error}");
    }
    let mut with_sensor = Bounds::default();
    with_sensor.set(Quantity::DISPLACEMENT.bias(), between(f64::NEG_INFINITY, f64::INFINITY));
    assert!(with_sensor.is_empty(), "open bounds are none");
}
