//! Filters side by side: a bank of still and walking parameters, several guesses of the natural frequency, and model classes.

use kalmanscope_core::signal::{Signal, Step};
use kalmanscope_core::{
    Channel, Estimates, Evidence, FilterKind, FilterSettings, ModelClasses, Quantity, Record, Run, Scenario, Sensor,
    simulate,
};
use nalgebra::{DMatrix, DVector};

use crate::numbers::{ADAPTIVE, farthest, joint_motion, log_normal};
use crate::oracles::textbook::Textbook;
use crate::run::{finished, finished_on, knowing, last, one_filter, oscillator, values};

fn scenario(kind: FilterKind, walk: f64) -> Scenario {
    let mut scenario = Scenario { duration: 20.0, ..one_filter(kind) };
    let step = Step { from: 6.0, to: 4.5, at: 10.0 };
    scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Step(step));
    let filter = &mut scenario.filters[0];
    (filter.fading, filter.walk, filter.process_std) = (1.0, walk, values([0.0, 1e-3, 0.0, 0.0]));
    scenario
}

type Belief = (DVector<f64>, DMatrix<f64>);

struct Book<'a> {
    filters: [Textbook<'a>; 2],
    probability: [f64; 2],
    transition: [[f64; 2]; 2],
}

fn members(scenario: &Scenario) -> [FilterSettings; 2] {
    let still = FilterSettings { walk: 0.0, ..scenario.filters[0].clone() };
    let mut walking = still.clone();
    for channel in scenario.plant.kind.channels().iter().copied().filter(|channel| channel.is_parameter()) {
        let w = scenario.filters[0].walk * still.initial_std[channel];
        walking.process_std[channel] = (still.process_std[channel].powi(2) + w * w * scenario.dt).sqrt();
    }
    [still, walking]
}

impl<'a> Book<'a> {
    fn new(scenario: &'a Scenario, members: &'a [FilterSettings; 2]) -> Self {
        let turns = scenario.filters[0].initial_mean[Channel::NATURAL_FREQUENCY] * scenario.dt / std::f64::consts::TAU;
        let (a, b) = (turns / 30.0, turns);
        let filters = members.each_ref().map(|settings| Textbook::new(scenario, settings, scenario.dt));
        Self { filters, probability: [1.0, 0.0], transition: [[1.0 - a, a], [b, 1.0 - b]] }
    }

    fn step(&mut self, record: &Record, k: usize) -> Belief {
        let old = self.filters.each_ref().map(|filter| (filter.mean.clone(), filter.cov.clone()));
        let before = [0, 1].map(|j| (0..2).map(|i| self.transition[i][j] * self.probability[i]).sum::<f64>());
        let mut likelihoods = [1.0; 2];
        for j in 0..2 {
            let weights = [0, 1].map(|i| self.transition[i][j] * self.probability[i] / before[j]);
            let filter = &mut self.filters[j];
            (filter.mean, filter.cov) = mixture(weights, &old);
            let (_, log_likelihood) = filter.step(record, k);
            if !log_likelihood.is_nan() {
                likelihoods[j] = log_likelihood.exp();
            }
        }
        let sum: f64 = (0..2).map(|j| before[j] * likelihoods[j]).sum();
        self.probability = [0, 1].map(|j| before[j] * likelihoods[j] / sum);
        mixture(self.probability, &self.filters.each_ref().map(|filter| (filter.mean.clone(), filter.cov.clone())))
    }
}

fn mixture(weights: [f64; 2], [(a, p), (b, q)]: &[Belief; 2]) -> Belief {
    let mean = a * weights[0] + b * weights[1];
    let spread = |cov: &DMatrix<f64>, of: &DVector<f64>| cov + (of - &mean) * (of - &mean).transpose();
    (mean.clone(), spread(p, a) * weights[0] + spread(q, b) * weights[1])
}

#[test]
fn it_is_that_of_the_book() {
    for kind in [FilterKind::EKF, FilterKind::UKF] {
        let scenario = scenario(kind, 0.3);
        let record = simulate(&scenario).with_gaps(|sensor, k| k % 11 == 0 && k % 2 == sensor);
        let estimates = &finished_on(&scenario, record.clone()).estimates()[0].clone();
        let members = members(&scenario);
        let mut book = Book::new(&scenario, &members);
        let mut most = 0.0_f64;
        for k in 1..record.len() {
            let (mean, cov) = book.step(&record, k);
            most = most.max(book.probability[1]);
            let std: Vec<f64> = (0..4).map(|i| cov[(i, i)].sqrt()).collect();
            for i in 0..4 {
                assert!((mean[i] - estimates.mean(k)[i]).abs() < 1e-6 * std[i], "{kind:?}, mean of {i} at {k}");
                for j in 0..4 {
                    let error = (cov[(i, j)] - estimates.cov(k)[4 * i + j]).abs();
                    assert!(error < 1e-6 * std[i] * std[j], "{kind:?}, covariance of {i} and {j} at {k}");
                }
            }
        }
        assert!(most > 0.9, "{kind:?}: the parameters never walked: {most}");
    }
}

#[test]
fn without_a_walk_both_are_one() {
    for kind in ADAPTIVE {
        let runs = [0.0, 1e-12].map(|walk| finished(&scenario(kind, walk)));
        let [alone, bank] = runs.each_ref().map(|run| &run.estimates()[0]);
        assert_eq!((alone.stop(), bank.stop()), (None, None), "{kind:?}");
        let far = farthest(bank, alone, 1);
        assert!(far < 1e-4, "{kind:?}: {far}");
    }
}

