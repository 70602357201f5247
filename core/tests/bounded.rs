//! Filters whose parameters have bounds, and filters that count the uncertainty of some parameters without estimating them.

use kalmanscope_core::filter::{Matrix, Robust, Vector};
use kalmanscope_core::scenario::{Between, Bounds};
use kalmanscope_core::{
    Channel, FilterKind, FilterSettings, Pass, Quantity, Record, Sample, Scenario, Sensor, simulate,
};

use crate::numbers::{ADAPTIVE, Random, distance};
use crate::run::{Each, after_events, finished, finished_on, last, one_filter, oscillator, values};

fn between(least: f64, most: f64) -> Between {
    let end = |end: f64| Some(end).filter(|end| end.is_finite());
    Between { least: end(least), most: end(most) }
}

fn bounds(all: &[(Channel, f64, f64)]) -> Bounds {
    let mut bounds = Bounds::default();
    all.iter().for_each(|&(channel, least, most)| bounds.set(channel, between(least, most)));
    bounds
}

const MEAN: f64 = 0.0;
const STD: f64 = 0.01;
const NOISE: f64 = 0.8;

fn still(seed: u64) -> Scenario {
    let mut random = Random::new(seed);
    let damping = std::iter::repeat_with(|| MEAN + STD * random.normal()).find(|damping| *damping >= 0.0).unwrap();
    let mut scenario = Scenario { seed, duration: 10.0, ..Scenario::default() };
    scenario.plant.set(Channel::DAMPING_RATIO, damping);
    scenario.sensors = vec![Sensor { noise_std: NOISE, ..scenario.sensors[0] }];
    let filter = FilterSettings {
        initial_mean: values([0.0, 0.0, 6.0, MEAN]),
        initial_std: values([0.1, 0.3, 0.02, STD]),
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
    // The normal belief of the gain, cut off at its ends; the other components follow it by regression.
    let (mean, std) = (free.mean(last)[gain], free.std(last, gain));
    let [least, most] = [0.9, 1.15].map(|end| (end - mean) / std);
    let at = |i: u32| least + (most - least) * (f64::from(i) + 0.5) / 1e5;
    let moment = |power: i32| (0..100_000).map(at).map(|u| u.powi(power) * (-0.5 * u * u).exp()).sum::<f64>();
    let [all, first, second] = [0, 1, 2].map(moment);
    let (shift, spread) = (first / all, second / all - (first / all).powi(2));
    for i in 0..n {
        let slope = free.cov(last)[i * n + gain] / std;
        let expected = (slope * shift, (free.std(last, i).powi(2) - slope * slope * (1.0 - spread)).sqrt());
        let found = (bounded.mean(last)[i] - free.mean(last)[i], bounded.std(last, i));
        let is_near = |a: f64, b: f64| (a - b).abs() <= 1e-6 * free.std(last, i);
        assert!(is_near(found.0, expected.0) && is_near(found.1, expected.1), "{i}: {found:?}, {expected:?}");
    }
    assert!(bounded.std(last, gain) < 0.7 * free.std(last, gain), "the ends tell more than the readings here");
    for k in 1..=last {
        assert_eq!(bounded.innovation(k), free.innovation(k), "the filter itself goes on as it was");
    }
}

/// No choice depends on these records.
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
    for kind in ADAPTIVE {
        let mut scenario = Scenario { duration: 20.0, ..one_filter(kind) };
        let filter = &mut scenario.filters[0];
        (filter.fading, filter.smoother) = (1.001, true);
        // The truth, 6 rad/s and 0.05, is outside both.
        filter.bounds = bounds(&[(Channel::NATURAL_FREQUENCY, 6.5, 9.0), (Channel::DAMPING_RATIO, 0.0, 0.03)]);
        filter.initial_mean[Channel::DAMPING_RATIO] = 0.02;
        let run = finished(&scenario);
        let estimates = &run.estimates()[0];
        assert_eq!(estimates.stop(), None, "{kind:?}");
        let smoothed = &run.smoothed()[0];
        for (k, mean) in [estimates, smoothed].into_iter().flat_map(|of| (0..of.len()).map(|k| (k, of.mean(k)))) {
            assert!((6.5..=9.0).contains(&mean[2]) && (0.0..=0.03).contains(&mean[3]), "{kind:?} {k}: {mean:?}");
        }
        for k in 0..estimates.len() {
            let cov = nalgebra::DMatrix::from_row_slice(4, 4, estimates.cov(k));
            assert!(cov.clone().symmetric_eigenvalues().min() > -1e-12 * cov.amax(), "{kind:?} {k}");
        }
        // The same by events.
        let events = after_events(&scenario, run.record());
        let sample = events.sample();
        let far = distance([sample.mean, sample.cov], estimates, estimates.len() - 1);
        assert!(far < 1e-6, "{kind:?}: {far}");
    }
}

