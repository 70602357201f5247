//! Filters that count the uncertainty of some parameters without estimating them.

use kalmanscope_core::filter::{Matrix, Robust, Vector};
use kalmanscope_core::{
    Channel, EventFilter, FilterKind, FilterSettings, Pass, Quantity, Record, Sample, Scenario, Sensor, Sink, Stop,
    simulate,
};

use crate::run::{finished_on, last, one_filter};

/// Holds each update to the formula of Schmidt with H, R and the places of what is considered.
struct Schmidt {
    h: Matrix,
    r: Matrix,
    considered: [usize; 2],
    updates: usize,
}

impl Sink for Schmidt {
    fn push(&mut self, sample: &Sample<'_>) {
        if sample.nis.is_nan() {
            return;
        }
        let Self { h, r, considered, updates } = self;
        let n = sample.mean.len();
        let matrix = |of: &[f64], columns: usize| Matrix::from_column_slice(of.len() / columns, columns, of);
        let (before, prior) = (Vector::from_column_slice(sample.prior_mean), matrix(sample.prior_cov, n));
        let s = &*h * &prior * h.transpose() + &*r;
        let mut gain = &prior * h.transpose() * s.try_inverse().unwrap();
        considered.iter().for_each(|&place| gain.row_mut(place).fill(0.0));
        let less = Matrix::identity(n, n) - &gain * &*h;
        let cov = &less * &prior * less.transpose() + &gain * &*r * gain.transpose();
        let mean = before + &gain * Vector::from_column_slice(sample.innovation);
        assert!((Vector::from_column_slice(sample.mean) - mean).amax() < 1e-10, "update {updates}");
        assert!((matrix(sample.cov, n) - cov).amax() < 1e-10, "update {updates}");
        assert!((matrix(sample.gain, 2) - gain).amax() < 1e-9, "update {updates}");
        *updates += 1;
    }

    fn stop_at(&mut self, stop: Stop) {
        panic!("{stop:?}");
    }

    fn wants_prior(&self) -> bool {
        true
    }
}

#[test]
fn an_update_is_that_of_schmidt() {
    let bias = Quantity::DISPLACEMENT.bias();
    for kind in [FilterKind::EKF, FilterKind::UKF, FilterKind::SR_UKF] {
        let mut scenario = Scenario { duration: 1.0, ..one_filter(FilterKind::EKF) };
        let filter = &mut scenario.filters[0];
        (filter.kind, filter.augment, filter.fading) = (kind, vec![bias], 1.0);
        filter.initial_std[bias] = 0.05;
        filter.consider = vec![Channel::DAMPING_RATIO, bias];
        let variances: Vec<f64> = filter.sensor_std.iter().map(|std| std * std).collect();
        let mut h = Matrix::zeros(2, 5);
        (h[(0, 0)], h[(0, 4)], h[(1, 1)]) = (1.0, 1.0, 1.0);
        let mut sink =
            Schmidt { h, r: Matrix::from_diagonal(&Vector::from(variances)), considered: [3, 4], updates: 0 };
        let record = simulate(&scenario).without_truth();
        Pass::new(&scenario, 0, &record).unwrap().follow(&record, record.len(), &mut sink);
        assert_eq!(sink.updates, record.len() - 1, "{kind:?}");
    }
}

/// An input with another gain for each seed, which filters know, estimate, consider, or consider and forget.
fn shaken(seed: u64) -> (Scenario, Record) {
    let mut scenario = Scenario { seed, duration: 20.0, filters: Vec::new(), ..Scenario::default() };
    scenario.plant.set(Channel::NATURAL_FREQUENCY, 6.0);
    scenario.sensors.clear();
    scenario.add_sensor(Sensor::new(Quantity::DISPLACEMENT, 0.01));
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
    assert!(
        inside[0] < 12 && inside[1] >= 18 && inside[2] >= 18 && inside[3] >= 18,
        "{inside:?} of 20 bands of ζ have the truth"
    );
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
        let mut events = EventFilter::new(&scenario, 1).unwrap();
        for k in 0..record.len() {
            events.take(record.time(k), record.input()[k], &[record.measured(0)[k]]).unwrap();
        }
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

#[test]
fn what_does_not_go_with_it_is_refused_in_words() {
    let (scenario, _) = shaken(0);
    let with = |change: &dyn Fn(&mut FilterSettings)| {
        let mut scenario = scenario.clone();
        change(&mut scenario.filters[2]);
        scenario.validate().map_err(|error| error.to_string())
    };
    assert_eq!(with(&|_| ()), Ok(()));
    type Change = fn(&mut FilterSettings);
    let all: [(&str, Change); 5] = [
        ("jumps", |filter| filter.jump = true),
        ("learns noise", |filter| filter.adaptation.process_noise = true),
        ("smoother", |filter| filter.smoother = true),
        ("samples its belief", |filter| filter.kind = FilterKind::ENKF),
        ("several guesses", |filter| filter.guesses = 3),
    ];
    for (words, change) in all {
        let error = with(&change).unwrap_err();
        assert!(error.contains("consider") && error.contains(words), "{error}");
    }
    let unknown = with(&|filter| filter.consider = vec![Channel::DISPLACEMENT]).unwrap_err();
    assert!(unknown.contains("filters[2].consider[0]"), "{unknown}");
    let known = with(&|filter| (filter.kind, filter.consider) = (FilterKind::KF, vec![Channel::DAMPING_RATIO]));
    assert!(known.unwrap_err().contains("does not know"));
}