#[test]
fn a_sudden_loss_is_found_and_the_band_is_right() {
    let mut good = 0;
    for seed in 300..320 {
        let scenario = Scenario { seed, ..scenario(FilterKind::EKF, 0.2) };
        let run = finished(&scenario);
        let estimates = &run.estimates()[0];
        let jumps: Vec<usize> = estimates.jumps().filter(|&k| k > 100).collect();
        assert!(jumps.first().is_some_and(|k| (1000..1100).contains(k)), "seed {seed}: {jumps:?}");
        let (mean, std) = last(estimates, Channel::NATURAL_FREQUENCY);
        good += usize::from((mean - 4.5).abs() < 2.0 * std);
    }
    assert!(good >= 18, "{good} of 20");
}

#[test]
fn a_bank_may_begin_from_several_guesses() {
    let mut scenario = Scenario { duration: 5.0, ..scenario(FilterKind::EKF, 0.2) };
    scenario.filters[0].guesses = 3;
    assert!(finished(&scenario).estimates()[0].stop().is_none());
}

const NATURAL_FREQUENCY: Channel = Channel::NATURAL_FREQUENCY;

/// 40 s at 6 rad/s with one sensor; each filter begins from one of these frequencies [rad/s], with this share of it as σ.
fn from_means(
    seed: u64,
    kind: FilterKind,
    sensor: (Quantity, f64),
    means: &[f64],
    share: f64,
    guesses: usize,
) -> Scenario {
    let (measures, noise_std) = sensor;
    let mut scenario = Scenario { seed, duration: 40.0, plant: oscillator(6.0, 0.05), ..Scenario::default() };
    scenario.sensors = vec![Sensor::new(measures, noise_std)];
    let filter = |&mean: &f64| FilterSettings {
        kind,
        guesses,
        sensor_std: vec![noise_std],
        initial_mean: values([0.0, 0.0, mean, 0.1]),
        initial_std: values([0.05, 0.3, share * mean, 0.08]),
        process_std: values([1e-5, 1e-3, 1e-5, 1e-6]),
        ..FilterSettings::default()
    };
    scenario.filters = means.iter().map(filter).collect();
    scenario
}

fn means(count: usize) -> Vec<f64> {
    (0..count).map(|i| 36_f64.powf(i as f64 / (count - 1) as f64)).collect()
}

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
                    let [four, one] = [4, 1].map(|guesses| {
                        let run = finished(&from_means(seed, kind, sensor, &means(12), share, guesses));
                        run.estimates().iter().filter(|estimates| has_arrived(estimates)).count()
                    });
                    (arrived, alone, of) = (arrived + four, alone + one, of + 12);
                }
                assert_eq!(arrived, of, "{kind:?} {sensor:?}, σ₀ {share} of the guess, with one guess {alone}");
            }
        }
    }
}

#[test]
fn the_likeliest_is_one_of_the_guesses_bit_by_bit_and_keeps_its_errors_bounds() {
    let sensor = (Quantity::DISPLACEMENT, 0.01);
    let mut bank = from_means(711, FilterKind::EKF, sensor, &[11.0], 0.1, 4);
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

fn log_density(run: &Run, of: [f64; 2], sensor_std: [f64; 2]) -> f64 {
    let (mean, cov) = joint_motion(run.record(), of);
    let n = mean.len() - 2;
    let errors = DVector::from_fn(n, |i, _| run.record().measured(i % 2)[1 + i / 2] - mean[2 + i]);
    let noise = |i: usize, j: usize| if i == j { sensor_std[i % 2].powi(2) } else { 0.0 };
    log_normal(DMatrix::from_fn(n, n, |i, j| cov[(2 + i, 2 + j)] + noise(i, j)), &errors)
}

#[test]
fn the_evidence_of_linear_models_is_the_density_of_the_readings() {
    let models = [[6.0, 0.05], [6.3, 0.05], [6.0, 0.2]];
    let (plant, filters) = (oscillator(6.0, 0.05), models.map(|model| knowing(FilterKind::KF, model)).to_vec());
    let scenario = Scenario { duration: 0.6, plant, filters, ..Scenario::default() };
    let run = finished(&scenario);
    let std = [scenario.sensors[0].noise_std, scenario.sensors[1].noise_std];
    let exact = models.map(|model| log_density(&run, model, std));
    let evidence: Vec<f64> = run.estimates().iter().map(|of| Evidence::new(of).at(60).expect("it is there")).collect();
    for (found, exact) in evidence.iter().zip(exact) {
        assert!((found - exact).abs() < 1e-9 * exact.abs(), "{found} {exact}");
    }
    let [found, exact] = [ModelClasses::new(evidence), ModelClasses::new(exact)];
    assert!(found.probabilities.iter().all(|p| (1e-6..0.999_999).contains(p)), "a hard case: {found:?}");
    for (found, exact) in found.probabilities.iter().zip(&exact.probabilities) {
        assert!((found - exact).abs() < 1e-9, "{found} {exact}");
    }
}

#[test]
fn a_filter_that_stops_has_no_evidence_from_there() {
    let mut broken = Scenario { duration: 20.0, ..Scenario::default() };
    broken.filters[0].fading = 1e30;
    let run = finished(&broken);
    let stop = run.estimates()[0].stop().expect("so much fading is too much").sample;
    let evidence = Evidence::new(&run.estimates()[0]);
    assert!(evidence.at(stop - 1).is_some_and(f64::is_finite));
    assert_eq!((evidence.at(stop), evidence.at(2000)), (Some(f64::NEG_INFINITY), Some(f64::NEG_INFINITY)));
}