#[test]
fn bounds_are_written_and_read() {
    let text = "[[filters]]\nkind = \"ekf\"\nbounds = { damping_ratio = { least = 0.0 }, natural_frequency = { least = 1.0, most = 20.0 } }";
    let scenario = Scenario::from_toml(text).unwrap();
    assert_eq!(scenario.filters[0].bounds.of(Channel::NATURAL_FREQUENCY), between(1.0, 20.0));
    assert_eq!(Scenario::from_toml(&scenario.to_toml().unwrap()).unwrap(), scenario);
    let mut with_sensor = Bounds::default();
    with_sensor.set(Quantity::DISPLACEMENT.bias(), between(f64::NEG_INFINITY, f64::INFINITY));
    assert!(with_sensor.is_empty(), "open bounds are none");
}

fn assert_schmidt(sample: &Sample<'_>, h: &Matrix, r: &Matrix, considered: [usize; 2]) {
    let n = sample.mean.len();
    let matrix = |of: &[f64], columns: usize| Matrix::from_column_slice(of.len() / columns, columns, of);
    let (before, prior) = (Vector::from_column_slice(sample.prior_mean), matrix(sample.prior_cov, n));
    let s = h * &prior * h.transpose() + r;
    let mut gain = &prior * h.transpose() * s.try_inverse().unwrap();
    considered.iter().for_each(|&place| gain.row_mut(place).fill(0.0));
    let less = Matrix::identity(n, n) - &gain * h;
    let cov = &less * &prior * less.transpose() + &gain * r * gain.transpose();
    let mean = before + &gain * Vector::from_column_slice(sample.innovation);
    assert!((Vector::from_column_slice(sample.mean) - mean).amax() < 1e-10);
    assert!((matrix(sample.cov, n) - cov).amax() < 1e-10);
    assert!((matrix(sample.gain, 2) - gain).amax() < 1e-9);
}

#[test]
fn an_update_is_that_of_schmidt() {
    let bias = Quantity::DISPLACEMENT.bias();
    for kind in [FilterKind::EKF, FilterKind::UKF, FilterKind::SR_UKF] {
        let mut scenario = Scenario { duration: 1.0, ..one_filter(kind) };
        let filter = &mut scenario.filters[0];
        (filter.augment, filter.fading) = (vec![bias], 1.0);
        filter.initial_std[bias] = 0.05;
        filter.consider = vec![Channel::DAMPING_RATIO, bias];
        let variances: Vec<f64> = filter.sensor_std.iter().map(|std| std * std).collect();
        let mut h = Matrix::zeros(2, 5);
        (h[(0, 0)], h[(0, 4)], h[(1, 1)]) = (1.0, 1.0, 1.0);
        let r = Matrix::from_diagonal(&Vector::from(variances));
        let mut updates = 0;
        let assert = |sample: &Sample<'_>| {
            if !sample.nis.is_nan() {
                assert_schmidt(sample, &h, &r, [3, 4]);
                updates += 1;
            }
        };
        let mut sink = Each { wants_prior: true, call: assert };
        let record = simulate(&scenario).without_truth();
        Pass::new(&scenario, 0, &record).unwrap().follow(&record, record.len(), &mut sink);
        assert_eq!(updates, record.len() - 1, "{kind:?}");
    }
}

fn shaken(seed: u64) -> (Scenario, Record) {
    let mut scenario = Scenario { seed, duration: 20.0, plant: oscillator(6.0, 0.05), ..Scenario::default() };
    scenario.sensors = vec![Sensor::new(Quantity::DISPLACEMENT, 0.01)];
    scenario.filters.clear();
    let gain = 1.0 + 0.15 * [1.1, -0.4, 0.7, -1.5, 0.2, -0.9, 1.6, -0.1, 0.5, -1.2][seed as usize % 10];
    scenario.plant.set(Channel::INPUT_GAIN, gain);
    let considered = vec![Channel::INPUT_GAIN];
    for (std, consider, fading) in
        [(0.0, vec![], 1.0), (0.15, vec![], 1.0), (0.15, considered.clone(), 1.0), (0.15, considered, 1.003)]
    {
        let mut filter = FilterSettings { augment: vec![Channel::INPUT_GAIN], consider, ..FilterSettings::default() };
        (filter.sensor_std, filter.fading) = (vec![0.01], fading);
        filter.initial_mean[Channel::NATURAL_FREQUENCY] = 6.2;
        filter.initial_std[Channel::NATURAL_FREQUENCY] = 0.3;
        filter.initial_std[Channel::INPUT_GAIN] = std;
        filter.process_std[Channel::INPUT_GAIN] = 0.0;
        scenario.filters.push(filter);
    }
    scenario.number_filters();
    scenario.validate().unwrap();
    let record = simulate(&scenario);
    (scenario, record)
}

#[test]
fn a_gain_that_is_considered_keeps_its_band_and_makes_the_others_honest() {
    let mut inside = [0; 4];
    for seed in 0..20 {
        let (scenario, record) = shaken(seed);
        let run = finished_on(&scenario, record);
        for (filter, inside) in run.estimates().iter().zip(&mut inside) {
            let truth = run.record().truth(Channel::DAMPING_RATIO).unwrap()[filter.len() - 1];
            let (mean, std) = last(filter, Channel::DAMPING_RATIO);
            *inside += u32::from((mean - truth).abs() < 2.0 * std);
        }
        for considered in &run.estimates()[2..] {
            let place = considered.place(Channel::INPUT_GAIN).unwrap();
            for k in 0..considered.len() {
                assert!(considered.mean(k)[place] == 1.0 && (considered.std(k, place) - 0.15).abs() < 1e-9);
                assert_eq!(considered.gain(k)[place], 0.0);
            }
            assert!(considered.considers(Channel::INPUT_GAIN));
        }
    }
    let is_honest = inside[0] < 12 && inside[1..].iter().all(|inside| *inside >= 18);
    assert!(is_honest, "{inside:?} of 20 bands of ζ have the truth");
}

#[test]
fn every_filter_that_may_consider_a_gain_leaves_it_alone() {
    let (mut scenario, record) = shaken(3);
    scenario.filters.drain(..2);
    let record = std::sync::Arc::new(record);
    let kinds = FilterKind::ALL.into_iter().filter(|kind| !kind.is_sampled());
    for (kind, robust) in kinds.flat_map(|kind| Robust::ALL.map(|rule| (kind, rule))) {
        for filter in &mut scenario.filters {
            (filter.kind, filter.robust) = (kind, robust);
        }
        let run = finished_on(&scenario, record.clone());
        let alone = Scenario { filters: scenario.filters[1..].to_vec(), ..scenario.clone() };
        let mut events = after_events(&alone, &record);
        for estimates in run.estimates() {
            assert_eq!((estimates.stop(), estimates.len()), (None, record.len()), "{kind:?} {robust:?}");
            let (mean, std) = last(estimates, Channel::INPUT_GAIN);
            assert!(mean == 1.0 && (std - 0.15).abs() < 1e-9, "{kind:?} {robust:?}: {mean} ± {std}");
        }
        // A filter that follows events does the same, and one that forgets.
        let estimates = &run.estimates()[1];
        let n = estimates.channels().len();
        let sample = events.take(record.time(record.len()), f64::NAN, &[f64::NAN]).unwrap();
        let place = estimates.place(Channel::INPUT_GAIN).unwrap();
        assert!(sample.mean[place] == 1.0 && (sample.cov[place * (n + 1)].sqrt() - 0.15).abs() < 1e-9, "{kind:?}");
    }
}
